"""The picture that bends with the map, just at its limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core import MapGrid, OccupancyGrid, Packet, Pose2, occupancy_grid
from ratslam_core.occupancy_grid import KEPT

from .test_occupancy_grid import CELL_M, SHAPE


@pytest.mark.parametrize(("way", "kept"), [((0.125, 0.0, 0.0), 1), ((0.0, 0.0, -0.5), 1), ((0.125, 0.0, 0.5), 1)])
def test_just_as_near_as_the_limit_takes_its_place(
    way: tuple[float, float, float], kept: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(occupancy_grid, "SAME_M", 0.125)
    monkeypatch.setattr(occupancy_grid, "SAME_RAD", 0.5)
    grid = MapGrid([0.0])
    for pose in (Pose2(0.0, 0.0, 0.0), Pose2(*way)):
        grid.add(0, pose, np.array([1.0]))
    assert len(grid) == kept


def test_the_first_scan_is_kept_wherever_it_was_taken() -> None:
    grid = MapGrid([0.0])
    grid.add(0, Pose2(0.0, 0.0, 0.0), np.array([1.0]))
    assert len(grid) == 1


def test_memory_is_that_of_the_scans_and_doubles_when_it_is_full() -> None:
    grid = MapGrid([0.0, 1.0])
    of_each = KEPT * (3 + 2) * 4 + 8  # x, y, heading and two ranges in four bytes each, and how many scans there were
    for experience, room in ((0, 256), (255, 256), (256, 512), (511, 512), (1024, 2048)):
        grid.add(experience, Pose2(0.0, 0.0, 0.0), np.array([1.0, 2.0]))
        assert grid.memory_bytes == room * of_each


@pytest.mark.parametrize("range_m", [0.3, 1.0, 1.9, 2.0, 2.15, 2.4, 4.75, 4.99, math.inf])
def test_the_picture_ends_beyond_the_beams(range_m: float) -> None:
    """On all four sides: nothing of them is cut off, and not much more is drawn."""
    four = np.radians([0, 90, 180, -90])
    grid, torus = MapGrid(four), OccupancyGrid(SHAPE, CELL_M, four)
    ranges = np.full(4, range_m)
    grid.add(0, Pose2(0.0, 0.0, 0.0), ranges)
    torus.update(Packet(30.0, 30.0, 0.0, 1.0), ranges)
    drawn = grid.draw(np.zeros((1, 3)), CELL_M).probability
    assert (drawn != 0.5).sum() == (torus.probability != 0.5).sum()
    assert all((edge == 0.5).all() for edge in (drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]))
    assert max(drawn.shape) <= 2 * (min(range_m, 5.0) + 0.1) / CELL_M + 5


@pytest.mark.parametrize(("apart_m", "cell_m"), [(250.55, 0.25), (250.56, 0.5)])
def test_a_picture_is_as_large_as_allowed(apart_m: float, cell_m: float) -> None:
    """1019 cells between the ends of the farthest beams and five more, or one more than that."""
    grid = MapGrid([0.0])
    for e in range(2):
        grid.add(e, Pose2(0.0, 0.0, 0.0), np.array([2.0]))
    picture = grid.draw(np.array([[0.0, 0.0, 0.0], [apart_m, 0.0, 0.0]]))
    assert picture.cell_m == cell_m
    assert max(picture.probability.shape) <= occupancy_grid.MOST_CELLS
