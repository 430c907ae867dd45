"""Doors, people, boxes, lamps, slow floors and scripts in the simulator."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sim2d import (
    Box,
    Daylight,
    Door,
    Drive,
    Event,
    Lamp,
    OfficeParams,
    Person,
    SimParams,
    Simulator,
    SlowZone,
    Start,
    Wall,
    World,
)
from sim2d.world.world_check import Fault, check_world

from .rooms import GREY, room

EXACT = SimParams(
    odometry_noise=0.0, odometry_scale_error=0.0, gyro_bias=0.0, image_noise=0.0, sonar_noise_m=0.0, laser_noise_m=0.0,
    laser_beams=181,
)  # fmt: skip
FORWARD, STAY = Drive(0.5, 0.0), Drive(0.0, 0.0)
DIVIDED = (Wall(3.0, 0.0, 3.0, 1.5, "wall", 2.6, GREY), Wall(3.0, 2.5, 3.0, 4.0, "wall", 2.6, GREY))
DOOR = Door("lab", 3.0, 1.5, math.pi / 2, 1.0, swing_rad=-math.pi / 2, open=False)


def living(**things: Any) -> World:
    """The 4 m room, divided at x = 3 except for a gap of 1 m. The robot stands before the gap and faces it."""
    return replace(room(*DIVIDED), **things)


def run(simulator: Simulator, drive: Drive, ticks: int) -> Any:
    return [simulator.step(drive) for _ in range(ticks)][-1]


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


def test_a_person_walks_its_path_and_stops_for_the_robot() -> None:
    path = ((0.5, 0.5), (0.5, 3.5))
    world = replace(room(), people=(Person("Ada", path, (0.0, 0.0), speed=1.0),))
    simulator = Simulator(world, EXACT)
    ys = []
    for _ in range(100):
        simulator.step(STAY)
        x, y = simulator.actors.walkers.xy[0]
        assert x == 0.5
        ys.append(y)
    assert min(ys) == 0.5
    assert max(ys) == 3.5
    assert np.abs(np.diff(ys)).max() == pytest.approx(0.1)
    simulator.teleport(0.5, 2.0, 0.0)
    for _ in range(150):  # it comes, waits, and turns back
        simulator.step(STAY)
        assert math.dist(simulator.actors.walkers.xy[0], (0.5, 2.0)) >= 0.44
    assert (simulator.truth.x, simulator.truth.y) == pytest.approx((0.5, 2.0), abs=1e-9)


def test_a_person_is_solid_and_sensed() -> None:
    person = Person("Ada", ((3.0, 2.0),), (1.0,))
    simulator = Simulator(replace(room(), people=(person,)), EXACT)
    empty = Simulator(room(), EXACT).observe()
    frame = simulator.observe()
    assert 0.78 <= frame.laser_m[90] <= 0.8
    assert 0.77 <= frame.ranges_m[3] <= 0.82
    assert np.abs(frame.image.astype(int) - empty.image).mean() > 3
    frame = run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(3.0 - 0.44, abs=0.01)
    assert frame.bumped
    nobody = Simulator(replace(room(), people=(person,)), EXACT, office=OfficeParams(people=False))
    assert run(nobody, STAY, 2).laser_m[90] == pytest.approx(2.0)


def test_a_person_stops_at_a_shut_door_and_turns_back() -> None:
    person = Person("Ada", ((2.0, 2.0), (3.6, 2.0)), (0.0, 0.0), speed=1.0)
    simulator = Simulator(living(doors=(DOOR,), people=(person,)), EXACT)
    simulator.teleport(0.5, 0.5, 0.0)
    xs = []
    for _ in range(200):
        simulator.step(STAY)
        xs.append(simulator.actors.walkers.xy[0, 0])
    assert 2.65 < max(xs) <= 3.0 - 0.22 + 1e-9
    turned = np.diff(np.sign(np.diff(xs)))
    assert (turned < 0).any()
    simulator.set_door("lab", True)
    xs = [float(simulator.actors.walkers.xy[0, 0]) for _ in range(200) if simulator.step(STAY)]
    assert max(xs) == pytest.approx(3.6)


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


def test_the_robot_does_not_start_in_a_shut_door() -> None:
    door = Door("lab", 1.5, 2.0, 0.0, 1.0, open=False)
    for world in (living(doors=(door,)), living(boxes=(Box("b", 2.0, 2.3, 0.4, 0.4),))):
        with pytest.raises(ValueError, match=r"the robot cannot start at home: .*; the robot needs 0\.22 m"):
            Simulator(world, EXACT)
        with pytest.raises(Fault, match=r"\(home\): .* the robot needs 0\.22 m"):
            check_world(world, 0.22)
    assert Simulator(living(doors=(replace(door, open=True),)), EXACT).truth.x == 2.0


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


def brightness(simulator: Simulator) -> float:
    return float(run(simulator, STAY, 1).image.mean())


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


def test_lamps_and_daylight_change_what_the_camera_sees() -> None:
    lamp = Lamp("ceiling", 3.0, 2.0, 3.0, 0.8, on=False)
    dark = replace(room(), daylight=Daylight((0.0, 10.0), (0.3, 1.0)), lamps=(lamp,))
    simulator = Simulator(dark, EXACT)
    first = brightness(simulator)
    assert first == pytest.approx(0.3 * brightness(Simulator(room(), EXACT)), rel=0.05)
    simulator.set_lamp("ceiling", True)
    lit = brightness(simulator)
    assert lit > 1.5 * first
    simulator.set_lamp("ceiling", False)
    run(simulator, STAY, 50)
    assert brightness(simulator) > 1.8 * first  # the sun has risen
    night = Simulator(dark, EXACT, office=OfficeParams(daylight=False))
    run(night, STAY, 50)
    assert brightness(night) == pytest.approx(first, rel=0.05)
    scripted = Simulator(
        replace(dark, script=(Event(0.5, "daylight", level=2.0), Event(1.0, "lamp_on", "ceiling"))), EXACT
    )
    run(scripted, STAY, 6)
    assert brightness(scripted) > 4 * first


def test_no_lamp_shines_through_a_wall() -> None:
    wall = Wall(3.0, 0.0, 3.0, 4.0, "wall", 2.6, GREY)
    lamp = Lamp("behind", 3.5, 2.0, 3.0, 0.9)
    dark = Daylight((0.0,), (0.2,))
    with_lamp = Simulator(replace(room(wall), daylight=dark, lamps=(lamp,)), EXACT).observe().image
    without = Simulator(replace(room(wall), daylight=dark), EXACT).observe().image
    assert np.array_equal(with_lamp, without)


def test_glass_mirrors_and_lets_see_through() -> None:
    def image(pane: tuple[Wall, ...], behind: Wall, on: bool = True) -> np.ndarray:
        world = room(*pane, behind, Wall(0.5, 1.0, 0.5, 3.0, "wall", 2.6, (250, 40, 40)))
        return Simulator(world, EXACT, office=OfficeParams(reflections=on)).observe().image[20, 32].astype(float)

    blue, green = (Wall(3.8, 1.0, 3.8, 3.0, "wall", 2.6, c) for c in ((40, 40, 250), (40, 250, 40)))
    pane = Wall(3.0, 1.0, 3.0, 3.0, "glass", 2.6, (200, 220, 230), reflection=0.3)
    bare, glass, pale = image((), blue), image((pane,), blue), image((pane,), blue, on=False)
    assert glass[2] < bare[2]  # less comes through
    assert glass[0] > bare[0] + 10  # and the red wall behind the robot shows in it
    assert glass[1] < pale[1]
    assert image((pane,), green)[1] > glass[1] + 50
    full = image((replace(pane, reflection=1.0),), blue)
    assert np.array_equal(full, image((replace(pane, reflection=1.0),), green))


def test_laser_passes_glass_and_sonar_and_robot_do_not() -> None:
    simulator = Simulator(room(Wall(3.0, 0.0, 3.0, 4.0, "glass", 2.6, GREY)), EXACT)
    frame = simulator.observe()
    assert frame.laser_m[90] == pytest.approx(2.0)
    assert frame.ranges_m[3] == pytest.approx(1.0, abs=0.02)
    run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(3.0 - 0.22, abs=0.003)


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


def test_false_echoes_are_seeded_and_as_many_as_asked_for() -> None:
    params = replace(EXACT, sonar_false_echo=0.3)

    def echoes() -> np.ndarray:
        simulator = Simulator(room(), params, seed=5)
        return np.array([simulator.step(STAY).ranges_m for _ in range(300)])

    got = echoes()
    assert np.array_equal(got, echoes())
    wrong = np.abs(got - Simulator(room(), EXACT).observe().ranges_m) > 0.02
    assert wrong.mean() == pytest.approx(0.3, abs=0.04)


def test_a_panorama_sees_all_around() -> None:
    posters = tuple(
        Wall(*ends, "wall", 2.0, colour)
        for ends, colour in (
            ((3.0, 1.5, 3.0, 2.5), (250, 0, 0)),
            ((1.5, 3.0, 2.5, 3.0), (0, 250, 0)),
            ((1.0, 1.5, 1.0, 2.5), (0, 0, 250)),
        )
    )
    params = replace(EXACT, camera_fov_rad=2 * math.pi, image_width=128)
    row = Simulator(room(*posters), params).observe().image[24].astype(int)
    assert row[64].argmax() == 0
    assert row[32].argmax() == 1  # a quarter to the left
    assert row[0].argmax() == row[127].argmax() == 2


def test_lens_and_resolution_change_while_it_runs() -> None:
    simulator = Simulator(room(), EXACT)
    wide = replace(EXACT, camera_fov_rad=1.5, image_width=96, image_height=40, camera_height_m=0.8, exposure_gain=0.5)
    simulator.set_params(wide)
    assert np.array_equal(run(simulator, STAY, 1).image, Simulator(room(), wide).observe().image)


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


def test_people_have_a_seed_of_their_own() -> None:
    people = (Person("Ada", ((0.6, 0.6), (0.6, 3.4)), (2.0, 2.0)),)

    def path(seed: int, own: int) -> np.ndarray:
        simulator = Simulator(living(people=people), EXACT, seed, OfficeParams(seed=own))
        run(simulator, STAY, 200)
        return simulator.actors.walkers.xy.copy()

    assert np.array_equal(path(1, 7), path(2, 7))
    assert not np.array_equal(path(1, 7), path(1, 8))
    assert not np.array_equal(path(1, 0), path(2, 0))


def test_same_seed_same_office() -> None:
    people = tuple(Person(f"p{i}", ((0.5, 0.5 + i), (2.5, 0.6 + i)), (1.0, 0.5)) for i in range(3))
    world = living(doors=(replace(DOOR, period_s=7.0, open_s=3.0),), people=people)
    one, two, other = (Simulator(world, seed=s) for s in (4, 4, 5))
    for k in range(200):
        drive = Drive(0.3 if k % 30 < 20 else -0.3, math.sin(k))
        for simulator in (one, two, other):
            simulator.step(drive)
    assert one.digest() == two.digest()
    assert not np.array_equal(one.actors.walkers.xy, other.actors.walkers.xy)
    state = one.digest()
    one.actors.walkers.xy[0, 0] += 1e-9
    assert one.digest() != state


@pytest.mark.slow
def test_never_a_centimetre_into_anybody() -> None:
    """Six minutes of wild driving in a crowd, through a door that keeps opening and shutting."""
    people = tuple(
        Person(
            f"p{i}",
            ((0.6, 0.6 + 0.7 * i), (2.4, 0.6 + 0.7 * ((i * 3) % 5)), (1.5, 3.4)),
            (0.2,) * 3,
            speed=0.5 + 0.3 * i,
        )
        for i in range(5)
    )
    world = living(
        doors=(replace(DOOR, period_s=5.0, open_s=2.5),), people=people, boxes=(Box("b", 3.5, 3.4, 0.4, 0.4),)
    )
    simulator = Simulator(world, EXACT, seed=2)
    rng = np.random.default_rng(3)
    for k in range(3600):
        if k % 12 == 0:
            drive = Drive(rng.choice([-0.5, 0.5]), rng.uniform(-1, 1))
        simulator.step(drive)
        x, y = simulator.truth.x, simulator.truth.y
        assert simulator.free_space.clearance(x, y) > 0.22 - 0.01
        assert simulator.fit.covering(x, y) is None
        away = np.hypot(*(simulator.actors.walkers.xy[simulator.actors.walkers.present] - (x, y)).T)
        assert away.min(initial=9.0) > 0.44 - 0.01


@pytest.mark.parametrize("seconds", [0.1, 2.0, 8.0])
def test_a_door_takes_as_long_as_it_is_said_to(seconds: float) -> None:
    """And not less than its tip may move in a tick: 0.1 m."""
    simulator = Simulator(living(doors=(DOOR,)), EXACT, office=OfficeParams(door_s=seconds))
    simulator.actors.set_door("lab", True)
    ticks = 0
    while simulator.actors.opening[0] < 1.0:
        simulator.step(STAY)
        ticks += 1
    assert ticks == pytest.approx(max(10 * seconds, DOOR.width * math.pi / 2 / 0.1), abs=1)


def test_a_bumper_and_the_rays_of_a_cone_are_as_many_and_as_long_as_they_are_said_to_be() -> None:
    """A robot 0.03 m from a wall; and a thin post between two of five rays, which sixty-one do not miss."""
    near = replace(room(), starts=(Start("home", 0.25, 2.0, math.pi),))
    touches = {reach: Simulator(near, replace(EXACT, bumper_m=reach)).step(STAY).bumped for reach in (0.005, 0.05)}
    assert touches == {0.005: False, 0.05: True}
    post = room(Wall(3.0, 2.05, 3.0, 2.06, "wall", 2.6, GREY))
    post = replace(post, starts=(Start("home", 1.0, 2.0, math.radians(-10)),))
    echoes = [float(Simulator(post, replace(EXACT, sonar_rays=n)).step(STAY).ranges_m[3]) for n in (5, 61)]
    assert echoes == pytest.approx([3.0, 2.0], abs=0.03)
