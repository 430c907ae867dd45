"""Each of the pilot's parameters changes what the pilot does, in a situation where that parameter decides."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest

from app.pilot import Pilot, PilotParams
from app.pilot.bars import Bars
from app.pilot.local_movement import LocalMovement
from app.pilot.loop_closing import LoopCloser
from app.pilot.route_following import RouteFollower
from ratslam_core import Odometry, Pose2
from sim2d import Simulator, World

from .pilots import ANGLES, DT, FAR, OUTWARD, STILL, Run, follow
from .test_loop_closing import almost_round
from .test_routes import two_ways
from .worlds import EXACT, HandMadeMap, chain, room

Trace = Iterator[object]


def arcs(p: PilotParams) -> Trace:
    """The arcs chosen among many kinds of echoes."""
    rng = np.random.default_rng(1)
    for _ in range(400):
        local = LocalMovement(ANGLES, p.echo_s)
        for _ in range(3):
            ranges = rng.uniform(0.2, 6.0, 8).astype(np.float32)
            local.sense(ranges, Odometry(float(rng.uniform(0, 0.5)), float(rng.uniform(-1, 1)), DT), p)
        yield local.towards(*rng.uniform(-0.8, 0.8, 2), p), local.free_way(0.0, p)


def a_run(p: PilotParams, world: World, map_: HandMadeMap | None = None, seed: int = 1) -> Run:
    return Run(Simulator(world, EXACT, seed), Pilot(p, ANGLES, np.random.default_rng(seed)), map_)


def exploring(p: PilotParams) -> Trace:
    run = a_run(p, room(side=6.0, start=(3.0, 3.0, 0.0)), seed=2)
    for _ in range(1200):
        run.tick()
        yield run.truth


def to_a_goal(run: Run, ticks: int = 900) -> Trace:
    run.pilot.set_goal(8)
    for _ in range(ticks):
        run.tick()
        yield run.truth, run.pilot.goal_state, len(run.map.trials)


def past_a_shut_door(p: PilotParams) -> Trace:
    world, places, links = two_ways()
    map_ = HandMadeMap(places, links)
    map_.patience = 4
    return to_a_goal(a_run(p, world, map_))


def at_a_wall(p: PilotParams) -> Trace:
    """A route that leads into a wall."""
    world = room((2.0, 0.0, 2.0, 3.0), start=(1.0, 0.6, 0.0))
    return to_a_goal(a_run(p, world, HandMadeMap(*chain((1.0, 0.6), (3.0, 0.6)))))


def standing(p: PilotParams) -> Trace:
    """Near the goal, then on a route whose links disappear, then between places that face another way."""
    map_ = HandMadeMap(*chain((0.0, 0.0), (6.0, 0.0)))
    goal, links, times = len(map_) - 1, map_.links, map_.link_times
    for away in (0.5, 1.1, 3.0):
        follower = RouteFollower(goal)
        map_.robot = Pose2(6.0 - away, 0.1, 0.3)
        for tick in range(600 if away == 3.0 else 80):
            if tick == 100:
                map_.links, map_.link_times = links[:0], times[:0]
            yield follow(follower, map_, p), follower.state
    map_.links, map_.link_times, map_.robot = links, times, Pose2(4.8, 0.1, 0.3)
    map_.poses[:, 2] = np.where(map_.poses[:, 0] < 4.8, 0.3, 1.5)
    follower = RouteFollower(goal)
    follow(follower, map_, p)
    yield follower.progress(map_).route.tolist()  # type: ignore[arg-type]


def side_by_side(p: PilotParams) -> Trace:
    """Two rows of places without a link between them; the one at which the robot is leads to the goal by a way round,
    or nowhere. There is a bar, and an echo from beside the robot."""
    for apart, round_s in ((0.3, 4.0), (0.3, 30.0), (0.3, 15.0), (1.2, np.inf), (2.5, np.inf)):
        places, links = chain((0.0, 0.0), (4.0, 0.0))
        n, goal = len(places), len(places) - 1
        links = [(i + n, j + n) for i, j in links] + [(0, 2 * n - 1)] * (round_s < np.inf)
        map_ = HandMadeMap([*places, *[(x, apart) for x, _ in places]], links)
        if round_s < np.inf:
            map_.link_times[-1] = 14.0 + round_s
        map_.poses[n:, 2] = 2.0
        map_.robot = Pose2(0.0, 0.0, 0.3)
        for distance in (0.5, 5.0):
            bars, local = Bars(), LocalMovement(ANGLES, p.echo_s)
            bars.add(Pose2(3.0, 3.0, 0.0), 0.0, p)
            local.sense(np.full(8, distance, np.float32), STILL, p)
            follower = RouteFollower(goal + n, bars)
            for _ in range(250):
                follower.step(map_, local, DT, p)  # type: ignore[arg-type]
                yield follower.state, follower.progress(map_).route.tolist()  # type: ignore[arg-type]


def failing_again(p: PilotParams) -> Trace:
    """Bars at one place, more than once."""
    bars, links = Bars(), np.array([(0, 1), (2, 3)])
    for _ in range(5):
        bars.add(Pose2(0.0, 0.0, 0.0), 0.0, p)
        for _ in range(300):
            bars.fade(DT)
        delays = bars.delays(links, np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 0.5), (1.0, 0.5)]), p)
        yield None if delays is None else delays.tolist()


def on_trips(p: PilotParams, landed: int = 10**9) -> Trace:
    """In a room with a map of two of its walls, from which the sonars saw far, after a long time."""
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
    map_.landed = landed
    world = room(side=8.0, start=(7.0, 7.0, 0.0))
    for new_m in (5.0, 20.0, 50.0):
        run = a_run(p, world, map_)
        run.tick()
        ground = run.pilot._seeker.ground
        ground.now_s, ground.new_m = 1000.0, new_m
        ground._made_s[:] = 985.0
        ground._made_s[:12], ground._last_s[: ground.count] = 0.0, np.linspace(500.0, 950.0, ground.count)
        ground._seen_m[: ground.count] = np.random.default_rng(2).uniform(0.5, 5.0, (ground.count, 8))
        for _ in range(700):
            run.tick()
            yield run.truth


def on_near_trips(p: PilotParams) -> Trace:
    """The same, where nothing is far."""
    yield from on_trips(replace(p, far_openings=False, loop_share=0.0))


def in_a_large_map(p: PilotParams) -> Trace:
    """The same, where openings are not all that there is to seek, either."""
    yield from on_near_trips(replace(p, small_map_s=p.small_map_s / 10))


def on_an_island(p: PilotParams) -> Trace:
    """The same, where it was carried to the second wall, and another island is smaller than its own."""
    yield from on_trips(replace(p, far_openings=False, loop_share=0.0), landed=20)


def along_a_corridor(p: PilotParams) -> Trace:
    """Of which the robot knows the first metres only, and these are not in its middle."""
    map_ = HandMadeMap(*chain((0.5, 1.2), (3.0, 1.2)))
    run = a_run(p, room((0.0, 3.0, 20.0, 3.0), side=20.0, start=(3.0, 1.2, 0.0)), map_)
    run.tick()
    run.pilot._seeker.ground._seen_m[:] = 1.0
    for _ in range(300):
        if math.dist(run.truth, map_.poses[-1, :2]) > 0.25:
            map_.make(*run.truth, run.simulator.truth.heading_rad)
        run.tick()
        yield run.truth


def at_a_loop(p: PilotParams) -> Trace:
    """Again and again at the same place, before ground that is far by the links."""
    map_, closer = almost_round(), LoopCloser(ANGLES)
    times = map_.temporal_map.times_to(map_.active)
    for now_s in (1000.0, 1100.0, 1500.0):
        yield closer.choose(map_, FAR, times, now_s, p), closer.road  # type: ignore[arg-type]
        closer.stop()


def getting_nowhere(p: PilotParams) -> Trace:
    """Bumped and still, then turning slower than asked for, then spinning, then creeping: over and over."""
    pilot, map_ = Pilot(p, ANGLES, np.random.default_rng(3)), HandMadeMap([(0.0, 0.0)], [])
    asked = (0.0, 0.0)
    for k in range(2400):
        slowly = Odometry(0.0, (0.3 if k < 1200 else 0.1) * asked[1], DT)
        odometry = (STILL, slowly, Odometry(0.0, 0.9, DT), Odometry(0.05, 0.0, DT))[k // 150 % 4]
        asked = pilot.step(FAR, k % 600 < 60, odometry, map_)  # type: ignore[arg-type]
        yield asked


# Another value of each parameter, at the situation in which it decides soonest.
OTHER: dict[Callable[[PilotParams], Trace], dict[str, float]] = {
    arcs: {
        "cruise_speed": 0.2, "turn_rate": 0.5, "clearance": 0.35, "echo_s": 0.1, "echo_range_m": 0.8, "arc_s": 0.6,
        "arc_steps": 2, "arcs_a_side": 3, "medium_share": 0.8, "slow_share": 0.1, "spot_share": 1.0, "spot_s": 0.2,
        "turn_cost": 0.0, "bearing_m": 1.0, "narrow_m": 0.4, "narrow_cost": 1.0, "escape_m2": 0.01,
    },
    exploring: {
        "wall_distance": 0.9, "follow_ahead_m": 0.3, "follow_aside_m": 0.1, "blocked_ahead_m": 0.6,
        "blocked_turn_ahead_m": 1.0, "blocked_turn_aside_m": 0.1, "corner_share": 1.2, "corner_ahead_m": 1.5,
        "corner_aside_m": 1.5, "turned_to_rad": 0.8, "turn_patience_s": 1.0, "look_back_after_m": 3.0,
        "look_turn_rad": 2.0, "look_back_m": 0.3, "look_back_s": 0.5, "look_stop_m": 1.5, "look_return_rad": 2.0,
        "cross_after_s": 12.0, "cross_spread": 0.9, "cross_least_s": 0.0, "cross_most_s": 7.0, "cross_ahead_m": 0.2,
        "cross_stop_m": 1.0,
    },
    past_a_shut_door: {"nearer_m": 0.5, "stay_s": 0.0, "window_m": 0.3},
    at_a_wall: {
        "good_enough_m": 3.0, "credited_plans": 1.0, "headway_m": 0.02, "headway_rad": 0.05, "trial_s": 1.0,
        "place_m": 0.2, "gap_m": 0.0, "gap_rad": 0.3, "gap_steps": 2, "gap_cost": 3.0, "no_headway_s": 8.0,
        "look_around_s": 3.0,
    },
    standing: {
        "lookahead_m": 1.5, "arrival_m": 0.6, "approach_m": 3.0, "close_by_m": 1.2, "close_by_s": 1.0, "coast_s": 2.0,
        "replan_s": 3.0, "lost_s": 5.0, "near_cost": 0.0,
    },
    side_by_side: {
        "near_m": 0.0, "near_speed": 0.05, "near_turn_cost": 10.0, "near_growth": 0.5, "near_most_m": 0.6,
        "near_blind_m": 3.0, "near_doubt_s": 0.0,
    },
    failing_again: {
        "bar_ahead_m": 2.0, "bar_m": 0.1, "widest_bar_m": 0.6, "bar_fade_s": 5.0, "longest_bar_s": 60.0,
        "bar_delay_s": 1.0,
    },
    getting_nowhere: {
        "stuck_s": 3.0, "bumped_s": 2.0, "somewhere_m": 0.2, "turned_rad": 0.5, "most_turns": 0, "grip_yaw_rate": 1.0,
        "least_grip": 0.8, "grip_s": 0.5, "back_off_s": 2.0, "back_off_speed": 0.1, "free_turn_s": 0.5,
        "free_turn_share": 1.0,
    },
    on_trips: {
        "seek_after_s": 20.0, "trip_most_s": 10.0, "return_after_m": 10.0, "place_reach_m": 6.0, "far_openings": False,
        "home_share": 0.0, "far_fine": 1,
    },
    on_near_trips: {
        "opening_again_s": 5.0, "old_after_s": 5.0, "opening_m": 4.9, "opening_most_m": 1.2, "opening_beams": 30,
        "thin_m": 0.4, "return_sigma_m": 0.3,
    },
    in_a_large_map: {"openings_every": 1, "small_map_s": 1000000.0, "long_ago_s": 900.0},
    on_an_island: {
        "seek": False, "into_reach_m": 1.0, "search": False, "search_share": 1.0, "search_beams": 30,
        "search_home": 50.0,
    },
    along_a_corridor: {
        "opening_gap_m": 1.2, "into_s": 2.0, "into_free_m": 3.0, "far_look_back_m": 2.0, "middle_m": 0.0,
        "middle_ahead_m": 0.5,
    },
    at_a_loop: {
        "far_m": 4.0, "loop_m": 200.0, "loop_share": 0.0, "loop_most_m": 20.0, "loop_drive_m": 5.0,
        "loop_again_s": 10.0,
    },
}  # fmt: skip


def usual(**changes: float) -> PilotParams:
    return PilotParams(**({"look_back_after_m": 4.0, "cross_after_s": 6.0, "seek_after_s": 8.0, **OUTWARD} | changes))


@cache
def usually(situation: Callable[[PilotParams], Trace]) -> list[object]:
    return list(situation(usual()))


def differs(situation: Callable[[PilotParams], Trace], p: PilotParams) -> bool:
    return any(one != other for one, other in zip(usually(situation), situation(p), strict=True))


@pytest.mark.slow
def test_a_parameter_acts(subtests: pytest.Subtests) -> None:
    named = {name for others in OTHER.values() for name in others}
    assert {item.name for item in fields(PilotParams)} == {*named, "goal_reach_m", "goal_place_m"}  # test_session.py
    for situation, others in OTHER.items():
        for name, value in others.items():
            with subtests.test(name):
                assert differs(situation, usual(**{name: value}))
    assert not any(differs(situation, usual()) for situation in (arcs, standing, getting_nowhere))
