"""What lives in an office goes on when its world or its script is edited, and can be switched off."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sim2d import Box, Daylight, Event, Lamp, OfficeParams, Person, Simulator, SlowZone, Wall

from .living_room import DOOR, EXACT, FORWARD, STAY, living, run
from .rooms import GREY, room


def test_a_wall_onto_the_robot_is_refused() -> None:
    simulator = Simulator(room(), EXACT)
    before = simulator.digest()
    with pytest.raises(ValueError, match=r"walls\[4\] \(wall\) would cover the robot at \(2.00, 2.00\)"):
        simulator.set_world(room(Wall(2.1, 0.0, 2.1, 4.0, "wall", 2.6, GREY)))
    with pytest.raises(ValueError, match=r"the robot at \(2.00, 2.00\) would be outside"):
        simulator.set_world(room(side=1.0))
    assert simulator.digest() == before


def test_an_edited_world_goes_on_where_it_was() -> None:
    people = (Person("Ada", ((0.5, 0.5), (0.5, 3.5)), (0.0, 0.0), speed=1.0),)
    simulator = Simulator(living(doors=(DOOR,), people=people), EXACT)
    simulator.set_door("lab", True)
    run(simulator, STAY, 20)
    where = simulator.actors.walkers.xy[0].tolist()
    edited = replace(simulator.world, walls=simulator.world.walls[:4], lamps=(Lamp("l", 1, 1, 3, 0.5),))
    simulator.set_world(edited)
    assert simulator.actors.opening[0] == 1.0
    assert simulator.actors.walkers.xy[0].tolist() == where
    assert run(simulator, STAY, 1).tick == 21
    simulator.reset(0)
    assert simulator.world == living(doors=(DOOR,), people=people)
    assert simulator.actors.opening[0] == 0.0


def test_an_edited_script_goes_on_from_now() -> None:
    """Past lines are not carried out late, a line of this very moment counts as past, and what was done stays done."""
    shut, dark = Event(1.0, "close_door", "lab"), Event(1.0, "daylight", level=0.3)
    door, day = replace(DOOR, open=True), Daylight((0.0,), (0.8,))
    world = living(doors=(door,), script=(shut, dark), daylight=day)
    simulator = Simulator(world, EXACT)
    run(simulator, STAY, 20)
    assert (simulator.actors.door_wanted[0], simulator.actors.daylight) == (False, 0.3)
    opens = [Event(at, "open_door", "lab") for at in (0.5, 2.0, 2.5)]
    simulator.set_world(replace(world, script=(opens[2], opens[1], opens[0], dark)))
    run(simulator, STAY, 4)
    assert (simulator.actors.door_wanted[0], simulator.actors.daylight) == (False, 0.3)
    run(simulator, STAY, 1)  # 2.5 s
    assert simulator.actors.door_wanted[0]
    simulator.set_world(replace(world, script=(shut,)))  # no line sets the daylight any more
    run(simulator, STAY, 1)
    assert simulator.actors.door_wanted[0]
    assert simulator.actors.daylight == 0.8
    simulator.set_world(replace(world, script=(), daylight=None))
    run(simulator, STAY, 1)
    assert simulator.actors.daylight == 1.0


def test_a_script_that_is_edited_before_the_first_tick_loses_no_line() -> None:
    simulator = Simulator(living(doors=(replace(DOOR, open=True),)), EXACT)
    simulator.set_world(replace(simulator.world, script=(Event(0.0, "close_door", "lab"),)))
    run(simulator, STAY, 1)
    assert not simulator.actors.door_wanted[0]


def test_a_slow_floor_slows_robot_and_encoders_alike() -> None:
    zone = SlowZone("carpet", ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)), 0.4)
    simulator = Simulator(replace(room(side=20.0), slow_zones=(zone,)), EXACT)
    simulator.teleport(1.0, 1.0, 0.0)
    frame = run(simulator, FORWARD, 20)
    assert frame.odometry_speed == simulator.truth.speed == pytest.approx(0.2, abs=1e-3)
    frame = run(simulator, FORWARD, 150)
    assert simulator.truth.speed == pytest.approx(0.5, abs=1e-3)  # it has left the carpet
    off = Simulator(simulator.world, EXACT, office=OfficeParams(slow_zones=False))
    off.teleport(1.0, 1.0, 0.0)
    assert run(off, FORWARD, 20).odometry_speed == pytest.approx(0.5, abs=1e-3)


def test_what_is_switched_off_is_away_from_the_first_moment_on() -> None:
    things: dict[str, Any] = {
        "boxes": (Box("crate", 2.6, 2.0, 0.4, 0.4),),
        "people": (Person("Ada", ((2.7, 2.6), (0.6, 2.6)), (0.0, 0.0)),),
        "lamps": (Lamp("sun", 2.0, 2.0, 3.0, 0.5),),
    }
    off = OfficeParams(people=False, boxes=False, lamps=False)
    simulator, bare = Simulator(living(**things), EXACT, 3, off), Simulator(living(), EXACT, 3)
    assert np.array_equal(simulator.observe().image, bare.observe().image)
    assert np.array_equal(simulator.observe().laser_m, bare.observe().laser_m)
    assert np.array_equal(run(simulator, STAY, 5).image, run(bare, STAY, 5).image)
    simulator.office = OfficeParams()
    frame = run(simulator, STAY, 1)
    assert frame.laser_m[90] == pytest.approx(0.4)
    assert simulator.actors.walkers.present.all()
