"""Times and routes against the papers' own relaxation and SciPy, while links are added, removed and changed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, TemporalMap
from ratslam_core.pose_graph import transitions
from ratslam_core.solvers import dijkstra
from tests.property.timed_links import LEAST_S, Links, by_scipy, change, check_route, links, relax, ways_of
from tests.unit.ratslam_core import literal
from tests.unit.ratslam_core.literal import also_interpreted


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.slow
def test_a_map_that_was_mended_is_as_good_as_new(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same goal again and again while the map changes: the papers' times, SciPy's, and a fresh answer bit for bit."""
    if interpreted:
        literal.interpret(dijkstra, monkeypatch)
        literal.interpret(transitions, monkeypatch)

    @settings(max_examples=40 if interpreted else 200)
    @given(st.integers(1, 12), st.data())
    def agrees(n: int, data: st.DataObject) -> None:
        map_ = Links(np.zeros((n, 3)))
        ways = ways_of(map_)
        goal = data.draw(st.integers(0, n - 1))
        for _ in range(data.draw(st.integers(1, 6))):
            for _ in range(data.draw(st.integers(0, 6))):
                change(map_, data)
            if data.draw(st.integers(0, 5)) == 0:
                goal = data.draw(st.integers(0, len(map_) - 1))
            times, start = ways.times_to(goal), data.draw(st.integers(0, len(map_) - 1))
            fresh = ways_of(map_)
            assert np.array_equal(times, fresh.times_to(goal))
            assert times == pytest.approx(relax(map_, goal))
            assert times == pytest.approx(by_scipy(map_, goal))
            check_route(map_, ways, start, goal)
            mended, new = ways.route(start, goal), fresh.route(start, goal)
            assert (mended is None) == (new is None)
            assert mended is None or new is None or mended.experiences.tolist() == new.experiences.tolist()

    agrees()


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.0, 0.4]))
@pytest.mark.slow
def test_large_maps_agree_with_scipy(seed: int, shortcut_m: float) -> None:
    """Chains with closures, as a robot makes them; heaps outgrow their first room."""
    rng = np.random.default_rng(seed)
    n = 400
    map_ = Links(np.cumsum(rng.normal(0, 0.2, (n, 3)), 0), pace=float(rng.uniform(0, 4)))
    map_.params = replace(map_.params, shortcut_m=shortcut_m)
    for k in range(1, n):
        map_.link(k - 1 if rng.random() < 0.9 else int(rng.integers(k)), k, float(rng.exponential()))
    for _ in range(100):
        map_.link(int(rng.integers(n)), int(rng.integers(n)), float(rng.exponential()))
    hub = int(rng.integers(n))
    for k in range(0, n, 3):
        map_.link(hub, k, float(rng.uniform(20, 40)))
    ways = ways_of(map_)
    for _ in range(3):
        assert ways.times_to(hub) == pytest.approx(by_scipy(map_, hub))
        map_.poses[:, :2] += rng.normal(0, 0.02, (n, 2))
        map_.unlink(int(rng.choice(np.flatnonzero(map_.transitions.travelled))))
        map_.link(int(rng.integers(n)), int(rng.integers(n)), 0.1)


@settings(max_examples=60)
@given(st.integers(1, 12), st.data())
@pytest.mark.slow
def test_of_several_goals_the_quickest_counts(n: int, data: st.DataObject) -> None:
    """While the map changes: the least of the times to each, bit for bit, and the route ends at one that takes it."""
    map_ = Links(np.zeros((n, 3)))
    ways = ways_of(map_)
    goals = data.draw(st.lists(st.integers(0, n - 1), min_size=1, max_size=4))
    for _ in range(data.draw(st.integers(1, 5))):
        for _ in range(data.draw(st.integers(0, 6))):
            change(map_, data)
        each = [ways_of(map_).times_to(goal) for goal in goals]
        assert np.array_equal(ways.times_to(goals), np.min(each, axis=0))
        start = data.draw(st.integers(0, len(map_) - 1))
        route = ways.route_again(start)
        assert (route is None) == bool(np.isinf(np.min(each, axis=0)[start]))
        if route is not None:
            end = int(route.experiences[-1])
            assert end in goals
            assert each[goals.index(end)][start] == route.arrival_s[-1]


def test_of_equal_ways_that_over_lower_numbers_is_taken() -> None:
    ways = ways_of(links(5, [(0, 3, 1.0), (3, 4, 1.0), (0, 2, 1.0), (2, 4, 1.0), (4, 1, 1.0), (1, 0, 1.0)]))
    route = ways.route(0, 4)
    assert route is not None
    assert route.experiences.tolist() == [0, 1, 4]


def test_a_delay_sends_the_robot_round() -> None:
    """And only while it lasts."""
    links = Links(np.zeros((3, 3)))
    direct = links.link(0, 2, 5.0)
    links.link(0, 1, 4.0)
    links.link(1, 2, 4.0)
    ways, delays = TemporalMap(links), np.zeros(links.transitions.count)
    for delay, expected in ((0.0, [0, 2]), (2.9, [0, 2]), (3.1, [0, 1, 2]), (0.0, [0, 2])):
        delays[direct] = delay
        assert ways.times_to(2, delays).tolist() == [min(5.0 + delay, 8.0), 4.0, 0.0]
        route = ways.route(0, 2, delays)
        assert route is not None
        assert route.experiences.tolist() == expected
    assert ways.times_to(2)[0] == 5.0


def test_few_links_by_hand() -> None:
    """Of parallel links the quickest counts, one of no time is a link, and an answer is the asker's own."""
    ways = ways_of(links(6, [(0, 1, 5.0), (1, 0, 2.0), (0, 1, 3.0), (1, 2, 0.0), (3, 4, 1.0)]))
    ways.times_to(2)[:] = 7.0
    assert ways.times_to(2).tolist() == [2.0 + LEAST_S, LEAST_S, 0.0, math.inf, math.inf, math.inf]
    for start, goal, expected in ((0, 2, [0, 1, 2]), (3, 3, [3]), (0, 4, None)):
        route = ways.route(start, goal)
        assert (route and route.experiences.tolist()) == expected
        assert route is None or route.arrival_s[0] == 0.0


def test_a_shortcut_saves_the_way_round() -> None:
    """Up one side of a U and down the other, a metre apart; the robot needs 4 s per metre."""
    up, across, down = [(0.0, y) for y in range(6)], [(0.5, 5.0)], [(1.0, y) for y in range(5, -1, -1)]
    places = np.array([(x, y, 0.0) for x, y in up + across + down])
    for shortcut_m, saves in ((0.0, False), (0.5, False), (1.2, True)):
        map_ = Links(places, pace=4.0, params=ExperienceMapParams(shortcut_m=shortcut_m))
        for k in range(len(places) - 1):
            map_.link(k, k + 1, 1.0)
        route = ways_of(map_).route(0, len(places) - 1)
        assert route is not None
        assert route.arrival_s[-1] == pytest.approx(4.0 if saves else 44.0)
        assert (len(route.experiences) == 2) is saves


def test_a_shortcut_is_closer_than_its_limit() -> None:
    for apart_m, time_s in ((0.5, math.inf), (0.4375, 0.875), (0.0, LEAST_S)):
        for places in (
            [(-0.25, 0.25, 0.0), (apart_m - 0.25, 0.25, 0.0)],
            [(3.0, apart_m - 1.0, 0.0), (3.0, -1.0, 0.0)],
        ):
            map_ = Links(np.array(places), pace=2.0, params=ExperienceMapParams(shortcut_m=0.5))
            assert ways_of(map_).times_to(0).tolist() == [0.0, time_s]


@also_interpreted(dijkstra, transitions)
def test_a_crowd_within_reach_of_each_other() -> None:
    """Only shortcuts, between all pairs: more of them are in the heap than it had room for at first."""
    rng = np.random.default_rng(5)
    places = np.column_stack([rng.uniform(0, 1, (90, 2)), np.zeros(90)])
    map_ = Links(places, pace=2.0, params=ExperienceMapParams(shortcut_m=3.0))
    away = np.hypot(*(places[:, :2] - places[7, :2]).T)
    assert ways_of(map_).times_to(7) == pytest.approx(2.0 * away, abs=2e-3)


def test_unknown_experiences_are_refused() -> None:
    ways = ways_of(links(4, [(0, 1, 1.0)]))
    for bad in (-1, 4):
        for ask in (
            lambda bad=bad: ways.times_to(bad),
            lambda bad=bad: ways.route(bad, 0),
            lambda bad=bad: ways.route(0, bad),
        ):
            with pytest.raises(ValueError, match=f"experience must be from 0 to 3, got {bad}"):
                ask()
    with pytest.raises(ValueError, match="goal must be an experience or several, got none"):
        ways.times_to([])
    with pytest.raises(ValueError, match="no times are known for experience 0; ask for `times_to` a goal first"):
        ways_of(links(3, [(0, 1, 1.0)])).route_again(0)
