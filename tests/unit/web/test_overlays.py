"""The layers over the floors: the right place, the right colour, and nothing where nothing is known."""

from __future__ import annotations

import math

import numpy as np

from web.messages import OccupancyPicture
from web.viewer.fits import DEPTH, WIDTH, MapFit
from web.viewer.plates import overlays
from web.viewer.plates.pose_cell_plate import way_arrow
from web.viewer.primitives import images
from web.viewer.primitives.palette import DARK, LIGHT

SHAPE = (36, 64, 48)
GROUND = images.gridded_floor((7.0, 7.0), 30, DARK.floor, DARK.floor)


def cell(floor: np.ndarray, x: int, y: int) -> tuple[int, ...]:
    """The colour of a pose cell's place on the floor."""
    height, width = GROUND.shape[:2]
    return tuple(floor[int(height - (y + 0.5) / SHAPE[1] * height), int((x + 0.5) / SHAPE[2] * width)].tolist())


def test_free_is_brighter_and_occupied_darker_than_the_floor() -> None:
    probability = np.array([[0.05, 0.5, 0.95]], np.float32)
    for palette in (DARK, LIGHT):
        ground = np.broadcast_to(np.array(palette.floor, np.uint8), (1, 3, 3))
        free, unknown, occupied = overlays.occupancy_colours(probability, ground, palette)[0]
        assert free.sum() > unknown.sum() > occupied.sum()
        assert tuple(unknown) == palette.floor


def test_the_picture_lies_where_the_map_lies() -> None:
    def colour(place: np.ndarray) -> tuple[int, ...]:
        x, y = fit.to_plate(place)[0]
        return tuple(floor[int((DEPTH / 2 - y) * overlays.PX_PER_UNIT), int((x + WIDTH / 2) * overlays.PX_PER_UNIT)])

    probability = np.full((20, 30), 0.5, np.float32)
    probability[12:15, 6:9] = 0.99
    met = np.array([[-2.0 + 7 * 0.25, -1.5 + 13 * 0.25]])  # the middle of what stands there, in the map
    for turn in (0.0, 1.1, -2.5):
        fit = MapFit(0.8, turn, (1.0, 0.5))
        floor = overlays.map_floor(OccupancyPicture(probability, (-2.0, -1.5), 0.25), fit, DARK, np.zeros((0, 2)))
        assert floor.shape == (DEPTH * overlays.PX_PER_UNIT, WIDTH * overlays.PX_PER_UNIT, 3)
        assert sum(map(int, colour(met))) < sum(DARK.floor) - 30
        assert colour(met + np.array((2.0, 0.0))) == DARK.floor


def test_floor_within_a_metre_of_where_the_robot_has_been_is_the_brighter() -> None:
    free = OccupancyPicture(np.full((24, 24), 0.05, np.float32), (-3.0, -3.0), 0.25)
    been, angle = np.array([[0.5, -0.5], [40.0, 0.0]]), 0.7  # the second is beside the plate
    for palette, fit in ((DARK, MapFit(0.8, 0.4, (0.0, 0.0))), (LIGHT, MapFit(0.3, -2.0, (1.0, 0.5)))):
        floor = overlays.map_floor(free, fit, palette, been)
        places = been[0] + np.outer((0.0, 0.85, 1.15, 1.8), (np.cos(angle), np.sin(angle)))
        x, y = fit.to_plate(places).T
        rows, columns = (DEPTH / 2 - y) * overlays.PX_PER_UNIT, (x + WIDTH / 2) * overlays.PX_PER_UNIT
        inside, near, beyond, far = floor[rows.astype(int), columns.astype(int)].astype(int).sum(axis=1)
        assert inside == near > beyond == far > sum(palette.floor)


def test_cells_are_occupied_where_they_are() -> None:
    probability = np.full(SHAPE[1:], 0.5, np.float32)
    probability[40:44, 10:14] = 0.99
    floor = overlays.cells_occupied(GROUND, probability, DARK)
    assert sum(cell(floor, 12, 42)) < sum(cell(floor, 42, 12)) == sum(DARK.floor)


def test_times_are_bright_at_the_goal_and_nothing_where_no_way_is_known() -> None:
    seconds = np.full(SHAPE[1:], np.inf, np.float32)
    assert np.array_equal(overlays.cells_timed(GROUND, seconds, DARK), GROUND)
    seconds[5, :20] = np.arange(20)
    floor = overlays.cells_timed(GROUND, seconds, DARK)
    assert sum(cell(floor, 0, 5)) > sum(cell(floor, 19, 5))
    assert cell(floor, 30, 30) == DARK.floor


def test_a_disc_goes_on_at_the_other_side() -> None:
    ringed = overlays.cells_ringed(GROUND, SHAPE, (0.0, 63.0), 4.0, DARK.goal)
    assert all(cell(ringed, *place) != DARK.floor for place in ((0, 63), (46, 63), (1, 1), (47, 61)))
    assert cell(ringed, 24, 30) == DARK.floor


def test_the_way_s_arrow_points_along_x_and_its_casing_is_wider() -> None:
    body, casing = way_arrow(0.0)[0], way_arrow(0.05)[0]
    assert math.isclose(body[:, 1].min(), -body[:, 1].max())
    assert body[:, 0].argmax() == np.abs(body[:, 0]).argmax()
    assert np.ptp(casing, axis=0)[1] > np.ptp(body, axis=0)[1]
