"""Where the robot fits, which ways there are, and what lies within some metres of driving."""

from __future__ import annotations

import heapq
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim2d import FreeSpace, load_world
from sim2d.geometry.grid_cells import spread
from sim2d.geometry.segments import free_cells, inside_ring, nearest_segment

from .rooms import room, wall

BOX = (wall(0.5, 3, 1.5, 3), wall(1.5, 3, 1.5, 4), wall(0.5, 4, 0.5, 3))  # closed in, with the outer wall
FREE = FreeSpace(room(*BOX), 0.22)
KNIGHTS = [(1, 2), (2, 1), (-1, 2), (-2, 1)]
MOVES = [(0, 1), (1, 0), (1, 1), (-1, 1), *KNIGHTS]
BOTH_WAYS = np.array(MOVES + [(-y, -x) for y, x in MOVES])


def test_the_nearest_wall_the_inside_of_a_ring_and_the_cells_between() -> None:
    square = room().segments()
    ring, slant = square[:, :2], np.array([[1.0, 1.0, 3.0, 2.0]])
    assert nearest_segment(square, 1.0, 2.0) == (3, 1.0)
    assert nearest_segment(square, 3.0, 3.5) == (2, 0.5)
    assert nearest_segment(square, 7.0, 8.0) == (1, 5.0)  # beyond an end: to the corner
    assert inside_ring(ring, 1.0, 1.0)
    assert not any(inside_ring(ring, x, y) for x, y in [(-1.0, 1.0), (5.0, 1.0), (1.0, 5.0), (1.0, -1.0)])
    xs, ys, segments = np.arange(-0.9, 5.0, 0.2), np.arange(-0.9, 5.0, 0.2), np.concatenate([square, slant])
    slow = [[inside_ring(ring, x, y) and nearest_segment(segments, x, y)[1] >= 0.22 for x in xs] for y in ys]
    assert free_cells(segments, ring, xs, ys, 0.22).tolist() == slow
    assert {True, False} <= {free for row in slow for free in row}


def test_refusals_say_why() -> None:
    assert FREE.is_free(2.0, 2.0)
    assert FREE.refusal(2.0, 2.0) is None
    assert FREE.refusal(math.nan, 1.0) == "(nan, 1.0) is not a place; both must be finite"
    assert FREE.refusal(5.0, 1.0) == "(5, 1) is outside of room, which spans 0 to 4 by 0 to 4 m"
    assert FREE.refusal(3.9, 1.0) == "(3.9, 1) is 0.100 m from walls[1] (wall); the robot needs 0.22 m"
    assert FREE.refusal(1.0, 3.5) == "(1, 3.5) is closed in: no way leads there from home"
    assert FREE.clearance(1.0, 2.5) == 0.5
    no_start_fits = FreeSpace(room(side=0.8), 0.5)
    assert no_start_fits.refusal(0.4, 0.4) == "(0.4, 0.4) is 0.400 m from walls[0] (wall); the robot needs 0.5 m"


def test_ways_are_straight_where_they_can_be() -> None:
    assert FREE.shortest_m((0.5, 0.5), (3.5, 0.5)) == pytest.approx(3.0, abs=0.06)
    assert FREE.shortest_m((0.5, 0.5), (0.53, 0.5)) == pytest.approx(0.03)
    assert FREE.shortest_m((0.5, 0.5), (1.0, 3.5)) == FREE.shortest_m((0.5, 9.5), (1.0, 1.0)) == math.inf
    assert not FREE.is_free(0.2, 0.5)  # leaning on a wall
    assert FREE.shortest_m((0.2, 0.5), (3.5, 0.5)) == pytest.approx(3.3, abs=0.15)
    assert FREE.shortest_m((0.15, 0.5), (3.5, 0.5)) == math.inf


def test_a_way_round_a_wall() -> None:
    """Around a wall's free end the way touches the circle of the robot's radius: two tangents and an arc."""
    free = FreeSpace(room(wall(2.6, 0, 2.6, 2.5)), 0.22)
    reach = math.hypot(1.0, 1.5)
    arc = 2 * 0.22 * (math.pi - math.atan2(1.0, 1.5) - math.acos(0.22 / reach))
    exact = 2 * math.sqrt(reach**2 - 0.22**2) + arc
    assert exact - 0.06 <= free.shortest_m((1.6, 1.0), (3.6, 1.0)) <= 1.03 * exact + 0.1


def test_random_points_are_free_and_everywhere() -> None:
    free, rng = FreeSpace(load_world("office"), 0.22), np.random.default_rng(0)
    points = [free.random_point(rng) for _ in range(400)]
    assert all(free.is_free(x, y) for x, y in points)
    assert len({(int(x), int(y)) for x, y in points}) > 60


def test_islands_are_what_the_floor_surrounds(subtests: pytest.Subtests) -> None:
    for name, count in {"loop": 1, "office": 0, "twins": 1, "corridors": 1}.items():
        with subtests.test(name):
            space = FreeSpace(load_world(name), 0.22)
            islands = space.islands(4.0)
            assert islands.shape == (count, 2)
            assert not any(space.is_free(x, y) for x, y in islands)
            assert len(space.islands(0.0)) >= count
            assert len(space.islands(1e4)) == 0


def test_the_share_of_the_floor_near_a_path_is_that_of_a_slow_count() -> None:
    space = FreeSpace(load_world("loop"), 0.22, cell_m=0.25)
    places = np.array([(space.world.starts[0].x, space.world.starts[0].y), (3.1, 0.9), (-50.0, 2.0), (3.0, 3.0)])

    def share_near(places: np.ndarray, metres: float) -> float:
        return space.cover(np.zeros(space.grid, np.bool_), places, metres) / space.floor_cells

    x0, y0, x1, y1 = space.world.bounds
    cells = [(x, y) for x in np.arange(x0 + 0.125, x1, 0.25) for y in np.arange(y0 + 0.125, y1, 0.25)]
    near = [min(space.shortest_m(cell, (x, y)) for x, y in places[:2]) for cell in cells if space.is_free(*cell)]
    for metres in (0.6, 1.0, 2.5):
        assert share_near(places, metres) == pytest.approx(np.mean([away <= metres for away in near]), abs=0.06)
    assert share_near(np.array([(3.0, 3.0)]), 9.0) == 0.0  # in the walls
    assert share_near(places, 100.0) == 1.0


def slowly(free: np.ndarray, seeds: list[tuple[int, int]], reach: float) -> np.ndarray:
    """Dijkstra over the whole grid."""
    heap = [(0.0, seed) for seed in seeds if free[seed]]
    away = np.full(free.shape, np.inf)
    for _, seed in heap:
        away[seed] = 0.0
    while heap:
        so_far, (y, x) = heapq.heappop(heap)
        for dy, dx in BOTH_WAYS:
            j, i = y + int(dy), x + int(dx)
            if 0 <= j < free.shape[0] and 0 <= i < free.shape[1] and free[j, i]:
                there = so_far + math.hypot(dy, dx)
                if there < away[j, i] - 1e-9:
                    away[j, i] = there
                    heapq.heappush(heap, (there, (j, i)))
    return away <= reach


@given(st.integers(0, 10**6), st.integers(1, 25), st.integers(1, 25), st.integers(1, 4), st.floats(0.5, 12.0))
def test_it_spreads_as_dijkstra_says_on_the_whole_grid(
    seed: int, n_y: int, n_x: int, starts: int, reach: float
) -> None:
    rng = np.random.default_rng(seed)
    free = rng.random((n_y, n_x)) < 0.75
    seeds = [(int(rng.integers(n_y)), int(rng.integers(n_x))) for _ in range(starts)]
    marked = rng.random((n_y, n_x)) < 0.1
    before = marked.copy()
    reach = round(reach, 3) + 0.0003  # no sum of moves is as long as that
    new = spread(free, marked, np.array(seeds), reach, BOTH_WAYS)
    assert np.array_equal(marked, before | slowly(free, seeds, reach))
    assert new == np.count_nonzero(marked) - np.count_nonzero(before)
