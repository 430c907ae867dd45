"""Laws of the pose cells on random activity: agreement with a slow literal twin, mass, sign, symmetry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ratslam_core import PoseCellParams, PoseCells
from ratslam_core.pose_cells import activity_kernels as kernels
from ratslam_core.pose_cells import packet_kernels
from ratslam_core.pose_cells.network import WINDOW
from tests.unit.ratslam_core import literal

sizes = st.tuples(st.integers(8, 21), st.integers(8, 21), st.integers(8, 21))
EXAMPLES = settings(max_examples=40)


@st.composite
def activities(draw: st.DrawFn) -> np.ndarray:
    """Sparse activity that sums to 1: a few clusters of cells anywhere, across faces too."""
    shape = draw(sizes)
    dense = np.zeros(shape)
    for _ in range(draw(st.integers(1, 4))):
        middle = [draw(st.integers(0, n - 1)) for n in shape]
        cells = st.tuples(st.integers(-2, 2), st.integers(-2, 2), st.integers(-2, 2), st.floats(0.01, 1))
        for dt, dy, dx, value in draw(st.lists(cells, min_size=1, max_size=6)):
            at = tuple((m + d) % n for m, d, n in zip(middle, (dt, dy, dx), shape, strict=True))
            dense[at] += value
    return dense / dense.sum()


def network(dense: np.ndarray, **params: float) -> PoseCells:
    n_theta, n_y, n_x = dense.shape
    pose_cells = PoseCells(PoseCellParams(n_x=n_x, n_y=n_y, n_theta=n_theta, **params))  # type: ignore[arg-type]
    literal.fill(pose_cells, dense)
    return pose_cells


@EXAMPLES
@given(activities(), st.floats(-4, 4), st.floats(-4, 4))
def test_path_integration_is_that_of_the_papers(dense: np.ndarray, cells: float, layers: float) -> None:
    pose_cells = network(dense)
    pose_cells.integrate(cells * 0.25, layers * 2 * math.pi / dense.shape[0])
    assert np.abs(pose_cells.activity - literal.shift(dense, cells, layers)).max() < 1e-6
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)


@EXAMPLES
@given(activities(), st.floats(0.3, 1.5), st.sampled_from([0.0, 1e-4, 1e-3]))
def test_the_attractor_is_that_of_the_papers(dense: np.ndarray, sigma: float, phi: float) -> None:
    pose_cells = network(dense, excite_sigma=sigma, inhibit=phi)
    pose_cells.attract()
    radius = max(2, math.ceil(3 * sigma))
    expected = literal.inhibit(literal.convolve(dense, literal.gaussian(sigma, radius)), phi)
    assert np.abs(pose_cells.activity - expected).max() < 2e-6


@EXAMPLES
@given(activities(), st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=8))
def test_activity_is_a_distribution_whatever_happens(dense: np.ndarray, drives: list[tuple[float, float]]) -> None:
    pose_cells = network(dense)
    for speed, yaw_rate in drives:
        pose_cells.step(speed=speed, yaw_rate=yaw_rate, dt=0.1)
        activity = pose_cells.activity
        assert activity.min() >= 0
        assert activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
        winner = pose_cells.winner
        assert 0 <= winner.x < dense.shape[2]
        assert 0 <= winner.y < dense.shape[1]
        assert -math.pi < winner.heading_rad <= math.pi
        assert sum(p.mass for p in pose_cells.packets) <= 1 + 1e-5


shifts = st.tuples(st.integers(-30, 30), st.integers(-30, 30))


@EXAMPLES
@given(activities(), shifts, st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=4))
def test_no_place_of_the_torus_is_special(
    dense: np.ndarray, by: tuple[int, int], drives: list[tuple[float, float]]
) -> None:
    """When the start is shifted by whole cells, everything that follows is shifted by the same."""
    here, there = (network(activity, inhibit=0.0, carry=False) for activity in (dense, np.roll(dense, by, (1, 2))))
    for speed, yaw_rate in drives:
        for pose_cells in (here, there):
            pose_cells._rows[: pose_cells._found, packet_kernels.COS : packet_kernels.CARRY] = (
                1.0,
                0.0,
            )  # equal packets may swap ids
            pose_cells.integrate(speed * 0.1, yaw_rate * 0.1)
            pose_cells.attract()
    assert np.abs(np.roll(here.activity, by, (1, 2)) - there.activity).max() < 1e-5


@EXAMPLES
@given(activities(), st.integers(-40, 40), st.integers(-40, 40), st.integers(-40, 40))
def test_a_whole_cell_shift_is_a_roll_and_back_is_the_identity(dense: np.ndarray, x: int, y: int, theta: int) -> None:
    pose_cells = network(dense)
    start = pose_cells.activity
    shift(pose_cells, x, y, theta)
    assert np.abs(pose_cells.activity - np.roll(dense, (theta, y, x), (0, 1, 2))).max() < 1e-6
    shift(pose_cells, -x, -y, -theta)
    assert np.array_equal(pose_cells.activity, start)


def shift(pose_cells: PoseCells, x: float, y: float, theta: float) -> None:
    """The same shift of all layers, as `carry` makes it."""
    pose_cells._rows[: pose_cells._found, packet_kernels.CARRY :] = x, y, theta
    pose_cells.integrate(0.0, 0.0)


@EXAMPLES
@given(activities(), st.integers(2, 6))
def test_every_active_cell_belongs_to_one_cluster_within_the_window(dense: np.ndarray, window: int) -> None:
    pose_cells = network(dense)
    cells, values = pose_cells.active
    n = len(values)
    owner, peaks = np.zeros(n, np.int32), np.zeros(n, np.int32)
    bounds = np.zeros((n, 6), np.int8)
    found, room = kernels.cluster(cells, values, n, dense.shape, window, 2, owner, peaks, bounds)
    assert room == sum(math.prod(int(b[3 + k]) - int(b[k]) + 5 for k in range(3)) for b in bounds[:found])
    assert set(owner) == set(range(found))
    for c in range(found):
        peak = cells[peaks[c]]
        assert values[peaks[c]] == values[owner == c].max()
        for axis in range(3):
            size = dense.shape[2 - axis]
            apart = (cells[owner == c, axis] - peak[axis] + size // 2) % size - size // 2
            assert np.abs(apart).max() <= min(window, (size - 1) // 2)
            assert (apart.min(), apart.max()) == (bounds[c, axis], bounds[c, 3 + axis])


def undecided(pose_cells: PoseCells, places: list[np.ndarray]) -> bool:
    """Whether a cell is as near to one packet as to another: it may count for either."""
    size, cells = np.array(pose_cells.shape), np.argwhere(pose_cells.activity)[:, None]
    squares = np.sort((((cells - np.array(places) + size / 2) % size - size / 2) ** 2).sum(axis=2), axis=1)
    return bool((np.diff(squares[:, :2], axis=1) < 1e-6).any())


@EXAMPLES
@given(activities(), st.floats(-1.0, 1.0), st.floats(-3, 3))
@pytest.mark.slow
def test_carry_is_what_the_attractor_took_from_each_packet(dense: np.ndarray, cells: float, layers: float) -> None:
    pose_cells = network(dense)
    pose_cells.attract()
    pose_cells.integrate(cells * 0.25, layers * 2 * math.pi / dense.shape[0])
    places = [row[2::-1].copy() for row in pose_cells._rows[: pose_cells._found]]
    ids = pose_cells._ids[: pose_cells._found].copy()
    before = literal.centres(pose_cells.activity.astype(np.float64), places, 2 * WINDOW)
    assume(not undecided(pose_cells, places))
    pose_cells.attract()
    assume(not undecided(pose_cells, places))
    after = literal.centres(pose_cells.activity.astype(np.float64), places, 2 * WINDOW)
    for id_, was, now in zip(ids, before, after, strict=True):
        for row in pose_cells._rows[: pose_cells._found][pose_cells._ids[: pose_cells._found] == id_]:
            assert row[: packet_kernels.CARRY - 1 : -1] == pytest.approx(was - now, abs=1e-5)
