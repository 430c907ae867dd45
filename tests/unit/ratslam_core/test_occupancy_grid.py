from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import MapGrid, OccupancyGrid, Packet, Pose2, occupancy_grid
from ratslam_core.occupancy_grid import BOUND, KEPT

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


def test_free_before_the_echo_occupied_at_it_and_nothing_behind() -> None:
    for quarter, (dx, dy) in enumerate([(1, 0), (0, 1), (-1, 0), (0, -1)]):
        p = one_beam(2.5, quarter * math.pi / 2)
        along = np.array([p[30 + dy * k, 30 + dx * k] for k in range(25)])
        assert (along[:9] < 0.5).all()  # up to 2 m, 2.5 m less the depth of the echo
        assert (np.diff(along[:9]) > 0).all()  # the nearer, the more certain
        assert along[10] == along.max() > 0.75
        assert (along[11:] == 0.5).all()
    for range_m in (5.0, 7.5, math.inf):  # no echo is free floor and no obstacle
        p = one_beam(range_m)
        assert p.max() == 0.5
        assert (p[30, 30:49] < 0.5).all()
    p = one_beam(0.1)  # an echo at once frees nothing
    assert p.min() == 0.5 < p[30, 30]


def test_a_beam_is_never_lost_between_cells() -> None:
    """In any direction the beam meets something, and frees as many cells as it is long."""
    rng = np.random.default_rng(0)
    for x, y, heading, range_m in rng.uniform((30, 30, -math.pi, 0.5), (31, 31, math.pi, 4.0), (300, 4)):
        grid = OccupancyGrid(SHAPE, CELL_M, [0.0])
        grid.update(Packet(x, y, heading, 1.0), np.array([range_m]))
        assert grid.probability.max() > 0.5
        assert (grid.probability < 0.5).sum() >= (range_m - 0.25) / CELL_M - 1  # an echo is 0.225 m deep


def test_sonars_look_where_they_are_mounted() -> None:
    """One echo on the left, none elsewhere, the robot facing +y: the echo is at -x. All wraps with the pose cells."""
    grid, ranges = OccupancyGrid(SHAPE, CELL_M, SONARS), NOTHING.copy()
    ranges[0] = 1.5
    grid.update(Packet(30.0, 30.0, math.pi / 2, 1.0), ranges)
    assert np.unravel_index(int(grid.probability.argmax()), (64, 64)) == (30, 24)
    assert grid.probability[45, 32] < 0.5
    assert (grid.probability[:29] <= 0.5).all()
    for dx, dy in ((34, 0), (0, 30), (33, 31)):
        there = OccupancyGrid(SHAPE, CELL_M, SONARS)
        there.update(Packet((30.0 + dx) % 64, (30.0 + dy) % 64, math.pi / 2, 1.0), ranges)
        assert np.abs(there.probability - np.roll(grid.probability, (dy, dx), (0, 1))).max() < 1e-5


def test_many_observations_are_sure_within_bounds_and_can_be_taken_back() -> None:
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
    """The same as in the papers' grid, but without wrapping, and it ends beyond the beams on all sides, not far."""
    four = np.radians([0, 90, 180, -90])
    for sonars, at, ranges in (
        (SONARS, Pose2(0.1, 0.2, 0.3), np.array([1.0, 1.5, 2.0, 2.5, 5.0, 3.0, 4.0, 0.5])),
        *(
            (four, Pose2(0.0, 0.0, 0.0), np.full(4, far))
            for far in (0.3, 1.0, 1.9, 2.0, 2.15, 2.4, 4.75, 4.99, math.inf)
        ),
    ):
        grid, torus = MapGrid(sonars), OccupancyGrid(SHAPE, CELL_M, sonars)
        grid.add(0, at, ranges)
        torus.update(Packet(30 + at.x / CELL_M, 30 + at.y / CELL_M, at.heading_rad, 1.0), ranges)
        picture = grid.draw(np.zeros((1, 3)), CELL_M)
        left, low = (round(v / CELL_M) + 30 for v in picture.origin_xy_m)
        drawn = picture.probability
        n_y, n_x = drawn.shape
        assert np.abs(drawn - torus.probability[low : low + n_y, left : left + n_x]).max() < 1e-5
        assert (drawn != 0.5).sum() == (torus.probability != 0.5).sum()
        assert all((edge == 0.5).all() for edge in (drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]))
        assert max(n_y, n_x) <= 2 * (min(ranges.max(), 5.0) + 0.3) / CELL_M + 5


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


def test_a_scan_near_the_newest_takes_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """As near as SAME_M and turned by no more than SAME_RAD, wherever the robot is and however it faces."""

    def kept(start: tuple[float, float, float], way: tuple[float, float, float]) -> int:
        (x, y, heading), (dx, dy, turn), grid = start, way, MapGrid([0.0])
        grid.add(0, Pose2(x, y, heading), np.array([1.0]))
        grid.add(0, Pose2(x + dx, y + dy, math.remainder(heading + turn, math.tau)), np.array([1.0]))
        return len(grid)

    ways = (0.09, 0.0, 0.0), (0.11, 0.0, 0.0), (0.08, -0.08, 0.0), (0.0, 0.0, 0.15), (0.0, 0.0, -0.2)
    for start in ((0.0, 0.0, 0.0), (1.0, -2.0, 1.0), (-0.5, 0.3, 3.1)):
        assert [kept(start, way) for way in ways] == [1, 2, 2, 1, 2]
    monkeypatch.setattr(occupancy_grid, "SAME_M", 0.125)
    monkeypatch.setattr(occupancy_grid, "SAME_RAD", 0.5)
    for just in ((0.125, 0.0, 0.0), (0.0, 0.0, -0.5), (0.125, 0.0, 0.5)):
        assert kept((0.0, 0.0, 0.0), just) == 1
    grid = MapGrid([0.0])
    for x, count in ((0.0, 1), (0.5, 2), (0.52, 2), (0.02, 3)):  # near an older one does not count
        grid.add(0, Pose2(x, 0.0, 0.0), np.array([1.0]))
        assert len(grid) == count


def test_memory_is_that_of_the_scans_and_doubles_when_it_is_full() -> None:
    grid = MapGrid([0.0, 1.0])
    of_each = KEPT * (3 + 2) * 4 + 8  # x, y, heading and two ranges in four bytes each, and how many scans there were
    for experience, room in ((0, 256), (255, 256), (256, 512), (511, 512), (1024, 2048)):
        grid.add(experience, Pose2(0.0, 0.0, 0.0), np.array([1.0, 2.0]))
        assert grid.memory_bytes == room * of_each
    poses = np.zeros((1025, 3))
    poses[1024, 0] = 8.0
    probability = grid.draw(poses).probability
    assert (probability > 0.6).sum() >= 2  # none was lost
    assert MapGrid(SONARS).draw(np.zeros((0, 3))).probability.tolist() == [[0.5]]  # nothing known is one unknown cell


def test_a_map_too_large_is_drawn_with_larger_cells() -> None:
    """What the sonars reach beyond the outermost experiences counts, too: 1019 cells between the ends of the farthest
    beams and five more are as much as is allowed."""
    limits = (240.0, 0.25), (250.55, 0.25), (250.56, 0.5), (500.0, 0.5), (511.0, 1.0), (700.0, 1.0)
    for (apart_m, cell_m), along in product(limits, (0, 1)):
        if along == 1 and 250 < apart_m < 251:
            continue  # the beams point along x
        grid, poses = MapGrid([0.0]), np.zeros((2, 3))
        poses[1, along] = apart_m
        for e in range(2):
            grid.add(e, Pose2(0.0, 0.0, 0.0), np.array([2.0]))
        picture = grid.draw(poses)
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


def test_wrong_input_is_named(subtests: pytest.Subtests) -> None:
    torus, grid, nan, inf = OccupancyGrid(SHAPE, CELL_M, SONARS), MapGrid(SONARS), math.nan, math.inf
    packet, here = Packet(1.0, 1.0, 0.0, 1.0), Pose2(0.0, 0.0, 0.0)
    known = MapGrid(SONARS)
    known.add(4, here, NOTHING)
    row, names = "sonar_angles_rad must be a row of at least one finite angle, got ", ("x", "y", "heading_rad")
    for message, refused in (
        (r"shape must be \(n_theta, n_y, n_x\).*got \(64, 64\)", lambda: OccupancyGrid((64, 64), CELL_M, SONARS)),  # type: ignore[arg-type]
        ("shape must be", lambda: OccupancyGrid((36, 64, 0), CELL_M, SONARS)),
        *(
            ("cell_m must be a positive number of metres, got ", partial(OccupancyGrid, SHAPE, cell_m, SONARS))
            for cell_m in (0.0, -0.25, nan, inf)
        ),
        *((row, partial(OccupancyGrid, SHAPE, CELL_M, angles)) for angles in ([], [[0.0]], [nan])),  # type: ignore[arg-type]
        (
            r"ranges_m must have shape \(8,\), one for each sonar, got \(7,\)",
            lambda: torus.update(packet, NOTHING[:7]),
        ),
        *(
            (
                "ranges_m must be 0 m or more, got ",
                partial(torus.update, packet, np.where(np.arange(8) == 3, no, NOTHING)),
            )
            for no in (-0.1, nan)
        ),
        *(
            (
                f"packet.{name} must be a finite number, got inf",
                partial(torus.update, replace(packet, **{name: inf}), NOTHING),
            )
            for name in names
        ),
        ("experience must be 0 or more, got -1", lambda: grid.add(-1, here, NOTHING)),
        ("ranges_m must have shape", lambda: grid.add(0, here, NOTHING[:3])),
        *(
            (
                f"local.{name} must be a finite number, got nan",
                partial(grid.add, 0, replace(here, **{name: nan}), NOTHING),
            )
            for name in names
        ),
        *(
            (r"poses must have shape \(n, 3\) with n at least 5, got ", partial(known.draw, np.zeros(shape)))
            for shape in ((4, 3), (5, 2), (5,))
        ),
        ("poses must be finite numbers", lambda: known.draw(np.full((5, 3), nan))),
        ("cell_m must be a positive number", lambda: known.draw(np.zeros((5, 3)), 0.0)),
    ):
        with subtests.test(message), pytest.raises(ValueError, match=message):
            refused()
    assert (torus.probability == 0.5).all()
    assert len(grid) == 0
