from __future__ import annotations

import math

import numpy as np
import pytest

from sim2d import FreeSpace, Wall, load_world

from .rooms import GREY, room


def wall(x1: float, y1: float, x2: float, y2: float) -> Wall:
    return Wall(x1, y1, x2, y2, "wall", 2.6, GREY)


BOX = (wall(0.5, 3, 1.5, 3), wall(1.5, 3, 1.5, 4), wall(0.5, 4, 0.5, 3))  # closed in, with the outer wall
FREE = FreeSpace(room(*BOX), 0.22)


def test_refusals() -> None:
    assert FREE.is_free(2.0, 2.0)
    assert FREE.refusal(2.0, 2.0) is None
    assert FREE.refusal(math.nan, 1.0) == "(nan, 1.0) is not a place; both must be finite"
    assert FREE.refusal(5.0, 1.0) == "(5, 1) is outside of room, which spans 0 to 4 by 0 to 4 m"
    assert FREE.refusal(3.9, 1.0) == "(3.9, 1) is 0.100 m from walls[1] (wall); the robot needs 0.22 m"
    assert FREE.refusal(1.0, 3.5) == "(1, 3.5) is closed in: no way leads there from home"
    assert FREE.clearance(1.0, 2.5) == 0.5


def test_ways() -> None:
    assert FREE.shortest_m((0.5, 0.5), (3.5, 0.5)) == pytest.approx(3.0, abs=0.06)
    assert FREE.shortest_m((0.5, 0.5), (0.53, 0.5)) == pytest.approx(0.03)
    assert FREE.shortest_m((0.5, 0.5), (1.0, 3.5)) == math.inf
    assert FREE.shortest_m((0.5, 9.5), (1.0, 1.0)) == math.inf


def test_a_way_round_a_wall() -> None:
    """Around a wall's free end the way touches the circle of the robot's radius: two tangents and an arc."""
    free = FreeSpace(room(wall(2.6, 0, 2.6, 2.5)), 0.22)
    a, b = (1.6, 1.0), (3.6, 1.0)
    reach = math.hypot(1.0, 1.5)
    tangent = math.sqrt(reach**2 - 0.22**2)
    arc = 2 * 0.22 * (math.pi - math.atan2(1.0, 1.5) - math.acos(0.22 / reach))
    exact = 2 * tangent + arc
    assert exact - 0.06 <= free.shortest_m(a, b) <= 1.03 * exact + 0.1


def test_random_points_are_free_and_everywhere() -> None:
    world = load_world("office")
    free = FreeSpace(world, 0.22)
    rng = np.random.default_rng(0)
    points = [free.random_point(rng) for _ in range(400)]
    assert all(free.is_free(x, y) for x, y in points)
    assert len({(int(x), int(y)) for x, y in points}) > 60


def test_no_start_fits() -> None:
    free = FreeSpace(room(side=0.8), 0.5)
    assert free.refusal(0.4, 0.4) == "(0.4, 0.4) is 0.400 m from walls[0] (wall); the robot needs 0.5 m"


def test_a_robot_that_leans_on_a_wall_still_has_a_way() -> None:
    assert not FREE.is_free(0.2, 0.5)
    assert FREE.shortest_m((0.2, 0.5), (3.5, 0.5)) == pytest.approx(3.3, abs=0.15)
    assert FREE.shortest_m((0.15, 0.5), (3.5, 0.5)) == math.inf


def _share_near(space: FreeSpace, places: np.ndarray, metres: float) -> float:
    return space.cover(np.zeros(space.grid, np.bool_), places, metres) / space.floor_cells


def test_the_share_of_the_floor_near_a_path_is_that_of_a_slow_count() -> None:
    space = FreeSpace(load_world("loop"), 0.22, cell_m=0.25)
    places = np.array([(space.world.starts[0].x, space.world.starts[0].y), (3.1, 0.9), (-50.0, 2.0), (3.0, 3.0)])
    points = _open_points(space)
    near = [min(space.shortest_m(point, (x, y)) for x, y in places[:2]) for point in points]
    for metres in (0.6, 1.0, 2.5):
        share = _share_near(space, places, metres)
        assert share == pytest.approx(np.mean([away <= metres for away in near]), abs=0.06)
    assert _share_near(space, np.array([(3.0, 3.0)]), 9.0) == 0.0  # in the walls
    assert _share_near(space, places, 100.0) == 1.0


def _open_points(space: FreeSpace) -> list[tuple[float, float]]:
    x0, y0, x1, y1 = space.world.bounds
    cells = [(x, y) for x in np.arange(x0 + 0.125, x1, 0.25) for y in np.arange(y0 + 0.125, y1, 0.25)]
    return [(float(x), float(y)) for x, y in cells if space.is_free(x, y)]


@pytest.mark.parametrize(("name", "count"), [("loop", 1), ("office", 0), ("twins", 1), ("corridors", 1)])
def test_islands_are_what_the_floor_surrounds(name: str, count: int) -> None:
    space = FreeSpace(load_world(name), 0.22)
    islands = space.islands(4.0)
    assert islands.shape == (count, 2)
    assert not any(space.is_free(x, y) for x, y in islands)
    assert len(space.islands(0.0)) >= count
    assert len(space.islands(1e4)) == 0
