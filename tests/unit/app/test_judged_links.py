"""False observations, broken odometry and closed loops, on small maps of which everything is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from app.evaluation import backbone, loops_closed, observations
from ratslam_core import ExperienceMap, Pose2

TICK_S = 0.1


def births_along(path: list[Pose2]) -> NDArray[np.float64]:
    """An experience made in each tick."""
    return np.array([(p.x, p.y, p.heading_rad, k * TICK_S) for k, p in enumerate(path)])


def linked(path: list[Pose2], rows: list[tuple[int, int, Pose2, bool]]) -> ExperienceMap:
    """A map with these rows: from, to, how far off its move is, whether it is odometry."""
    map_ = ExperienceMap((36, 64, 64), 0.25)
    for _ in path:
        map_.transitions.graph.add_node()
    for i, j, off, chain in rows:
        move = path[i].inverse().compose(path[j]).compose(off)
        row = map_.transitions.add(i, j, travelled=True)
        map_.transitions.measure(row, move, 1.0, np.zeros(3), 0.0)
        map_.transitions.chain[row] = chain
    return map_


WAY = [Pose2(0.5 * k, 0.2 * k, 0.1 * k) for k in range(10)]


@settings(max_examples=40)
@given(st.integers(0, 9), st.integers(0, 9), st.floats(-4, 4), st.floats(-4, 4), st.floats(-3, 3))
def test_a_link_is_off_by_as_much_as_its_end_is_elsewhere(i: int, j: int, x: float, y: float, turn: float) -> None:
    map_ = linked(WAY, [(i, j, Pose2(x, y, turn), False)])
    found = observations(map_, births_along(WAY))
    assert found.ends.tolist() == [[i, j]]
    assert found.off_m[0] == pytest.approx(math.hypot(x, y), abs=1e-9)
    assert bool(found.false[0]) == (found.off_m[0] > 1.0)


def test_observations_and_odometry_are_judged_apart_where_they_hold_and_join_what_is_known() -> None:
    wrong, right = Pose2(1.2, 0.0, 0.0), Pose2(0.3, 0.0, 0.0)
    rows = [(0, 1, right, True), (1, 2, wrong, True), (2, 0, right, False), (3, 0, wrong, False), (4, 0, wrong, False)]
    map_, births = linked(WAY, rows), births_along(WAY)
    map_.transitions.believed[3] = 0.1
    assert backbone(map_, births).false.tolist() == [False, True]
    assert observations(map_, births).false.tolist() == [False, True, True]
    assert observations(map_, births).believed.tolist() == [True, False, True]
    births[4] = np.nan
    map_.transitions.weight[2] = 0.0  # dropped
    assert observations(map_, births).ends.tolist() == [[3, 0]]
    map_.transitions.weight[3] = (0.01 / 2.0) ** 2  # it says itself that it may be 2 m off
    assert len(observations(map_, births).ends) == 0


def rounds(islands: list[tuple[float, float, float]], steps: int = 100) -> tuple[list[Pose2], NDArray[np.float64]]:
    """A path once round each island (x, y, +1 or -1 for the sense), from and to (0, 0), and the islands' middles."""
    path: list[Pose2] = []
    for x, y, sense in islands:
        start = math.atan2(-y, -x)
        for k in range(steps + 1):
            angle, r = start + sense * math.tau * k / steps, math.hypot(x, y)
            path.append(Pose2(x + r * math.cos(angle), y + r * math.sin(angle), 0.0))
    return path, np.array([(x, y) for x, y, _ in islands])


def closed(
    path: list[Pose2], islands: NDArray[np.float64], ends: list[tuple[int, int]], born_late_s: float = 0.0
) -> int:
    births, places = births_along(path), np.array([(p.x, p.y) for p in path])
    births[:, 3] += born_late_s
    return loops_closed(np.array(ends).reshape(-1, 2), births, places, islands, TICK_S)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_loop_is_closed_by_an_observation_from_its_end_to_its_beginning(sense: float) -> None:
    path, islands = rounds([(3.0, 1.0, sense)])
    assert closed(path, islands, [(99, 1)]) == closed(path, islands, [(1, 99)]) == 1
    assert closed(path, islands, [(99, 1)], born_late_s=0.04) == 1, "also where no tick of the path is at a birth"
    assert closed(path, islands, []) == 0
    assert closed(path, islands, [(20, 18), (60, 50)]) == 0  # a look back along the way closes nothing
    assert closed(path + path[::-1], islands, [(190, 10)]) == 0  # there and back again is not round


def test_loops_count_as_often_as_they_are_independent() -> None:
    path, islands = rounds([(3.0, 0.0, 1.0), (-3.0, 0.0, 1.0), (0.0, 4.0, -1.0)])
    one, two, three = (0, 100), (101, 201), (202, 302)
    for ends, loops in [([one, one], 1), ([one, (0, 201)], 2), ([one, two, (0, 201)], 2), ([one, two, three], 3)]:
        assert closed(path, islands, ends) == loops
    assert closed(path, np.zeros((0, 2)), [one, two]) == 0
