"""The layers over the floors: the right place, the right colour, and nothing where nothing is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from web.messages import OccupancyPicture
from web.viewer.fits.map_fit import DEPTH, WIDTH, MapFit
from web.viewer.plates import overlays
from web.viewer.plates.pose_cell_plate import way_arrow
from web.viewer.primitives import images
from web.viewer.primitives.palette import DARK, LIGHT, Palette

SHAPE = (36, 64, 48)
GROUND = images.gridded_floor((7.0, 7.0), 30, DARK.floor, DARK.floor)


def pixel(plate_xy: tuple[float, float]) -> tuple[int, int]:
    row, column = (DEPTH / 2 - plate_xy[1]) * overlays.PX_PER_UNIT, (plate_xy[0] + WIDTH / 2) * overlays.PX_PER_UNIT
    return int(row), int(column)


def cell_pixel(x: int, y: int) -> tuple[int, int]:
    height, width = GROUND.shape[:2]
    return int(height - (y + 0.5) / SHAPE[1] * height), int((x + 0.5) / SHAPE[2] * width)


@pytest.mark.parametrize("palette", [DARK, LIGHT])
def test_free_is_brighter_and_occupied_darker_than_the_floor(palette: Palette) -> None:
    ground = np.broadcast_to(np.array(palette.floor, np.uint8), (1, 3, 3))
    free, unknown, occupied = overlays.occupancy_colours(np.array([[0.05, 0.5, 0.95]], np.float32), ground, palette)[0]
    assert free.sum() > unknown.sum() > occupied.sum()
    assert tuple(unknown) == palette.floor


@pytest.mark.parametrize("turn", [0.0, 1.1, -2.5])
def test_the_picture_lies_where_the_map_lies(turn: float) -> None:
    probability = np.full((20, 30), 0.5, np.float32)
    probability[12:15, 6:9] = 0.99
    fit = MapFit(0.8, turn, (1.0, 0.5))
    picture = OccupancyPicture(probability, (-2.0, -1.5), 0.25)
    floor = overlays.map_floor(picture, fit, DARK)
    assert floor.shape == (DEPTH * overlays.PX_PER_UNIT, WIDTH * overlays.PX_PER_UNIT, 3)
    met = np.array([[-2.0 + 7 * 0.25, -1.5 + 13 * 0.25]])  # the middle of what stands there, in the map
    x, y = fit.to_plate(met)[0]
    assert floor[pixel((x, y))].sum() < sum(DARK.floor) - 30
    x, y = fit.to_plate(met + np.array([2.0, 0.0]))[0]
    assert tuple(floor[pixel((x, y))]) == DARK.floor


def test_cells_are_occupied_where_they_are() -> None:
    probability = np.full(SHAPE[1:], 0.5, np.float32)
    probability[40:44, 10:14] = 0.99
    floor = overlays.cells_occupied(GROUND, probability, DARK)
    assert floor[cell_pixel(12, 42)].sum() < sum(DARK.floor)
    assert tuple(floor[cell_pixel(42, 12)]) == DARK.floor


def test_times_are_bright_at_the_goal_and_nothing_where_no_way_is_known() -> None:
    seconds = np.full(SHAPE[1:], np.inf, np.float32)
    seconds[5, :20] = np.arange(20)
    floor = overlays.cells_timed(GROUND, seconds, DARK)
    near, far, nowhere = (floor[cell_pixel(*cell)].astype(int) for cell in ((0, 5), (19, 5), (30, 30)))
    assert near.sum() > far.sum()
    assert tuple(nowhere) == DARK.floor
    assert np.array_equal(overlays.cells_timed(GROUND, np.full(SHAPE[1:], np.inf, np.float32), DARK), GROUND)


def test_a_disc_goes_on_at_the_other_side() -> None:
    ringed = overlays.cells_ringed(GROUND, SHAPE, (0.0, 63.0), 4.0, DARK.goal)
    inside = [ringed[cell_pixel(*cell)] for cell in ((0, 63), (46, 63), (1, 1), (47, 61))]
    assert all(tuple(colour) != DARK.floor for colour in inside)
    assert tuple(ringed[cell_pixel(24, 30)]) == DARK.floor


def test_the_way_s_arrow_points_along_x_and_its_casing_is_wider() -> None:
    body, casing = way_arrow(0.0)[0], way_arrow(0.05)[0]
    assert math.isclose(body[:, 1].min(), -body[:, 1].max())
    assert body[:, 0].argmax() == np.abs(body[:, 0]).argmax()
    assert np.ptp(casing, axis=0)[1] > np.ptp(body, axis=0)[1]


def test_made_up_snapshots_have_what_is_laid_over_the_floors() -> None:
    snapshot = fake_snapshot(30)
    assert snapshot.occupancy is not None
    assert snapshot.goal_memory is not None
    assert snapshot.occupancy.draw_map().probability.max() > 0.9
