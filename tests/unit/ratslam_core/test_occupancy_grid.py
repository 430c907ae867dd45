from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import MapGrid, OccupancyGrid, Packet, Pose2, occupancy_grid
from ratslam_core.occupancy_grid import BOUND, DEPTH_M, HALF_BEAM_RAD

from . import literal

SHAPE = (36, 64, 64)
CELL_M = 0.25
SONARS = np.radians([90, 50, 30, 10, -10, -30, -50, -90])
NOTHING = np.full(8, 5.0, np.float32)


def one_beam(range_m: float, heading: float = 0.0) -> NDArray[np.float32]:
    """The picture after one scan straight ahead from the middle of cell (30, 30)."""
    grid = OccupancyGrid(SHAPE, CELL_M, [0.0])
    grid.update(Packet(30.0, 30.0, heading, 1.0), np.array([range_m], np.float32))
    return grid.probability


@pytest.mark.parametrize("quarter", [-2, -1, 0, 1, 2, 3])
def test_free_before_the_echo_occupied_at_it_and_nothing_behind(quarter: int) -> None:
    p = one_beam(2.5, quarter * math.pi / 2)
    dx, dy = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter]
    along = np.array([p[30 + dy * k, 30 + dx * k] for k in range(25)])
    assert (along[:9] < 0.5).all()  # up to 2 m, 2.5 m less the depth of the echo
    assert (np.diff(along[:9]) > 0).all()  # the nearer, the more certain
    assert along[10] == along.max() > 0.75
    assert (along[11:] == 0.5).all()
    assert np.sort(p.ravel()) == pytest.approx(np.sort(one_beam(2.5).ravel()), abs=1e-5)


def test_the_beam_is_wide_and_surest_in_its_middle() -> None:
    p = one_beam(4.0)
    across = p[27:34, 44]  # 3.5 m ahead
    assert across[3] == across.min() < 0.5
    assert across == pytest.approx(across[::-1], abs=1e-6)
    assert (np.diff(across[:4]) < 0).all()
    seen = np.argwhere(p != 0.5) - 30
    distance = np.hypot(*seen.T) * CELL_M
    angle = np.abs(np.arctan2(seen[:, 0], seen[:, 1]))
    assert distance.max() < 4.0 + DEPTH_M + CELL_M / 2
    beyond = distance > CELL_M
    assert (angle[beyond] < HALF_BEAM_RAD + np.arcsin(CELL_M / 2 / distance[beyond])).all()
    assert p[30, 46] > 0.5 > p[30, 44]


@pytest.mark.parametrize("range_m", [0.5, 1.0, 1.7, 4.0])
def test_a_beam_is_never_lost_between_cells(range_m: float) -> None:
    """In any direction the beam meets something, and frees as many cells as it is long."""
    rng = np.random.default_rng(0)
    for x, y, heading in rng.uniform((30, 30, -math.pi), (31, 31, math.pi), (100, 3)):
        grid = OccupancyGrid(SHAPE, CELL_M, [0.0])
        grid.update(Packet(x, y, heading, 1.0), np.array([range_m]))
        assert grid.probability.max() > 0.5
        assert (grid.probability < 0.5).sum() >= (range_m - 0.25) / CELL_M - 1  # an echo is 0.225 m deep


@pytest.mark.parametrize("range_m", [5.0, 7.5, math.inf])
def test_no_echo_is_free_floor_and_no_obstacle(range_m: float) -> None:
    p = one_beam(range_m)
    assert p.max() == 0.5
    assert (p[30, 30:49] < 0.5).all()


def test_an_echo_at_once_frees_nothing() -> None:
    p = one_beam(0.1)
    assert p.min() == 0.5
    assert p[30, 30] > 0.5


def test_sonars_look_where_they_are_mounted() -> None:
    """One echo on the left, none elsewhere, the robot facing +y: the echo is at -x."""
    grid = OccupancyGrid(SHAPE, CELL_M, SONARS)
    ranges = NOTHING.copy()
    ranges[0] = 1.5
    grid.update(Packet(30.0, 30.0, math.pi / 2, 1.0), ranges)
    assert np.unravel_index(int(grid.probability.argmax()), (64, 64)) == (30, 24)
    assert grid.probability[45, 32] < 0.5
    assert (grid.probability[:29] <= 0.5).all()


def test_many_looks_are_sure_within_bounds_and_can_be_taken_back() -> None:
    grid = OccupancyGrid(SHAPE, CELL_M, [0.0])
    assert np.array_equal(grid.probability, np.full((64, 64), 0.5, np.float32))
    packet, wall, gone = Packet(30.0, 30.0, 0.0, 1.0), np.array([2.0]), np.array([4.0])
    before = 0.5
    for k in range(40):
        grid.update(packet, wall)
        assert grid.probability[30, 38] >= before
        before = grid.probability[30, 38]
        assert np.abs(grid.log_odds).max() <= BOUND, k
    assert grid.log_odds[30, 38] == BOUND
    assert grid.log_odds[30, 31] == -BOUND
    assert grid.probability.max() == pytest.approx(1 / (1 + math.exp(-BOUND)))
    for _ in range(40):
        grid.update(packet, gone)
    assert grid.log_odds[30, 38] == -BOUND
    assert grid.probability.dtype == np.float32


@pytest.mark.parametrize("by", [(34, 0), (0, 30), (33, 31)])
def test_it_wraps_with_the_pose_cells(by: tuple[int, int]) -> None:
    here, there = (OccupancyGrid(SHAPE, CELL_M, SONARS) for _ in range(2))
    ranges = np.array([1.0, 1.5, 2.0, 2.5, 5.0, 3.0, 4.0, 0.5], np.float32)
    here.update(Packet(30.3, 30.6, 0.7, 1.0), ranges)
    there.update(Packet((30.3 + by[0]) % 64, (30.6 + by[1]) % 64, 0.7, 1.0), ranges)
    moved = np.roll(here.probability, (by[1], by[0]), (0, 1))
    assert np.abs(there.probability - moved).max() < 1e-5


# ---------------------------------------------------------------- the picture that bends


def wall_at(picture: occupancy_grid.MetricPicture) -> tuple[float, float]:
    """Where it is most likely that something stands, m."""
    row, column = np.unravel_index(int(picture.probability.argmax()), picture.probability.shape)
    return picture.origin_xy_m[0] + column * picture.cell_m, picture.origin_xy_m[1] + row * picture.cell_m


def test_the_picture_bends_with_the_map() -> None:
    grid = MapGrid([0.0])
    grid.add(1, Pose2(0.5, 0.0, 0.0), np.array([2.0]))
    poses = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 0.0]])
    assert wall_at(grid.draw(poses)) == pytest.approx((3.5, 2.0), abs=0.13)
    poses[1] = 10.0, -3.0, math.pi / 2
    assert wall_at(grid.draw(poses)) == pytest.approx((10.0, -0.5), abs=0.13)
    fine = grid.draw(poses, cell_m=0.05)
    assert fine.cell_m == 0.05
    assert wall_at(fine) == pytest.approx((10.0, -0.5), abs=0.1)


def test_the_metric_picture_is_the_same_beam() -> None:
    """The same as in the papers' grid, but without wrapping and without reaching the edge."""
    grid, torus = MapGrid(SONARS), OccupancyGrid(SHAPE, CELL_M, SONARS)
    ranges = np.array([1.0, 1.5, 2.0, 2.5, 5.0, 3.0, 4.0, 0.5], np.float32)
    grid.add(0, Pose2(0.1, 0.2, 0.3), ranges)
    torus.update(Packet(30 + 0.1 / CELL_M, 30 + 0.2 / CELL_M, 0.3, 1.0), ranges)
    picture = grid.draw(np.zeros((1, 3)), CELL_M)
    left, low = (round(v / CELL_M) + 30 for v in picture.origin_xy_m)
    n_y, n_x = picture.probability.shape
    expected = torus.probability[low : low + n_y, left : left + n_x]
    assert np.abs(picture.probability - expected).max() < 1e-5
    assert (picture.probability != 0.5).sum() == (torus.probability != 0.5).sum()
    edges = picture.probability[0], picture.probability[-1], picture.probability[:, 0], picture.probability[:, -1]
    assert all((edge == 0.5).all() for edge in edges)


def test_each_experience_keeps_its_newest_scans(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(occupancy_grid, "KEPT", 3)
    grid = MapGrid([0.0])
    for k in range(5):
        grid.add(0, Pose2(0.2 * k, 0.0, 0.0), np.array([4.0 if k < 2 else 2.0]))
    assert len(grid) == 3
    picture = grid.draw(np.zeros((1, 3)))
    x, y = wall_at(picture)
    assert x == pytest.approx(2.6, abs=0.3)
    assert y == pytest.approx(0.0, abs=0.13)
    assert picture.probability.shape[1] * CELL_M < 2 * (2.0 + 0.1) + 0.4 + 5 * CELL_M  # the long ranges are gone
    grid.add(7, Pose2(0.0, 0.0, 0.0), np.array([4.0]))
    assert len(grid) == 4


def test_a_robot_that_stands_keeps_one_scan() -> None:
    grid = MapGrid([0.0])
    for k in range(10):
        grid.add(0, Pose2(0.001 * k, 0.0, math.pi - 0.05 + 0.01 * k), np.array([2.0]))
    assert len(grid) == 1
    grid.add(0, Pose2(0.0, 0.0, math.radians(-160)), np.array([2.0]))
    assert len(grid) == 2
    grid.add(0, Pose2(0.2, 0.0, math.radians(-160)), np.array([2.0]))
    assert len(grid) == 3


@pytest.mark.parametrize(
    ("way", "kept"),
    [
        ((0.09, 0.0, 0.0), 1),
        ((0.11, 0.0, 0.0), 2),
        ((0.08, -0.08, 0.0), 2),
        ((0.0, 0.0, 0.15), 1),
        ((0.0, 0.0, -0.2), 2),
    ],
)
def test_a_scan_near_the_newest_takes_its_place(way: tuple[float, float, float], kept: int) -> None:
    """As near as SAME_M and turned by no more than SAME_RAD, wherever the robot is and however it faces."""
    for x, y, heading in ((0.0, 0.0, 0.0), (1.0, -2.0, 1.0), (-0.5, 0.3, 3.1)):
        grid = MapGrid([0.0])
        grid.add(0, Pose2(x, y, heading), np.array([1.0]))
        there = Pose2(x + way[0], y + way[1], math.remainder(heading + way[2], math.tau))
        grid.add(0, there, np.array([1.0]))
        assert len(grid) == kept


def test_it_grows_with_the_experiences() -> None:
    grid = MapGrid([0.0])
    before = grid.memory_bytes
    grid.add(3, Pose2(0.0, 0.0, 0.0), np.array([2.0]))
    grid.add(1500, Pose2(0.0, 0.0, 0.0), np.array([2.0]))
    assert before < grid.memory_bytes < 10 * before
    poses = np.zeros((1501, 3))
    poses[1500, 0] = 8.0
    probability = grid.draw(poses).probability
    assert (probability > 0.6).sum() >= 2


def test_nothing_known_is_one_unknown_cell() -> None:
    picture = MapGrid(SONARS).draw(np.zeros((0, 3)))
    assert picture.probability.tolist() == [[0.5]]


@pytest.mark.parametrize(("apart_m", "cell_m"), [(240.0, 0.25), (255.0, 0.5), (500.0, 0.5), (511.0, 1.0), (700.0, 1.0)])
def test_a_map_too_large_is_drawn_with_larger_cells(apart_m: float, cell_m: float) -> None:
    """What the sonars reach beyond the outermost experiences counts, too."""
    for poses in ([[0.0, 0.0, 0.0], [apart_m, 0.0, 0.0]], [[0.0, 0.0, 0.0], [0.0, apart_m, 0.0]]):
        grid = MapGrid([0.0])
        for e in range(2):
            grid.add(e, Pose2(0.0, 0.0, 0.0), np.array([2.0]))
        picture = grid.draw(np.array(poses))
        assert picture.cell_m == cell_m
        assert max(picture.probability.shape) <= occupancy_grid.MOST_CELLS


def test_interpreted_it_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def pictures() -> list[NDArray[np.float32]]:
        torus, grid = OccupancyGrid(SHAPE, CELL_M, SONARS), MapGrid(SONARS)
        for k, range_m in enumerate((0.1, 2.0, 5.0)):
            ranges = np.full(8, range_m, np.float32)
            torus.update(Packet(63.4, 0.3 + k, 0.2 * k - SONARS[1], 1.0), ranges)  # one beam along a row of cells
            grid.add(k, Pose2(0.1 * k, 0.0, 0.0), ranges)
        return [torus.probability, grid.draw(np.eye(3)).probability]

    compiled = pictures()
    literal.interpret(occupancy_grid, monkeypatch)
    for a, b in zip(compiled, pictures(), strict=True):
        assert np.abs(a - b).max() < 1e-6


# ---------------------------------------------------------------- wrong input


def test_wrong_input_to_the_grid_is_named() -> None:
    with pytest.raises(ValueError, match=r"shape must be \(n_theta, n_y, n_x\).*got \(64, 64\)"):
        OccupancyGrid((64, 64), CELL_M, SONARS)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="shape must be"):
        OccupancyGrid((36, 64, 0), CELL_M, SONARS)
    for cell_m in (0.0, -0.25, math.nan, math.inf):
        with pytest.raises(ValueError, match="cell_m must be a positive number of metres, got "):
            OccupancyGrid(SHAPE, cell_m, SONARS)
    for angles in ([], [[0.0]], [math.nan]):
        with pytest.raises(ValueError, match="sonar_angles_rad must be a row of at least one finite angle, got "):
            OccupancyGrid(SHAPE, CELL_M, angles)  # type: ignore[arg-type]
    grid, packet = OccupancyGrid(SHAPE, CELL_M, SONARS), Packet(1.0, 1.0, 0.0, 1.0)
    with pytest.raises(ValueError, match=r"ranges_m must have shape \(8,\), one for each sonar, got \(7,\)"):
        grid.update(packet, NOTHING[:7])
    for wrong in (-0.1, math.nan):
        with pytest.raises(ValueError, match="ranges_m must be 0 m or more, got "):
            grid.update(packet, np.where(np.arange(8) == 3, wrong, NOTHING))
    for name in ("x", "y", "heading_rad"):
        with pytest.raises(ValueError, match=f"packet.{name} must be a finite number, got inf"):
            grid.update(replace(packet, **{name: math.inf}), NOTHING)
    assert (grid.probability == 0.5).all()


def test_wrong_input_to_the_map_picture_is_named() -> None:
    grid, here = MapGrid(SONARS), Pose2(0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="experience must be 0 or more, got -1"):
        grid.add(-1, here, NOTHING)
    with pytest.raises(ValueError, match="ranges_m must have shape"):
        grid.add(0, here, NOTHING[:3])
    for name in ("x", "y", "heading_rad"):
        with pytest.raises(ValueError, match=f"local.{name} must be a finite number, got nan"):
            grid.add(0, replace(here, **{name: math.nan}), NOTHING)
    assert len(grid) == 0
    grid.add(4, here, NOTHING)
    for shape in ((4, 3), (5, 2), (5,)):
        with pytest.raises(ValueError, match=r"poses must have shape \(n, 3\) with n at least 5, got "):
            grid.draw(np.zeros(shape))
    with pytest.raises(ValueError, match="poses must be finite numbers"):
        grid.draw(np.full((5, 3), np.nan))
    with pytest.raises(ValueError, match="cell_m must be a positive number"):
        grid.draw(np.zeros((5, 3)), 0.0)
