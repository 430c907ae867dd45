"""Doors: shut and open, by hand, by script and by themselves, and never into anybody."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim2d import Box, Door, Drive, Event, OfficeParams, Simulator
from sim2d.world.world_check import Fault, check_world

from .living_room import DOOR, EXACT, FORWARD, STAY, living, run


def test_a_shut_door_stops_robot_and_rays_and_is_seen() -> None:
    simulator = Simulator(living(doors=(DOOR,)), EXACT)
    frame = simulator.observe()
    assert frame.laser_m[90] == pytest.approx(1.0)
    assert frame.ranges_m[3] == pytest.approx(1.0 / math.cos(math.radians(2.5)), abs=0.01)
    open_view = Simulator(living(doors=(replace(DOOR, open=True),)), EXACT).observe()
    assert open_view.laser_m[90] == pytest.approx(2.0)
    assert np.abs(frame.image.astype(int) - open_view.image).mean() > 10
    frame = run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(3.0 - 0.22, abs=0.003)
    assert frame.bumped
    assert frame.odometry_speed == 0.0
    simulator.teleport(2.0, 2.0, 0.0)
    simulator.set_door("lab", True)
    run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(4.0 - 0.22, abs=0.003)


@pytest.mark.parametrize("slides", [False, True])
def test_a_door_waits_for_the_robot_that_stands_in_it(slides: bool) -> None:
    simulator = Simulator(living(doors=(replace(DOOR, open=True, slides=slides),)), EXACT)
    simulator.teleport(3.0, 2.0, 0.0)
    simulator.set_door("lab", False)
    for _ in range(50):
        simulator.step(STAY)
        assert simulator.fit.refusal(3.0, 2.0) is None
    assert math.dist((simulator.truth.x, simulator.truth.y), (3.0, 2.0)) < 1e-6  # not pushed
    assert 0 < simulator.actors.opening[0] < 1
    simulator.teleport(2.0, 2.0, 0.0)
    run(simulator, STAY, 20)
    assert simulator.actors.opening[0] == 0.0


def test_a_scripted_door_shuts_on_the_same_tick_in_every_run() -> None:
    world = living(doors=(replace(DOOR, open=True),), script=(Event(3.0, "close_door", "lab"),))
    ticks = []
    for seed, drive in ((0, STAY), (1, Drive(-0.2, 0.3))):
        simulator = Simulator(world, seed=seed)
        history = []
        for _ in range(60):
            simulator.step(drive)
            history.append(simulator.actors.opening[0])
        ticks.append(
            (next(k for k, o in enumerate(history) if o < 1), next(k for k, o in enumerate(history) if o == 0))
        )
    assert ticks[0] == ticks[1]
    assert ticks[0][0] == 29  # the thirtieth tick ends at 3.0 s
    off = Simulator(world, office=OfficeParams(script=False))
    run(off, STAY, 60)
    assert off.actors.opening[0] == 1.0


def test_a_door_with_a_period_moves_by_itself_and_obeys_in_between() -> None:
    door = replace(DOOR, open=False, period_s=10.0, open_s=4.0)
    simulator = Simulator(living(doors=(door,)), EXACT)
    opened = []
    for _ in range(200):
        simulator.step(STAY)
        opened.append(simulator.actors.opening[0])
    assert opened[20] == opened[120] == 1.0
    assert opened[65] == opened[165] == 0.0
    simulator.set_door("lab", False)
    run(simulator, STAY, 20)
    assert simulator.actors.opening[0] == 0.0  # until its next period
    still = Simulator(living(doors=(door,)), EXACT, office=OfficeParams(doors=False))
    run(still, STAY, 30)
    assert still.actors.opening[0] == 0.0


def test_the_robot_does_not_start_in_a_shut_door() -> None:
    door = Door("lab", 1.5, 2.0, 0.0, 1.0, open=False)
    for world in (living(doors=(door,)), living(boxes=(Box("b", 2.0, 2.3, 0.4, 0.4),))):
        with pytest.raises(ValueError, match=r"the robot cannot start at home: .*; the robot needs 0\.22 m"):
            Simulator(world, EXACT)
        with pytest.raises(Fault, match=r"\(home\): .* the robot needs 0\.22 m"):
            check_world(world, 0.22)
    assert Simulator(living(doors=(replace(door, open=True),)), EXACT).truth.x == 2.0


@pytest.mark.parametrize("tip", [0.1, 0.03])
@pytest.mark.parametrize("seconds", [0.1, 2.0, 8.0])
def test_a_door_takes_as_long_as_it_is_said_to(seconds: float, tip: float) -> None:
    """And not less than its tip may move in a tick."""
    simulator = Simulator(living(doors=(DOOR,)), EXACT, office=OfficeParams(door_s=seconds, door_tip_m=tip))
    simulator.actors.set_door("lab", True)
    ticks, farthest, before = 0, 0.0, DOOR.leaf(0.0)
    while simulator.actors.opening[0] < 1.0:
        simulator.step(STAY)
        ticks += 1
        leaf = simulator.actors.segments[0].copy()
        farthest, before = max(farthest, math.dist(leaf[2:], before[2:])), leaf
    assert farthest <= tip
    assert ticks == pytest.approx(max(10 * seconds, DOOR.width * math.pi / 2 / tip), abs=1)


def test_a_door_slows_down_while_it_moves() -> None:
    simulator = Simulator(living(doors=(DOOR,)), EXACT)
    simulator.set_door("lab", True)
    steps = []
    for tip in (0.1, 0.02):
        simulator.office = OfficeParams(door_tip_m=tip)
        before = simulator.actors.opening[0]
        run(simulator, STAY, 4)
        steps.append((simulator.actors.opening[0] - before) * DOOR.width * math.pi / 2 / 4)
    assert steps == pytest.approx([0.1, 0.02])
