"""Doors, boxes and slow floors: solid while they are there, by hand, by script and by themselves, and never into anybody.

They go on when the world or its script is edited, and can be switched off.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim2d import Box, Daylight, Door, Drive, Event, Lamp, OfficeParams, Person, Simulator, SlowZone
from sim2d.actors.actors import DOOR_TIP_M
from sim2d.world.world_check import Fault, check_world

from .rooms import DOOR, EXACT, FORWARD, STAY, living, room, run, wall

OPEN = replace(DOOR, open=True)
LAMP = Lamp("l", 1, 1, 3, 0.5)
CRATE = Box("crate", 3.0, 2.0, 0.4, 0.6)


def openings(simulator: Simulator, ticks: int) -> list[float]:
    return [float(simulator.actors.opening[0]) for _ in range(ticks) if simulator.step(STAY)]


# ------------------------------------------------------------ doors


def test_a_shut_door_stops_robot_and_rays_and_is_seen() -> None:
    simulator = Simulator(living(doors=(DOOR,)), EXACT)
    frame, open_view = simulator.observe(), Simulator(living(doors=(OPEN,)), EXACT).observe()
    assert (frame.laser_m[90], open_view.laser_m[90]) == pytest.approx((1.0, 2.0))
    assert frame.ranges_m[3] == pytest.approx(1.0 / math.cos(math.radians(2.5)), abs=0.01)
    assert np.abs(frame.image.astype(int) - open_view.image).mean() > 10
    frame = run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(3.0 - 0.22, abs=0.003)
    assert (frame.bumped, frame.odometry_speed) == (True, 0.0)
    simulator.teleport(2.0, 2.0, 0.0)
    simulator.set_door("lab", True)
    run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(4.0 - 0.22, abs=0.003)


def test_a_door_waits_for_the_robot_that_stands_in_it() -> None:
    for slides in (False, True):
        simulator = Simulator(living(doors=(replace(OPEN, slides=slides),)), EXACT)
        simulator.teleport(3.0, 2.0, 0.0)
        simulator.set_door("lab", False)
        for _ in range(50):
            simulator.step(STAY)
            assert simulator.fit.refusal(3.0, 2.0) is None
        assert math.dist((simulator.truth.x, simulator.truth.y), (3.0, 2.0)) < 1e-6  # not pushed
        assert 0 < simulator.actors.opening[0] < 1
        simulator.teleport(2.0, 2.0, 0.0)
        assert openings(simulator, 20)[-1] == 0.0


def test_a_scripted_door_shuts_on_the_same_tick_in_every_run() -> None:
    world = living(doors=(OPEN,), script=(Event(3.0, "close_door", "lab"),))
    runs = []
    for seed, drive in ((0, STAY), (1, Drive(-0.2, 0.3))):
        simulator = Simulator(world, seed=seed)
        runs.append([float(simulator.actors.opening[0]) for _ in range(60) if simulator.step(drive)])
    assert runs[0] == runs[1]
    assert runs[0].index(1.0) == 0
    assert [opening == 1.0 for opening in runs[0]] == [True] * 29 + [False] * 31  # the thirtieth tick ends at 3.0 s
    assert runs[0][-1] == 0.0
    assert openings(Simulator(world, office=OfficeParams(script=False)), 60)[-1] == 1.0


def test_a_door_with_a_period_moves_by_itself_and_obeys_in_between() -> None:
    world = living(doors=(replace(DOOR, period_s=10.0, open_s=4.0),))
    simulator = Simulator(world, EXACT)
    opened = openings(simulator, 200)
    assert [opened[k] for k in (20, 120, 65, 165)] == [1.0, 1.0, 0.0, 0.0]
    simulator.set_door("lab", False)
    assert openings(simulator, 20)[-1] == 0.0  # until its next period
    assert openings(Simulator(world, EXACT, office=OfficeParams(doors=False)), 30)[-1] == 0.0


def test_a_door_takes_as_long_as_it_is_said_to_and_its_tip_is_no_quicker_than_it_may_be(
    subtests: pytest.Subtests,
) -> None:
    for seconds in (0.1, 2.0, 8.0):
        with subtests.test(f"{seconds} s"):
            simulator = Simulator(living(doors=(DOOR,)), EXACT, office=OfficeParams(door_s=seconds))
            simulator.set_door("lab", True)
            ticks, before = 0, DOOR.leaf(0.0)
            while simulator.actors.opening[0] < 1.0:
                simulator.step(STAY)
                ticks += 1
                leaf = simulator.actors.segments[0].copy()
                assert math.dist(leaf[2:], before[2:]) <= DOOR_TIP_M
                before = leaf
            assert ticks == pytest.approx(max(10 * seconds, DOOR.width * math.pi / 2 / DOOR_TIP_M), abs=1)


def test_the_robot_does_not_start_in_a_shut_door_or_a_box() -> None:
    door = Door("lab", 1.5, 2.0, 0.0, 1.0, open=False)
    for world in (living(doors=(door,)), living(boxes=(Box("b", 2.0, 2.3, 0.4, 0.4),))):
        with pytest.raises(ValueError, match=r"the robot cannot start at home: .*; the robot needs 0\.22 m"):
            Simulator(world, EXACT)
        with pytest.raises(Fault, match=r"\(home\): .* the robot needs 0\.22 m"):
            check_world(world, 0.22)
    assert Simulator(living(doors=(replace(door, open=True),)), EXACT).truth.x == 2.0


# ------------------------------------------------------------ boxes


def test_boxes_stop_robot_and_rays_and_can_be_taken_away() -> None:
    simulator = Simulator(room(), EXACT)
    simulator.put_box(CRATE)
    assert run(simulator, STAY, 1).laser_m[90] == pytest.approx(0.8)
    run(simulator, FORWARD, 40)
    assert simulator.truth.x == pytest.approx(2.8 - 0.22, abs=0.01)
    with pytest.raises(ValueError, match=r"there is a box named 'crate' already"):
        simulator.put_box(replace(CRATE, x=1.0))
    with pytest.raises(ValueError, match=r"no box named 'crat'; expected one of: crate"):
        simulator.remove_box("crat")
    simulator.remove_box("crate")
    run(simulator, FORWARD, 40)
    assert simulator.truth.x == pytest.approx(4.0 - 0.22, abs=0.003)


def test_a_box_that_cannot_be_is_refused_and_nothing_changes() -> None:
    simulator = Simulator(room(), EXACT)
    before = simulator.digest()
    for box, reason in (
        (Box("b", 2.2, 2.0, 0.4, 0.4), r"box 'b' would cover the robot at \(2.00, 2.00\); keep 0.2\d m away from it"),
        (Box("b", 2.0, 2.0, 3.0, 3.0), r"box 'b' would cover the robot"),
        (Box("b", 5.0, 2.0, 0.4, 0.4), r"\(5, 2\) is outside of room, which spans 0 to 4 by 0 to 4 m"),
        (Box("b", 3.0, 3.0, 1e9, 0.4), r"the width of a box must be 0.05 to 20 m, got 1e\+09"),
        (Box("b", 3.0, 3.0, 0.4, 0.4, height=math.nan), r"the height of a box must be 0.05 to 20 m, got nan"),
        (Box("b", 3.0, 3.0, 0.4, 0.4, angle_rad=math.inf), r"the angle of a box must be finite, got inf"),
    ):
        with pytest.raises(ValueError, match=reason):
            simulator.put_box(box)
        assert (simulator.digest(), simulator.world.boxes) == (before, ())


def test_a_scripted_box_waits_until_the_robot_has_left() -> None:
    box = Box("crate", 2.0, 2.0, 0.4, 0.4, present=False)
    script = (Event(0.5, "box_appear", "crate"), Event(6.0, "box_vanish", "crate"))
    simulator = Simulator(room(boxes=(box,), script=script), EXACT)
    run(simulator, STAY, 10)
    assert not simulator.actors.box_present[0]
    run(simulator, FORWARD, 20)
    assert simulator.actors.box_present[0]
    simulator.teleport(2.5, 2.0, 0.0)
    with pytest.raises(ValueError, match=r"\(2.3, 2\) is 0.100 m from box 'crate'; the robot needs 0.22 m"):
        simulator.teleport(2.3, 2.0, 0.0)
    run(simulator, STAY, 35)
    assert not simulator.actors.box_present[0]
    simulator.remove_box("crate")
    assert simulator.world.script == ()


def test_a_kidnap_by_chance_finds_what_room_boxes_and_people_leave() -> None:
    boxes = (Box("left", 0.8, 2.0, 1.5, 3.9), Box("low", 2.8, 0.8, 2.4, 1.5))
    people = (Person("Ada", ((3.4, 3.4), (1.9, 3.4)), (9.0, 9.0)),)
    simulator = Simulator(room(boxes=boxes, people=people), EXACT, 1)
    poses = np.array([simulator.random_free_pose() for _ in range(200)])
    for pose in poses.tolist():
        simulator.teleport(*pose)
    assert poses[:, 0].min() > 1.7
    assert poses[:, 2].std() > 1.0
    simulator = Simulator(room(boxes=(Box("all", 2.0, 2.0, 3.9, 3.9, present=False),)), EXACT)
    simulator.actors.box_present[0] = True
    with pytest.raises(ValueError, match="leave the robot no room: all 1000 random places tried are taken"):
        simulator.random_free_pose()


# ------------------------------------------------------------ edits and switches


def test_an_edit_asks_what_is_there_now_not_what_was_there_at_first() -> None:
    """A box that has disappeared covers nobody; one that has appeared covers whoever is there."""
    simulator = Simulator(room(boxes=(CRATE,), script=(Event(0.5, "box_vanish", "crate"),)), EXACT)
    run(simulator, STAY, 10)
    simulator.teleport(3.0, 2.0, 0.0)
    simulator.set_world(replace(simulator.world, lamps=(LAMP,)))
    assert simulator.truth.x == 3.0
    simulator = Simulator(room(boxes=(replace(CRATE, present=False),)), EXACT)
    simulator.actors.set_box("crate", True)
    run(simulator, STAY, 1)
    with pytest.raises(ValueError, match="box 'crate' would cover the robot"):
        simulator.set_world(replace(simulator.world, boxes=(replace(CRATE, x=2.1, present=False),)))


def test_a_wall_onto_the_robot_is_refused() -> None:
    simulator = Simulator(room(), EXACT)
    before = simulator.digest()
    with pytest.raises(ValueError, match=r"walls\[4\] \(wall\) would cover the robot at \(2.00, 2.00\)"):
        simulator.set_world(room(wall(2.1, 0.0, 2.1, 4.0)))
    with pytest.raises(ValueError, match=r"the robot at \(2.00, 2.00\) would be outside"):
        simulator.set_world(room(side=1.0))
    assert simulator.digest() == before


def test_an_edited_world_goes_on_where_it_was_and_a_reset_is_that_of_the_first() -> None:
    first = living(doors=(DOOR,), people=(Person("Ada", ((0.5, 0.5), (0.5, 3.5)), (0.0, 0.0), speed=1.0),))
    simulator = Simulator(first, EXACT)
    simulator.set_door("lab", True)
    run(simulator, STAY, 20)
    where = simulator.actors.walkers.xy[0].tolist()
    simulator.set_world(replace(first, walls=first.walls[:4], lamps=(LAMP,)))
    assert (simulator.actors.opening[0], simulator.actors.walkers.xy[0].tolist()) == (1.0, where)
    assert run(simulator, STAY, 1).tick == 21
    simulator.reset(0)
    assert (simulator.world, simulator.actors.opening[0]) == (first, 0.0)


def test_an_edited_script_goes_on_from_now() -> None:
    """Past lines are not carried out late, a line of this very moment counts as past, and what was done stays done."""
    shut, dark = Event(1.0, "close_door", "lab"), Event(1.0, "daylight", level=0.3)
    world = living(doors=(OPEN,), script=(shut, dark), daylight=Daylight((0.0,), (0.8,)))
    simulator = Simulator(world, EXACT)
    late, now, soon = (Event(at, "open_door", "lab") for at in (0.5, 2.0, 2.5))
    run(simulator, STAY, 20)
    assert (simulator.actors.door_wanted[0], simulator.actors.daylight) == (False, 0.3)
    simulator.set_world(replace(world, script=(soon, now, late, dark)))
    run(simulator, STAY, 4)
    assert (simulator.actors.door_wanted[0], simulator.actors.daylight) == (False, 0.3)
    run(simulator, STAY, 1)  # 2.5 s
    assert simulator.actors.door_wanted[0]
    simulator.set_world(replace(world, script=(shut,)))  # no line sets the daylight any more
    run(simulator, STAY, 1)
    assert (simulator.actors.door_wanted[0], simulator.actors.daylight) == (True, 0.8)
    simulator.set_world(replace(world, script=(), daylight=None))
    run(simulator, STAY, 1)
    assert simulator.actors.daylight == 1.0


def test_a_script_that_is_edited_before_the_first_tick_loses_no_line() -> None:
    simulator = Simulator(living(doors=(OPEN,)), EXACT)
    simulator.set_world(replace(simulator.world, script=(Event(0.0, "close_door", "lab"),)))
    run(simulator, STAY, 1)
    assert not simulator.actors.door_wanted[0]


def test_a_slow_floor_slows_robot_and_encoders_alike() -> None:
    carpet = SlowZone("carpet", ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)), 0.4)
    world = room(side=20.0, slow_zones=(carpet,))
    simulator, off = Simulator(world, EXACT), Simulator(world, EXACT, office=OfficeParams(slow_zones=False))
    for each in (simulator, off):
        each.teleport(1.0, 1.0, 0.0)
    assert run(simulator, FORWARD, 20).odometry_speed == simulator.truth.speed == pytest.approx(0.2, abs=1e-3)
    run(simulator, FORWARD, 150)
    assert simulator.truth.speed == pytest.approx(0.5, abs=1e-3)  # it has left the carpet
    assert run(off, FORWARD, 20).odometry_speed == pytest.approx(0.5, abs=1e-3)


def test_what_is_switched_off_is_away_from_the_first_moment_on() -> None:
    world = living(
        boxes=(Box("crate", 2.6, 2.0, 0.4, 0.4),),
        people=(Person("Ada", ((2.7, 2.6), (0.6, 2.6)), (0.0, 0.0)),),
        lamps=(Lamp("sun", 2.0, 2.0, 3.0, 0.5),),
    )
    off = OfficeParams(people=False, boxes=False, lamps=False)
    simulator, bare = Simulator(world, EXACT, 3, off), Simulator(living(), EXACT, 3)
    assert np.array_equal(simulator.observe().image, bare.observe().image)
    assert np.array_equal(simulator.observe().laser_m, bare.observe().laser_m)
    assert np.array_equal(run(simulator, STAY, 5).image, run(bare, STAY, 5).image)
    simulator.office = OfficeParams()
    assert run(simulator, STAY, 1).laser_m[90] == pytest.approx(0.4)
    assert simulator.actors.walkers.present.all()
