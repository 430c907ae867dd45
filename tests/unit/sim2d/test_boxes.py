"""Boxes: solid while they are there, and never put onto the robot."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from sim2d import Box, Event, Lamp, Person, Simulator

from .living_room import EXACT, FORWARD, STAY, run
from .rooms import room


def test_boxes_stop_robot_and_rays_and_can_be_taken_away() -> None:
    simulator = Simulator(room(), EXACT)
    simulator.put_box(Box("crate", 3.0, 2.0, 0.4, 0.6))
    assert run(simulator, STAY, 1).laser_m[90] == pytest.approx(0.8)
    run(simulator, FORWARD, 40)
    assert simulator.truth.x == pytest.approx(2.8 - 0.22, abs=0.01)
    with pytest.raises(ValueError, match=r"there is a box named 'crate' already"):
        simulator.put_box(Box("crate", 1.0, 1.0, 0.4, 0.4))
    with pytest.raises(ValueError, match=r"no box named 'crat'; expected one of: crate"):
        simulator.remove_box("crat")
    simulator.remove_box("crate")
    run(simulator, FORWARD, 40)
    assert simulator.truth.x == pytest.approx(4.0 - 0.22, abs=0.003)


@pytest.mark.parametrize(
    ("box", "reason"),
    [
        (Box("b", 2.2, 2.0, 0.4, 0.4), r"box 'b' would cover the robot at \(2.00, 2.00\); keep 0.2\d m away from it"),
        (Box("b", 2.0, 2.0, 3.0, 3.0), r"box 'b' would cover the robot"),
        (Box("b", 5.0, 2.0, 0.4, 0.4), r"\(5, 2\) is outside of room, which spans 0 to 4 by 0 to 4 m"),
        (Box("b", 3.0, 3.0, 1e9, 0.4), r"the width of a box must be 0.05 to 20 m, got 1e\+09"),
        (Box("b", 3.0, 3.0, 0.4, 0.4, height=math.nan), r"the height of a box must be 0.05 to 20 m, got nan"),
        (Box("b", 3.0, 3.0, 0.4, 0.4, angle_rad=math.inf), r"the angle of a box must be finite, got inf"),
    ],
)
def test_a_box_on_the_robot_is_refused_and_nothing_changes(box: Box, reason: str) -> None:
    simulator = Simulator(room(), EXACT)
    before = simulator.digest()
    with pytest.raises(ValueError, match=reason):
        simulator.put_box(box)
    assert simulator.digest() == before
    assert simulator.world.boxes == ()


def test_a_scripted_box_waits_until_the_robot_has_left() -> None:
    box = Box("crate", 2.0, 2.0, 0.4, 0.4, present=False)
    script = (Event(0.5, "box_appear", "crate"), Event(6.0, "box_vanish", "crate"))
    simulator = Simulator(replace(room(), boxes=(box,), script=script), EXACT)
    run(simulator, STAY, 10)
    assert not simulator.actors.box_present[0]
    run(simulator, FORWARD, 20)
    assert simulator.actors.box_present[0]
    assert simulator.teleport(2.5, 2.0, 0.0) is None
    with pytest.raises(ValueError, match=r"\(2.3, 2\) is 0.100 m from box 'crate'; the robot needs 0.22 m"):
        simulator.teleport(2.3, 2.0, 0.0)
    run(simulator, STAY, 35)
    assert not simulator.actors.box_present[0]


def test_a_kidnap_by_chance_finds_what_room_boxes_and_people_leave() -> None:
    boxes = (Box("left", 0.8, 2.0, 1.5, 3.9), Box("low", 2.8, 0.8, 2.4, 1.5))
    people = (Person("Ada", ((3.4, 3.4), (1.9, 3.4)), (9.0, 9.0)),)
    simulator = Simulator(replace(room(), boxes=boxes, people=people), EXACT, 1)
    places = [simulator.random_free_pose() for _ in range(200)]
    for pose in places:
        simulator.teleport(*pose)
    assert min(x for x, _, _ in places) > 1.7
    full = replace(room(), boxes=(Box("all", 2.0, 2.0, 3.9, 3.9, present=False),))
    simulator = Simulator(full, EXACT)
    simulator.actors.box_present[0] = True
    with pytest.raises(ValueError, match="leave the robot no room: all 1000 random places tried are taken"):
        simulator.random_free_pose()


@pytest.mark.slow
def test_an_edit_asks_what_is_there_now_not_what_was_there_at_first() -> None:
    """A box that has disappeared covers nobody; one that has appeared covers whoever is there."""
    box, script = Box("crate", 3.2, 2.0, 0.4, 0.4), (Event(0.5, "box_vanish", "crate"),)
    simulator = Simulator(replace(room(), boxes=(box,), script=script), EXACT)
    run(simulator, STAY, 10)
    simulator.teleport(3.2, 2.0, 0.0)
    simulator.set_world(replace(simulator.world, lamps=(Lamp("l", 1, 1, 3, 0.5),)))
    assert simulator.truth.x == 3.2
    simulator = Simulator(replace(room(), boxes=(replace(box, present=False),)), EXACT)
    simulator.actors.set_box("crate", True)
    run(simulator, STAY, 1)
    with pytest.raises(ValueError, match="box 'crate' would cover the robot"):
        simulator.set_world(replace(simulator.world, boxes=(replace(box, x=2.1, present=False),)))
