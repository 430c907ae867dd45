"""Routes are followed and given up; the robot coasts on the old one for a while, and turns back from walls."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.pilot import PilotParams
from app.pilot.bars import crosses
from app.pilot.route_following import COAST_S, LOOK_AROUND_S, LOST_S, NO_HEADWAY_S, REPLAN_S, RouteFollower
from ratslam_core import Pose2
from sim2d import Simulator, World
from sim2d.world.world import SlowZone

from .pilots import DT, EXPLORING, Run, a_pilot, follow
from .worlds import EXACT, HandMadeMap, chain, room

pytestmark = pytest.mark.slow


def a_follower(map_: HandMadeMap) -> RouteFollower:
    """Of a route to the map's last place."""
    return RouteFollower(len(map_) - 1)


def a_run(*walls: tuple[float, float, float, float], stops: list[tuple[float, float]], seed: int = 0) -> Run:
    """A robot at the first of a chain of places, whatever walls lie across it."""
    world = room(*walls, start=(*stops[0], 0.0))
    return Run(Simulator(world, EXACT, seed), a_pilot(seed), HandMadeMap(*chain(*stops)))


def to_the_end(run: Run) -> int:
    """Send it to the last place."""
    run.pilot.set_goal(len(run.map) - 1)
    return len(run.map) - 1


def until(run: Run, condition: Callable[[], bool], most_s: float) -> None:
    """most_s: since it began."""
    while not condition():
        run.tick()
        assert len(run.track) < 10 * most_s


def test_progress_counts_down_along_the_links() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (4.0, 0.0), (4.0, 2.0)))
    follower, told = a_follower(map_), []
    for x in range(5):
        map_.robot = Pose2(float(x), 0.1, 0.0)
        for _ in range(11):
            assert follow(follower, map_) is not None
        progress = follower.progress(map_)  # type: ignore[arg-type]
        assert (progress.state, progress.route[-1]) == ("tracking", follower.goal)
        assert len(progress.route) == len(progress.arrival_s)
        assert np.all(np.diff(progress.arrival_s) > 0)
        told.append((progress.eta_s, progress.remaining_m))
    etas, remaining = zip(*told, strict=True)
    assert etas == pytest.approx([(6.0 - x) / 0.3 for x in range(5)], abs=2.1)
    assert remaining == pytest.approx([6.1 - x for x in range(5)], abs=0.3)


def test_the_robot_heads_for_a_point_ahead_on_the_route() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (4.0, 0.0)))
    for heading in (0.0, 1.0, -2.5, math.pi):
        map_.robot = Pose2(1.0, 0.2, heading)
        target = follow(a_follower(map_), map_)
        assert target is not None
        there = map_.robot.compose(Pose2(*target, 0.0))
        assert there.y == pytest.approx(0.0, abs=1e-9)
        assert 1.6 <= there.x <= 2.3


def test_a_brand_new_experience_is_left_by_way_of_a_near_one() -> None:
    """The active experience is new and not linked to anything yet."""
    places, links = chain((0.0, 0.0), (3.0, 0.0))
    map_ = HandMadeMap([*places, (0.3, 0.35)], links)
    map_.robot = Pose2(0.3, 0.34, 0.0)
    assert map_.active == len(places)
    follower = RouteFollower(len(places) - 1)
    assert (follow(follower, map_) is not None, follower.state) == (True, "tracking")


def test_a_lost_route_is_coasted_on_then_given_up() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (6.0, 0.0)))
    follower = a_follower(map_)
    states = []
    for tick in range(400):
        if tick == 20:
            map_.links, map_.link_times = map_.links[:0], map_.link_times[:0]
        map_.robot = Pose2(min(0.03 * tick, 1.5), 0.0, 0.0)
        target = follow(follower, map_)
        states.append(follower.state)
        assert (target is None) == (follower.state in ("exploring", "unreachable"))
        progress = follower.progress(map_)  # type: ignore[arg-type]
        assert (progress.eta_s is None) == (progress.remaining_m is None) == (target is None)
    seconds = {state: states.count(state) * DT for state in set(states)}
    order = list(dict.fromkeys(states))
    assert order == ["tracking", "coasting", "exploring", "unreachable"]
    assert seconds["tracking"] + seconds["coasting"] == pytest.approx(2 + COAST_S, abs=REPLAN_S + 0.2)
    assert seconds["exploring"] == pytest.approx(LOST_S, abs=0.2)


@pytest.mark.parametrize("seed", range(3))
def test_a_blocked_way_is_left(seed: int) -> None:
    """The map has a way where there is a wall. The robot looks around instead of pushing for ever."""
    run = a_run((2.0, 0.0, 2.0, 3.0), stops=[(1.0, 0.6), (3.0, 0.6)], seed=seed)
    goal = to_the_end(run)
    until(run, lambda: run.pilot.goal_state != (goal, "tracking"), 6 * NO_HEADWAY_S)
    assert len(run.track) >= 10 * NO_HEADWAY_S
    assert run.pilot.goal_state == (goal, "exploring")
    before = Counter(run.doing)  # it may have to free itself from the corner first
    until(run, lambda: run.pilot.goal_state != (goal, "exploring"), 6 * NO_HEADWAY_S + 60)
    looked = run.doing - before
    assert sum(looked[doing] for doing in EXPLORING) > 10 * (LOOK_AROUND_S - 4)
    assert run.pilot.goal_state in ((goal, "tracking"), (goal, "arrived"))  # and tries again


def two_ways() -> tuple[World, list[tuple[float, float]], list[tuple[int, int]]]:
    """A wall between the robot and its goal with a door that is shut, which three rows of links pass, and a way round."""
    world = room((2.0, 0.0, 2.0, 3.0), start=(1.0, 0.6, 0.0))
    places, links = chain((1.0, 0.6), (3.0, 0.6))
    goal = len(places) - 1
    for y in (0.3, 0.95):
        more, joined = chain((1.2, y), (2.8, y))
        links += [(i + len(places), j + len(places)) for i, j in joined]
        links += [(1, len(places)), (len(places) + len(more) - 1, goal - 1)]
        places += more
    more, joined = chain((0.8, 0.8), (0.8, 3.5), (3.2, 3.5), (3.2, 0.7))
    links += [(i + len(places), j + len(places)) for i, j in joined]
    links += [(0, len(places)), (len(places) + len(more) - 1, goal)]
    return world, places + more, links


@pytest.mark.parametrize("seed", [1, 3, 6])  # with 0 and 2, it comes round by looking around, before a link is deleted
def test_a_door_that_was_shut_is_given_up(seed: int) -> None:
    """As in ACRA 2006: all ways through the door fail together, not one after the other, and the robot goes round."""
    world, places, links = two_ways()
    map_, goal = HandMadeMap(places, links), round(2.0 / 0.25)
    map_.patience = 4
    run = Run(Simulator(world, EXACT, seed), a_pilot(seed, bar_fade_s=0.0), map_)
    run.pilot.set_goal(goal)
    until(run, lambda: run.pilot.goal_state == (goal, "arrived"), 120)
    assert math.dist(run.truth, places[goal]) < 0.4
    gone = {tuple(link) for link in links} - {(int(i), int(j)) for i, j in map_.links}
    assert gone
    assert all(max(places[i][1], places[j][1]) < 1.5 for i, j in gone)  # nothing of the way round
    assert {(i, j) for i, j, well in map_.trials if well} - gone  # and links that were driven have been on trial, too


def test_what_was_driven_of_a_route_was_a_trial_and_headway_is_no_reason_to_look_around() -> None:
    map_ = HandMadeMap(*chain((0.0, 0.0), (20.0, 0.0)))
    follower = a_follower(map_)
    for tick in range(600):
        map_.robot = Pose2(0.03 * tick, 0.0, 0.0)
        follow(follower, map_)
        assert follower.state == "tracking"
        if tick == 149:
            assert len({(i, j) for i, j, _ in map_.trials}) >= 8  # a plan may begin beyond the end of the one before
            assert {(i, j) for i, j, _ in map_.trials} <= {(k, k + 1) for k in range(18)}
    assert all(well for _, _, well in map_.trials)


@settings(max_examples=200)
@given(st.lists(st.tuples(*[st.floats(-2, 2)] * 4), max_size=8), st.tuples(*[st.floats(-2, 2)] * 4))
def test_crossing_a_bar_is_what_points_on_both_lines_are(lines, bar) -> None:
    """By solving for where the two lines meet."""
    ends = np.array(lines).reshape(-1, 4)
    found = crosses(np.array(bar).reshape(2, 2), ends[:, :2], ends[:, 2:])
    for (ax, ay, bx, by), answer in zip(ends, found, strict=True):
        along = np.array([[bx - ax, bar[0] - bar[2]], [by - ay, bar[1] - bar[3]]])
        if abs(along[0, 0] * along[1, 1] - along[0, 1] * along[1, 0]) < 1e-6:
            continue  # parallel, or no length
        t, u = np.linalg.solve(along, np.array([bar[0] - ax, bar[1] - ay]))
        if min(abs(t), abs(t - 1), abs(u), abs(u - 1)) > 1e-6:  # not just touching
            assert bool(answer) is bool(0 < t < 1 and 0 < u < 1)


def test_a_slow_floor_is_not_blocked() -> None:
    """The wheels give a fifth of what is asked for. Nothing is in the way, so no bar is put up."""
    run = a_run(stops=[(1.0, 0.6), (3.4, 0.6), (3.4, 3.0)])
    x, y, right, top = run.simulator.world.bounds
    zone = SlowZone("slippery", ((x, y), (right, y), (right, top), (x, top)), 0.2)
    run.simulator.set_world(replace(run.simulator.world, slow_zones=(zone,)))
    goal = to_the_end(run)
    run.run(150.0)
    assert (run.doing["freeing itself"], run.pilot.goal_state) == (0, (goal, "arrived"))


def test_a_door_that_opens_again_is_found_again() -> None:
    """The only way is shut when the robot comes. It never gives the goal up, and is there soon after it has opened."""
    run = a_run((2.0, 0.0, 2.0, 4.0), stops=[(1.0, 2.0), (3.4, 2.0)], seed=1)
    goal = to_the_end(run)
    run.run(40.0)
    assert run.pilot.goal_state != (goal, "arrived")
    run.simulator.set_world(room(start=(1.0, 2.0, 0.0)))
    run.run(60.0)
    assert run.pilot.goal_state == (goal, "arrived")


def test_why_no_route_is_known_is_told() -> None:
    """The map's two halves have lost their link, or never had one; or it was carried to another submap; or it looks round."""
    halves = HandMadeMap([(0.0, 0.0), (1.0, 0.0), (5.0, 0.0), (6.0, 0.0)], [(0, 1), (2, 3)])
    for dropped, why in (
        ([], "no links lead there"),
        ([(0, 1)], "no links lead there"),
        ([(1, 2)], "its links were deleted"),
    ):
        halves.dropped_links, follower = dropped, a_follower(halves)
        assert follow(follower, halves) is None
        assert follower.progress(halves).why == follower.why == why  # type: ignore[arg-type]
    halves.landed = 2
    assert follower.carried_away(halves, DT)  # type: ignore[arg-type]
    assert follower.why == "on another submap"
    whole = HandMadeMap(*chain((0.0, 0.0), (3.0, 0.0)))
    follower = a_follower(whole)
    assert follow(follower, whole) is not None
    assert follower.why == ""
    follower._look_around_s = LOOK_AROUND_S
    assert follow(follower, whole) is None
    assert follower.why == "blocked on the way"


def test_carried_away_from_the_goal_it_looks_for_the_way_back() -> None:
    """It stands at its goal when it is put down elsewhere. Once it notices, it is on a submap: it does not stand there, as
    if it had arrived, but drives; and it goes on to the goal when the submap has become a part of the map again."""
    run = a_run((2.0, 0.0, 2.0, 2.8), stops=[(1.0, 0.6), (1.0, 3.4), (3.0, 3.4), (3.0, 0.6)])
    run.pilot.set_goal(0)
    run.run(5.0)
    assert run.pilot.goal_state == (0, "arrived")
    run.simulator.teleport(3.0, 1.6, 0.0)
    run.map.landed = len(run.map) // 2  # the half of the map where it now is
    run.run(10.0)
    assert run.pilot.goal_state == (0, "exploring")
    assert len({(round(x, 1), round(y, 1)) for x, y in run.track[-100:]}) > 5
    run.map.landed = len(run.map)
    run.run(60.0)
    assert run.pilot.goal_state == (0, "arrived")
    assert math.dist(run.truth, (1.0, 0.6)) < 0.2


def test_who_is_lost_has_not_arrived() -> None:
    """It only believes to be at its goal: it looks around, and has arrived when it knows where it is. Nor does it say that there
    is no way, as long as it does not know from where."""
    run = a_run(stops=[(1.0, 0.6), (3.0, 0.6)])
    map_, told = run.map, set[str]()
    map_.lost = True
    goal = to_the_end(run)
    for _ in range(600):
        run.tick()
        told.add(run.pilot.goal_state[1])  # type: ignore[index]
    assert told == {"tracking", "exploring"}
    assert len({(round(x, 1), round(y, 1)) for x, y in run.track}) > 20
    map_.lost = False
    run.run(60.0)
    assert run.pilot.goal_state == (goal, "arrived")
    map_.lost = True
    run.run(1.0)
    assert run.pilot.goal_state == (goal, "exploring")
    map_.lost = False
    run.run(60.0)
    map_.suspects_kidnap = True
    run.run(1.0)
    assert run.pilot.goal_state == (goal, "exploring")
    map_.landed, map_.robot = 1, Pose2(1.0, 0.6, 0.0)  # it is on a submap, the goal is not
    follower = RouteFollower(goal)
    for map_.lost, state in ((True, "exploring"), (False, "unreachable")):
        for _ in range(600):
            assert follower.carried_away(map_, DT)  # type: ignore[arg-type]
        assert follower.state == state


def test_the_last_metre_is_driven_straight() -> None:
    """The route comes to the goal by a way round; where the sonars see that nothing lies between, the robot cuts it."""
    map_ = HandMadeMap(*chain((0.0, 0.0), (0.0, 3.0), (0.8, 3.0), (0.8, 0.0)))
    for approach, aims_at_goal in ((1.0, True), (0.5, False)):
        aim = follow(a_follower(map_), map_, PilotParams(approach_m=approach))
        assert (aim == (0.8, 0.0)) is aims_at_goal


def test_the_robot_stays_on_its_route_unless_another_is_much_quicker() -> None:
    """Where two rows of experiences lie side by side, it does not swerve between them with every plan."""
    places, links = chain((0.0, 0.0), (6.0, 0.0))
    other, joined = chain((0.0, 0.3), (6.0, 0.3))
    n, goal = len(places), len(places) - 1
    links += [(i + n, j + n) for i, j in joined] + [(n + len(other) - 1, goal)]
    map_ = HandMadeMap(places + other, links)
    for saves, stays in ((2.0, True), (20.0, False)):
        map_.link_times[:] = 1.0
        follower = RouteFollower(goal)
        follow(follower, map_)
        map_.link_times[goal - 1] += saves  # the end of the first row
        for _ in range(15):
            follow(follower, map_)
        assert bool(follower.progress(map_).route[0] < n) is stays  # type: ignore[arg-type]


def test_a_route_beside_it_is_kept() -> None:
    """The map has two passes of one corridor 1.2 m apart: along the one it need not turn back to follow the other."""
    places, links = chain((0.0, 0.0), (8.0, 0.0))
    own, joined = chain((0.0, 0.0), (1.0, 0.3), (2.0, 1.2), (4.0, 1.2), (6.0, 2.4))
    n, goal = len(places), len(places) - 1
    links += [(0, n), *((i + n, j + n) for i, j in joined)]  # they were one place only where they began
    map_ = HandMadeMap(places + own, links)
    follower = RouteFollower(goal)
    for x, y, stays in ((1.0, 0.3, True), (2.0, 1.2, True), (4.0, 1.2, True), (6.0, 2.4, False)):
        map_.robot = Pose2(x, y, 0.0)
        for _ in range(15):
            follow(follower, map_)
        assert bool(follower.progress(map_).route[0] < n) is stays  # type: ignore[arg-type]


def test_close_by_and_not_getting_nearer_is_there() -> None:
    """At a goal in a corner where the robot just does not fit."""
    map_ = HandMadeMap(*chain((0.0, 0.0), (3.0, 0.0)))
    for away, arrives in ((0.5, True), (0.7, False)):
        follower = a_follower(map_)
        map_.robot = Pose2(3.0 - away, 0.0, 0.0)
        for _ in range(80):
            follow(follower, map_)
        assert (follower.state == "arrived") is arrives
    assert follow(follower, map_) is not None
