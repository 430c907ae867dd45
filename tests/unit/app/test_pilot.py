"""What the pilot decides: driving by hand, going to a goal, exploring."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from app.pilot import Pilot
from app.pilot.behaviours import Behaviour, words_of
from app.pilot.route_following import LOST_S, REPLAN_S
from ratslam_core import Odometry
from sim2d import Simulator

from .pilots import DT, EXPLORING, FAR, STILL, Run, a_pilot
from .worlds import EXACT, HandMadeMap, chain, room

AHEAD = Odometry(0.3, 0.0, DT)


def step(pilot: Pilot, map_: HandMadeMap, odometry: Odometry = STILL, seconds: float = DT) -> tuple[float, float]:
    """Before far walls."""
    asked = (0.0, 0.0)
    for _ in range(round(seconds / DT)):
        asked = pilot.step(FAR, False, odometry, map_)  # type: ignore[arg-type]
    return asked


def test_driven_by_hand_until_told_otherwise() -> None:
    pilot, map_, near = a_pilot(), HandMadeMap([(0.0, 0.0)], []), np.full(8, 0.25, np.float32)
    pilot.drive(0.2, -0.5)
    assert pilot.mode == "manual"
    for _ in range(100):  # by hand it neither avoids obstacles nor frees itself
        assert pilot.step(near, True, STILL, map_) == (0.2, -0.5)  # type: ignore[arg-type]
        assert pilot.doing == "driven by hand"
    pilot.drive(0.0, 0.0)
    assert (step(pilot, map_), pilot.doing) == ((0.0, 0.0), "waiting for the hand")
    pilot.drive(0.2, 0.0)
    pilot.set_mode("explore")
    step(pilot, map_)
    assert pilot.doing in EXPLORING
    pilot.set_mode("manual")
    assert step(pilot, map_) == (0.0, 0.0)


def test_modes_and_goals() -> None:
    pilot, map_ = a_pilot(), HandMadeMap(*chain((0.0, 0.0), (3.0, 0.0)))
    with pytest.raises(ValueError, match="there is no goal to go to; set one first"):
        pilot.set_mode("goal")
    assert (pilot.mode, pilot.goal, pilot.goal_state, pilot.progress(map_)) == ("explore", None, None, None)  # type: ignore[arg-type]
    pilot.set_goal(12)
    assert (pilot.mode, pilot.goal, pilot.goal_state) == ("goal", 12, (12, "tracking"))
    pilot.drive(0.1, 0.0)
    assert pilot.goal == 12  # driving by hand interrupts; the goal stays
    pilot.set_mode("goal")
    assert pilot.mode == "goal"
    pilot.cancel_goal()
    assert (pilot.mode, pilot.goal) == ("explore", None)
    pilot.drive(0.1, 0.0)
    pilot.cancel_goal()
    assert pilot.mode == "manual"


def test_a_route_is_followed_to_the_goal() -> None:
    """Around a wall with a gap: along the links, not as the crow flies."""
    world = room((2.0, 0.0, 2.0, 2.8), start=(1.0, 0.6, 0.0))
    map_ = HandMadeMap(*chain((1.0, 0.6), (1.0, 3.4), (3.0, 3.4), (3.0, 0.6)))
    run, goal = Run(Simulator(world, EXACT), a_pilot(), map_), len(map_) - 1
    run.pilot.set_goal(goal)
    while run.pilot.goal_state != (goal, "arrived"):
        run.tick()
        assert len(run.track) < 600
    here = run.truth
    assert math.dist(here, (3.0, 0.6)) < 0.35
    assert 6.5 < sum(math.dist(a, b) for a, b in pairwise(run.track)) < 9.0  # the links are 7.6 m long
    assert run.bumps == 0
    run.run(3)
    assert run.pilot.doing == "at the goal"
    assert math.dist(here, run.truth) < 0.05
    progress = run.pilot.progress(map_)  # type: ignore[arg-type]
    assert progress is not None
    assert (progress.state, progress.eta_s, progress.remaining_m, len(progress.route)) == ("arrived", 0.0, 0.0, 0)


@pytest.mark.parametrize("leave", [lambda p: p.set_mode("explore"), lambda p: p.drive(0.1, 0.0)])
def test_a_goal_that_was_reached_is_done_with_when_the_robot_goes_elsewhere(leave: Callable[[Pilot], None]) -> None:
    run = Run(Simulator(room(start=(1.0, 0.6, 0.0)), EXACT), a_pilot(), HandMadeMap(*chain((1.0, 0.6), (1.5, 0.6))))
    goal = len(run.map) - 1
    run.pilot.set_goal(goal)
    leave(run.pilot)
    assert run.pilot.goal == goal  # interrupted
    run.pilot.set_mode("goal")
    while run.pilot.goal_state != (goal, "arrived"):
        run.tick()
    leave(run.pilot)
    assert (run.pilot.goal, run.pilot.goal_state) == (None, None)
    with pytest.raises(ValueError, match="set one first"):
        run.pilot.set_mode("goal")


def test_an_unreachable_goal_is_explored_for_and_reached_when_a_way_is_found() -> None:
    places, links = chain((0.0, 0.0), (3.0, 0.0))
    goal, map_ = len(places) - 1, HandMadeMap(places, [(i, j) for i, j in links if not 2 <= i < 9])  # too wide a gap
    pilot = a_pilot()
    pilot.set_goal(goal)
    for _ in range(round(LOST_S / DT) + 10):
        step(pilot, map_, AHEAD)
        assert pilot.doing in EXPLORING
    assert pilot.goal_state == (goal, "unreachable")
    map_.links, map_.link_times = np.array(links), np.full(len(links), 0.8)
    step(pilot, map_, AHEAD, seconds=2 * REPLAN_S)
    assert (pilot.goal_state, pilot.doing) == ((goal, "tracking"), "following the route")


def test_coasting_is_said() -> None:
    pilot, map_ = a_pilot(), HandMadeMap(*chain((0.0, 0.0), (6.0, 0.0)))
    pilot.set_goal(len(map_) - 1)
    step(pilot, map_)
    assert pilot.doing == "following the route"
    map_.links, map_.link_times = map_.links[:0], map_.link_times[:0]
    step(pilot, map_, AHEAD, seconds=2.5)
    assert pilot.doing == "coasting on the old route"


def test_links_remember_a_behaviour_by_its_number() -> None:
    assert {behaviour.number for behaviour in Behaviour} == set(range(7))
    assert words_of(Behaviour.COASTING.number) == "following the route"
    assert (words_of(0), words_of(6), words_of(9)) == ("standing", "driven by hand", "9")
