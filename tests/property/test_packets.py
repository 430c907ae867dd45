"""Laws of the packets' rows: where they go, and who keeps which id."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ratslam_core.pose_cells.packet_kernels import COS, MASS, ROW, SIN, advance, follow

EXAMPLES = settings(max_examples=100)
SHAPE = (36, 20, 24)  # n_theta, n_y, n_x
SIZES = np.array(SHAPE[::-1])  # of x, y, theta
UNIT = math.tau / SHAPE[0]


def rows_of(seed: int, packets: int) -> NDArray[np.float64]:
    """Packets anywhere, their headings spread by anything."""
    rng = np.random.default_rng(seed)
    rows = np.zeros((packets, ROW))
    rows[:, :3] = rng.uniform(0, 1, (packets, 3)) * SIZES
    rows[:, MASS] = rng.uniform(0.01, 1, packets)
    spread, facing = rng.uniform(0.05, 1, packets), rows[:, 2] * UNIT + rng.normal(0, 0.2, packets)
    rows[:, COS], rows[:, SIN] = spread * np.cos(facing), spread * np.sin(facing)
    return rows


def apart(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """a - b in x, y, theta, the shorter way round the torus."""
    return (a - b + SIZES / 2) % SIZES - SIZES / 2


seeds = st.integers(0, 2**32)
packets = st.integers(1, 6)


@EXAMPLES
@given(seeds, packets, st.floats(-3, 3), st.floats(-2, 2))
def test_a_packet_goes_where_its_mean_heading_leads(seed: int, n: int, distance: float, yaw: float) -> None:
    """The layers of a packet move by distance * exp(i theta), so the packet moves by distance * mean."""
    before = rows_of(seed, n)
    rows = before.copy()
    advance(rows, n, SHAPE, distance, yaw)
    gone = np.column_stack([distance * before[:, COS], distance * before[:, SIN], np.full(n, yaw)])
    assert apart(rows[:, :3], before[:, :3] + gone) == pytest.approx(np.zeros((n, 3)), abs=1e-9)
    assert (rows[:, :3] >= 0).all()
    assert (rows[:, :3] <= SIZES).all()
    assert rows[:, MASS:].tolist() == before[:, MASS:].tolist()


@EXAMPLES
@given(seeds, st.integers(0, 6), st.integers(0, 6), st.integers(1, 9), st.booleans())
def test_packets_keep_their_ids(seed: int, n_old: int, n_new: int, window: int, whole: bool) -> None:
    """A packet that is just the window away is the same one still."""
    rng = np.random.default_rng(seed)
    old, new = rows_of(seed, n_old), rows_of(seed + 1, n_new)
    stay = min(n_old, n_new)
    new[:stay, :3] = (old[:stay, :3] + rng.normal(0, 2, (stay, 3))) % SIZES
    if whole:
        old[:, :3] = np.floor(old[:, :3])
        new[:stay, :3] = (old[:stay, :3] + rng.choice([-window, 0, window, window + 1], (stay, 3))) % SIZES
    old_ids, new_ids = rng.permutation(12)[:n_old].astype(np.int64) + 1, np.full(n_new, 99, np.int64)
    follow(old, old_ids, n_old, new, new_ids, n_new, SHAPE, window)
    expected = np.zeros(n_new, np.int64)
    for p in range(n_old):
        offsets = apart(new[:, :3], old[p, :3])
        free = (expected == 0) & (np.abs(offsets) <= window).all(axis=1)
        if free.any():
            best = int(np.where(free, (offsets**2).sum(axis=1), np.inf).argmin())
            expected[best] = old_ids[p]
    for q in np.flatnonzero(expected == 0):
        expected[q] = min(set(range(1, 30)) - set(old_ids.tolist()) - set(expected.tolist()))
    assert new_ids.tolist() == expected.tolist()
