"""Laws of the packets' rows: where they go, what the attractor takes from them, and who keeps which id."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ratslam_core.pose_cells.packet_kernels import CARRY, COS, LEAST_AGREEMENT, MASS, ROW, SIN, advance, follow, weigh

EXAMPLES = settings(max_examples=100)
SHAPE = (36, 20, 24)  # n_theta, n_y, n_x
SIZES = np.array(SHAPE[::-1])  # of x, y, theta
UNIT = math.tau / SHAPE[0]


def rows_of(seed: int, packets: int) -> NDArray[np.float64]:
    """Packets anywhere, their headings spread by anything, each with a carry."""
    rng = np.random.default_rng(seed)
    rows = np.zeros((packets, ROW))
    rows[:, :3] = rng.uniform(0, 1, (packets, 3)) * SIZES
    rows[:, MASS] = rng.uniform(0.01, 1, packets)
    spread, facing = rng.uniform(0.05, 1, packets), rows[:, 2] * UNIT + rng.normal(0, 0.2, packets)
    rows[:, COS], rows[:, SIN] = spread * np.cos(facing), spread * np.sin(facing)
    rows[:, CARRY:] = rng.normal(0, 0.3, (packets, 3))
    return rows


def apart(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """a - b in x, y, theta, the shorter way round the torus."""
    return (a - b + SIZES / 2) % SIZES - SIZES / 2


seeds = st.integers(0, 2**32)
packets = st.integers(1, 6)


@EXAMPLES
@given(seeds, packets, st.floats(-3, 3), st.floats(-2, 2), st.booleans())
def test_a_packet_goes_where_its_mean_heading_leads(
    seed: int, n: int, distance: float, turn: float, exact: bool
) -> None:
    """The layers of a packet move by move * exp(i theta), so the packet moves by move * mean, and by its carry."""
    before, moves, yaws = rows_of(seed, n), np.zeros((n, 4)), np.zeros(n)
    rows = before.copy()
    advance(rows, n, SHAPE, distance, turn, exact, moves, yaws)
    bend = turn / 2 if exact else 0.0
    chord = 2 * distance / turn * math.sin(turn / 2) if exact and turn else distance
    for row, now, move, yaw in zip(before, rows, moves, yaws, strict=True):
        mean, carry = complex(row[COS], row[SIN]), row[CARRY:]
        straight = chord * cmath.exp(1j * ((row[2] + carry[2]) * UNIT + bend))
        if exact and abs(mean) >= LEAST_AGREEMENT:
            expected, way = straight / mean, straight
        elif exact:
            expected, way = straight * mean.conjugate() / LEAST_AGREEMENT**2, straight
        else:
            expected, way = distance, distance * mean
        assert complex(move[0], move[1]) == pytest.approx(expected, abs=1e-9)
        assert move[2:].tolist() == carry[:2].tolist()
        assert yaw == pytest.approx(turn / UNIT + carry[2], abs=1e-9)
        gone = np.array([way.real + carry[0], way.imag + carry[1], turn / UNIT + carry[2]])
        assert apart(now[:3], row[:3] + gone) == pytest.approx(np.zeros(3), abs=1e-9)
        assert (now[:3] >= 0).all()
        assert (now[:3] <= SIZES).all()
        assert now[MASS:CARRY].tolist() == row[MASS:CARRY].tolist()
        assert not now[CARRY:].any()


@EXAMPLES
@given(seeds, packets, st.integers(1, 20), st.sampled_from([1.0, -1.0]), st.booleans())
def test_a_cell_counts_for_the_nearest_packet_within_reach(
    seed: int, n: int, reach: int, sign: float, crowded: bool
) -> None:
    """A cell just as far away as the reach counts, too."""
    rng = np.random.default_rng(seed)
    cells = np.zeros((200, 4), np.int32)
    cells[:, :3] = rng.integers(0, SIZES, (200, 3))
    values = rng.uniform(0, 1, 200).astype(np.float32)
    before = rows_of(seed, n)
    if crowded:
        cells[:, :3] = rng.integers(-3, 4, (200, 3)) % SIZES
        before[:, :3] = rng.normal(0, 1, (n, 3)) % SIZES
    if n == 1:  # of several, two may be equally near then
        before[:, :3] = np.floor(before[:, :3])
    rows = before.copy()
    weigh(cells, values, 200, SHAPE, reach, rows, n, sign)
    windows = np.minimum(reach, (SIZES - 1) // 2)
    sums, mass = np.zeros((n, 3)), np.zeros(n)
    for cell, value in zip(cells[:, :3].astype(float), values.astype(float), strict=True):
        offsets = apart(cell, before[:, :3])
        distance = np.where((np.abs(offsets) <= windows).all(axis=1), (offsets**2).sum(axis=1), np.inf)
        nearest = int(distance.argmin())
        if distance[nearest] < np.inf:
            sums[nearest] += value * offsets[nearest]
            mass[nearest] += value
    centres = sums / np.maximum(mass, 1e-300)[:, None]
    assert rows[:, CARRY:] == pytest.approx(before[:, CARRY:] + sign * centres, abs=1e-9)
    assert rows[:, :CARRY].tolist() == before[:, :CARRY].tolist()


@EXAMPLES
@given(seeds, st.integers(0, 6), st.integers(0, 6), st.integers(1, 9), st.booleans())
def test_packets_keep_their_ids_and_carries(seed: int, n_old: int, n_new: int, window: int, whole: bool) -> None:
    """A packet that is just the window away is the same one still."""
    rng = np.random.default_rng(seed)
    old, new = rows_of(seed, n_old), rows_of(seed + 1, n_new)
    stay = min(n_old, n_new)
    new[:stay, :3] = (old[:stay, :3] + rng.normal(0, 2, (stay, 3))) % SIZES
    if whole:
        old[:, :3] = np.floor(old[:, :3])
        new[:stay, :3] = (old[:stay, :3] + rng.choice([-window, 0, window, window + 1], (stay, 3))) % SIZES
    old_ids, new_ids = rng.permutation(12)[:n_old].astype(np.int64) + 1, np.full(n_new, 99, np.int64)
    carried = new[:, CARRY:].copy()
    follow(old, old_ids, n_old, new, new_ids, n_new, SHAPE, window)
    expected = np.zeros(n_new, np.int64)
    for p in range(n_old):
        offsets = apart(new[:, :3], old[p, :3])
        free = (expected == 0) & (np.abs(offsets) <= window).all(axis=1)
        if free.any():
            best = int(np.where(free, (offsets**2).sum(axis=1), np.inf).argmin())
            expected[best] = old_ids[p]
            carried[best] = old[p, CARRY:]
    for q in np.flatnonzero(expected == 0):
        expected[q] = min(set(range(1, 30)) - set(old_ids.tolist()) - set(expected.tolist()))
    assert new_ids.tolist() == expected.tolist()
    assert new[:, CARRY:].tolist() == carried.tolist()
