"""The robot's body: it rolls, slips and slides as physics would have it, and meets all that stands in its way."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pymunk
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from disk import copy_state
from sim2d import Drive, Simulator, load_world
from sim2d.actors.actors import Actors
from sim2d.geometry.segments import nearest_segment
from sim2d.params import SimParams
from sim2d.robot import Robot, Surroundings

DRIVES = st.lists(st.tuples(st.floats(-0.6, 0.6), st.floats(-2.0, 2.0)), min_size=1, max_size=30)
STEP_S = 4.0 / SimParams().physics_rate_hz  # between two commands of the motors
RADIUS_M = SimParams().robot_radius_m
REACH_M = 2.5  # half a metre of robot, and two metres a second for a second: the most that parameters allow


def driven(robot: Robot, drive: tuple[float, float], params: SimParams, ticks: int) -> Robot:
    for _ in range(ticks):
        robot.drive(*drive, params, 1.0)
    return robot


@settings(max_examples=30)
@given(DRIVES, st.floats(0.3, 1.0))
def test_on_free_floor_it_goes_where_physics_would_take_it(drives: list[tuple[float, float]], slowness: float) -> None:
    """pymunk is one sub-step behind the wheels and turns the robot as it goes: a few millimetres over three seconds."""
    params, poses = SimParams(), []
    for is_free in (False, True):
        robot = Robot((1.0, 2.0, 0.5))
        for speed, yaw_rate in drives:
            robot.drive(speed, yaw_rate, params, slowness, None if is_free else pymunk.Space())
        poses.append((*robot.pose, robot.speed, robot.yaw_rate))
    (x, y, heading, *wheels), (free_x, free_y, free_heading, *free_wheels) = poses
    assert free_wheels == wheels
    behind_s = 1.0 / params.physics_rate_hz
    assert free_heading == pytest.approx(heading, abs=behind_s * params.max_yaw_rate + 1e-6)
    slack = behind_s * (params.max_speed + params.max_speed * params.max_yaw_rate * 0.1 * len(drives))
    assert math.hypot(free_x - x, free_y - y) < slack


def test_what_follows_a_free_tick_goes_on_at_its_speed() -> None:
    params = SimParams()
    robot = driven(Robot((0.0, 0.0, 0.3)), (0.4, 0.0), params, 20)
    before = robot.pose[:2]
    robot.drive(0.4, 0.0, params, 1.0, pymunk.Space())
    assert math.dist(before, robot.pose[:2]) == pytest.approx(0.04, rel=1e-6)


def test_it_cannot_come_farther_than_it_says_even_if_it_slides_on() -> None:
    """What it can meet depends on it: its wheels may be slow again, and its reach must not be."""
    params, robot = SimParams(), Robot((0.0, 0.0, 0.0))
    for _ in range(30):
        before, reach = robot.pose[:2], robot.reach(params)
        robot.drive(9.0, 0.0, params, 1.0)
        assert math.dist(before, robot.pose[:2]) <= reach - params.robot_radius_m + 1e-9
    slippery = SimParams(grip_n=1.0, max_speed=2.0)
    robot, slow = driven(Robot((0.0, 0.0, 0.0)), (2.0, 0.0), slippery, 60), replace(slippery, max_speed=0.05)
    driven(robot, (0.0, 0.0), slow, 20)
    assert abs(robot.speed) < 1e-9
    before, reach = robot.pose[:2], robot.reach(slow)
    driven(robot, (0.0, 0.0), slow, 1)
    assert 0.04 < math.dist(before, robot.pose[:2]) <= reach - RADIUS_M + 1e-9


def test_wheels_that_slip_push_with_all_their_grip() -> None:
    """Newton: at F / m it reaches F t / m and comes F t^2 / 2 m far, and is as slow to stop."""
    for mass, grip in ((8.0, 1.0), (8.0, 4.0), (2.0, 1.0), (100.0, 40.0)):
        params, pull = SimParams(mass_kg=mass, grip_n=grip), grip / mass
        robot = driven(Robot((0.0, 0.0, 0.7)), (0.5, 0.0), params, 8)
        assert robot.speed == 0.5  # that of the wheels
        assert math.hypot(*robot.velocity) == pytest.approx(0.8 * pull)
        assert math.hypot(*robot.pose[:2]) == pytest.approx(0.5 * pull * 0.8**2, abs=STEP_S * pull)
        assert math.atan2(robot.pose[1], robot.pose[0]) == pytest.approx(0.7)
        before = robot.pose[:2]
        driven(robot, (0.0, 0.0), params, 40)
        assert robot.velocity == pytest.approx((0.0, 0.0), abs=1e-9)
        assert math.dist(before, robot.pose[:2]) > 0.5 * pull * 0.8**2


def test_wheels_that_slip_in_a_turn_turn_with_all_their_grip() -> None:
    """A disc's moment of inertia is m r^2 / 2."""
    for mass, grip in ((8.0, 0.1), (20.0, 0.1), (100.0, 2.0)):
        robot = driven(Robot((1.0, 2.0, 0.0)), (0.0, 1.5), SimParams(mass_kg=mass, turn_grip_nm=grip), 5)
        assert (robot.yaw_rate, robot.pose[:2]) == (1.5, (1.0, 2.0))
        assert robot.spin == pytest.approx(0.5 * grip / (0.5 * mass * RADIUS_M**2))


def test_wheels_that_slip_in_a_curve_leave_it_on_the_outside() -> None:
    """8 kg at 1 m/s and pi / 2 a second: the curve takes 12.6 N."""
    for grip, aside in ((80.0, False), (13.0, False), (12.0, True)):
        params = SimParams(grip_n=grip, max_speed=1.0)
        robot = driven(Robot((0.0, 0.0, 0.0)), (1.0, 0.0), params, 15)
        robot = driven(robot, (1.0, math.pi / 2), params, 10)
        forward, left = math.cos(robot.pose[2]), math.sin(robot.pose[2])
        slides = robot.velocity[0] * left - robot.velocity[1] * forward  # to its right
        assert (slides > 0.02) == aside


def before_a_wall(friction: float) -> pymunk.Space:
    """A wall along x = 0."""
    space = pymunk.Space()
    space.collision_slop = 0.001
    wall = pymunk.Segment(space.static_body, (0.0, -9.0), (0.0, 9.0), 0.0)
    wall.friction = friction
    space.add(wall)
    return space


def test_along_a_wall_friction_holds_it_back_as_coulomb_says(subtests: pytest.Subtests) -> None:
    """The wheels pull at an angle to the wall's normal. The product of both frictions is Coulomb's coefficient."""
    for friction, degrees in product((0.0, 0.3, 0.7, 1.0), (15, 30, 45, 60)):
        with subtests.test(f"{friction}, {degrees} degrees"):
            params, angle = SimParams(friction=friction), math.radians(degrees)
            robot = Robot((-RADIUS_M, 0.0, angle))
            for _ in range(20):
                before = robot.pose[1]
                robot.drive(0.3, 0.0, params, 1.0, before_a_wall(friction))
            slides = 0.3 * (math.sin(angle) - friction * friction * math.cos(angle))
            assert (robot.pose[1] - before) / params.tick_s == pytest.approx(max(slides, 0.0), abs=0.002)
            assert robot.pose[0] == pytest.approx(-RADIUS_M, abs=0.002)


@pytest.mark.slow
def test_no_mass_grip_or_friction_takes_it_into_a_wall(subtests: pytest.Subtests) -> None:
    for row in product((1.0, 100.0), (1.0, 1000.0), (0.1, 200.0), (0.0, 1.0)):
        params = SimParams(**dict(zip(("mass_kg", "grip_n", "turn_grip_nm", "friction"), row, strict=True)))
        for speed, angle in ((0.5, 0.0), (0.5, 1.2), (0.03, 0.8)):
            with subtests.test(f"{row}, {speed} m/s"):
                robot = Robot((-0.3, 0.0, angle))
                for _ in range(60):
                    robot.drive(speed, 0.1, params, 1.0, before_a_wall(params.friction))
                    assert robot.pose[0] < 0.005 - RADIUS_M


def test_it_meets_every_wall_door_and_person_within_its_reach(subtests: pytest.Subtests) -> None:
    """The space of a tick holds whatever the robot can touch in it, wherever it is."""
    for name in ("office", "living", "suburb"):
        with subtests.test(name):
            world, rng = load_world(name), np.random.default_rng(0)
            actors = Actors(world, np.random.default_rng(0), 0.1)
            surroundings, (x0, y0, x1, y1) = Surroundings(world, actors), world.bounds
            solid = [*world.segments()[list(world.obstacles)], *actors.segments[: actors.first_box]]
            for _ in range(200):
                place = rng.uniform((x0, y0), (x1, y1))
                space = surroundings.space(*place.tolist(), REACH_M, 0.3)
                segments = [shape for shape in space.shapes if isinstance(shape, pymunk.Segment)]
                standing = {(*shape.a, *shape.b) for shape in segments}
                assert len(standing) == len(segments) < 150  # of the suburb's 828
                near = [tuple(wall) for wall in solid if nearest_segment(wall[None], *place)[1] <= REACH_M]
                assert set(near) <= standing
                discs = {shape.offset for shape in space.shapes if isinstance(shape, pymunk.Circle)}
                for x, y, radius in actors.walkers.discs():
                    assert (x, y) in discs or math.dist((x, y), place) > REACH_M + radius


def test_boxes_stand_in_its_way_only_while_they_are_there() -> None:
    world = load_world("living")
    actors = Actors(world, np.random.default_rng(0), 0.1)
    surroundings = Surroundings(world, actors)

    def boxes() -> int:
        return sum(isinstance(shape, pymunk.Poly) for shape in surroundings.space(7.0, 3.3, 1.0, 0.3).shapes)

    assert boxes() == sum(box.present for box in world.boxes)
    actors.box_present[:] = False
    assert boxes() == 0


@pytest.mark.slow
def test_pressed_into_a_corner_a_copy_goes_on_bit_for_bit() -> None:
    """Two contacts at once, where a solver that remembers earlier ticks would differ from one that does not."""
    world = load_world("office")
    for turn in (0.0, 0.7, -1.2):
        simulator = Simulator(world, seed=4)
        simulator.teleport(0.4, 0.4, math.radians(225) + turn)
        touched, all_of_them = 0, [simulator]
        for tick in range(30):
            if tick % 3 == 0:
                copy = copy_state(simulator)
                copy.settle(world)
                all_of_them.append(copy)
            drive = Drive(0.5, 0.3 if tick < 20 else -0.2)
            frames = [each.step(drive) for each in all_of_them]
            touched += frames[0].bumped
            assert len({each.digest() for each in all_of_them}) == 1
        assert touched > 20
