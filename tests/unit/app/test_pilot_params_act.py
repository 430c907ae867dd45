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
from app.pilot.route_following import RouteFollower
from app.pilot.seeking import LoopCloser
from ratslam_core import Odometry, Pose2
from sim2d import Simulator, World

from .pilots import ANGLES, DT, FAR, STILL, Run, follow
from .test_loop_closing import almost_round
from .worlds import EXACT, HandMadeMap, chain, room

Trace = Iterator[object]


def arcs(p: PilotParams) -> Trace:
    """The arcs chosen among many kinds of echoes."""
    rng = np.random.default_rng(1)
    for _ in range(400):
        local = LocalMovement(ANGLES, p.echo_s)
        for _ in range(3):
            ranges = rng.uniform(0.2, 6.0, 8).astype(np.float32)
            local.sense(ranges, Odometry(float(rng.uniform(0, 0.5)), float(rng.uniform(-1, 1)), DT))
        yield local.towards(*rng.uniform(-0.8, 0.8, 2), p), local.free_way(0.0, p)


def a_run(p: PilotParams, world: World, map_: HandMadeMap | None = None, seed: int = 1) -> Run:
    return Run(Simulator(world, EXACT, seed), Pilot(p, ANGLES, np.random.default_rng(seed)), map_)


def exploring(p: PilotParams) -> Trace:
    run = a_run(replace(p, seek=False), room(side=6.0, start=(3.0, 3.0, 0.0)), seed=2)
    for _ in range(1200):
        run.tick()
        yield run.truth


def to_a_goal(run: Run, ticks: int = 900) -> Trace:
    run.pilot.set_goal(8)
    for _ in range(ticks):
        run.tick()
        yield run.truth, run.pilot.goal_state, len(run.map.trials)


def at_a_wall(p: PilotParams) -> Trace:
    """A route that leads into a wall."""
    world = room((2.0, 0.0, 2.0, 3.0), start=(1.0, 0.6, 0.0))
    return to_a_goal(a_run(p, world, HandMadeMap(*chain((1.0, 0.6), (3.0, 0.6)))))


def standing(p: PilotParams) -> Trace:
    """Near the goal."""
    map_ = HandMadeMap(*chain((0.0, 0.0), (6.0, 0.0)))
    for away in (0.5, 1.1):
        follower = RouteFollower(len(map_) - 1)
        map_.robot = Pose2(6.0 - away, 0.1, 0.3)
        for _ in range(80):
            yield follow(follower, map_, p), follower.state


def failing_again(p: PilotParams) -> Trace:
    """Bars at one place, more than once."""
    bars, links = Bars(), np.array([(0, 1), (2, 3)])
    for _ in range(5):
        bars.add(Pose2(0.0, 0.0, 0.0), 0.0, p)
        for _ in range(300):
            bars.fade(DT)
        delays = bars.delays(links, np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 0.5), (1.0, 0.5)]))
        yield None if delays is None else delays.tolist()


def on_trips(p: PilotParams) -> Trace:
    """In a room with a map of two of its walls, from which the sonars saw far, after a long time."""
    map_ = HandMadeMap(*chain((1.0, 1.0), (1.0, 7.0), (7.0, 7.0)))
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
        yield closer.choose(map_, FAR, times, now_s, p)  # type: ignore[arg-type]


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
    arcs: {"cruise_speed": 0.2, "turn_rate": 0.5, "clearance": 0.35, "echo_s": 0.1},
    exploring: {"wall_distance": 0.9, "look_back_after_m": 3.0, "cross_after_s": 12.0},
    at_a_wall: {"gap_m": 0.0},
    standing: {"arrival_m": 0.6, "approach_m": 3.0},
    failing_again: {"bar_fade_s": 5.0},
    getting_nowhere: {"stuck_s": 3.0},
    on_trips: {"seek": False, "return_sigma_m": 0.3},
    along_a_corridor: {"far_look_back_m": 2.0},
    at_a_loop: {"loop_share": 0.0},
}


def usual(**changes: float) -> PilotParams:
    return PilotParams(**({"look_back_after_m": 4.0, "cross_after_s": 6.0} | changes))


@cache
def usually(situation: Callable[[PilotParams], Trace]) -> list[object]:
    return list(situation(usual()))


def differs(situation: Callable[[PilotParams], Trace], p: PilotParams) -> bool:
    return any(one != other for one, other in zip(usually(situation), situation(p), strict=True))


@pytest.mark.slow
def test_a_parameter_acts(subtests: pytest.Subtests) -> None:
    named = {name for others in OTHER.values() for name in others}
    elsewhere = "goal_place_m", "retrace"  # test_goal_place.py, test_looking_back.py
    assert {item.name for item in fields(PilotParams)} == {*named, *elsewhere}
    for situation, others in OTHER.items():
        for name, value in others.items():
            with subtests.test(name):
                assert differs(situation, usual(**{name: value}))
    assert not any(differs(situation, usual()) for situation in (arcs, standing, getting_nowhere))
