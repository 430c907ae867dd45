"""The robot's body without an office: it rolls, slips and slides as physics would have it."""

from __future__ import annotations

import math
from dataclasses import replace

import pymunk
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim2d.params import SimParams
from sim2d.physics.robot import Robot

DRIVES = st.lists(st.tuples(st.floats(-0.6, 0.6), st.floats(-2.0, 2.0)), min_size=1, max_size=30)


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
    params, robot = SimParams(), Robot((0.0, 0.0, 0.3))
    for _ in range(20):
        robot.drive(0.4, 0.0, params, 1.0)
    before = robot.pose[:2]
    robot.drive(0.4, 0.0, params, 1.0, pymunk.Space())
    assert math.dist(before, robot.pose[:2]) == pytest.approx(0.04, rel=1e-6)


def test_it_cannot_come_farther_than_it_says() -> None:
    params, robot = SimParams(), Robot((0.0, 0.0, 0.0))
    for _ in range(30):
        before, reach = robot.pose[:2], robot.reach(params)
        robot.drive(9.0, 0.0, params, 1.0)
        assert math.dist(before, robot.pose[:2]) <= reach - params.robot_radius_m + 1e-9


STEP_S = 4.0 / SimParams().physics_rate_hz  # between two commands of the motors
RADIUS_M = SimParams().robot_radius_m


def driven(robot: Robot, drive: tuple[float, float], params: SimParams, ticks: int) -> Robot:
    for _ in range(ticks):
        robot.drive(*drive, params, 1.0)
    return robot


@pytest.mark.parametrize(("mass", "grip"), [(8.0, 1.0), (8.0, 4.0), (2.0, 1.0), (100.0, 40.0)])
def test_wheels_that_slip_push_with_all_their_grip(mass: float, grip: float) -> None:
    """Newton: at F / m it reaches F t / m and comes F t^2 / 2 m far, and is as slow to stop."""
    params = SimParams(mass_kg=mass, grip_n=grip)
    robot, pull = driven(Robot((0.0, 0.0, 0.7)), (0.5, 0.0), params, 8), grip / mass
    assert robot.speed == 0.5  # that of the wheels
    assert math.hypot(*robot.velocity) == pytest.approx(0.8 * pull)
    assert math.hypot(*robot.pose[:2]) == pytest.approx(0.5 * pull * 0.8**2, abs=STEP_S * pull)
    assert math.atan2(robot.pose[1], robot.pose[0]) == pytest.approx(0.7)
    before = robot.pose[:2]
    driven(robot, (0.0, 0.0), params, 40)
    assert robot.velocity == pytest.approx((0.0, 0.0), abs=1e-9)
    assert math.dist(before, robot.pose[:2]) > 0.5 * pull * 0.8**2


@pytest.mark.parametrize(("mass", "grip"), [(8.0, 0.1), (20.0, 0.1), (100.0, 2.0)])
def test_wheels_that_slip_in_a_turn_turn_with_all_their_grip(mass: float, grip: float) -> None:
    """A disc's moment of inertia is m r^2 / 2."""
    robot = driven(Robot((1.0, 2.0, 0.0)), (0.0, 1.5), SimParams(mass_kg=mass, turn_grip_nm=grip), 5)
    assert robot.yaw_rate == 1.5
    assert robot.spin == pytest.approx(0.5 * grip / (0.5 * mass * RADIUS_M**2))
    assert robot.pose[:2] == (1.0, 2.0)


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


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("degrees", [15, 30, 45, 60])
def test_along_a_wall_friction_holds_it_back_as_coulomb_says(friction: float, degrees: int) -> None:
    """The wheels pull at an angle to the wall's normal. The product of both frictions is Coulomb's coefficient."""
    params, angle = SimParams(friction=friction), math.radians(degrees)
    robot = Robot((-RADIUS_M, 0.0, angle))
    for _ in range(20):
        before = robot.pose[1]
        robot.drive(0.3, 0.0, params, 1.0, before_a_wall(friction))
    slides = 0.3 * (math.sin(angle) - friction * friction * math.cos(angle))
    assert (robot.pose[1] - before) / params.tick_s == pytest.approx(max(slides, 0.0), abs=0.002)
    assert robot.pose[0] == pytest.approx(-RADIUS_M, abs=0.002)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 1.0])
@pytest.mark.parametrize("turn_grip", [0.1, 200.0])
@pytest.mark.parametrize("grip", [1.0, 1000.0])
@pytest.mark.parametrize("mass", [1.0, 100.0])
def test_no_mass_grip_or_friction_takes_it_into_a_wall(
    mass: float, grip: float, turn_grip: float, friction: float
) -> None:
    params = SimParams(mass_kg=mass, grip_n=grip, turn_grip_nm=turn_grip, friction=friction)
    for speed, angle in ((0.5, 0.0), (0.5, 1.2), (0.03, 0.8)):
        robot = Robot((-0.3, 0.0, angle))
        for _ in range(60):
            robot.drive(speed, 0.1, params, 1.0, before_a_wall(friction))
            assert robot.pose[0] < 0.005 - RADIUS_M


def test_a_robot_that_slides_on_comes_no_farther_than_it_says() -> None:
    """Its wheels are slow again, and its reach must not be: what it can meet depends on it."""
    slippery = SimParams(grip_n=1.0, max_speed=2.0)
    robot, slow = driven(Robot((0.0, 0.0, 0.0)), (2.0, 0.0), slippery, 60), replace(slippery, max_speed=0.05)
    driven(robot, (0.0, 0.0), slow, 20)
    assert abs(robot.speed) < 1e-9
    before, reach = robot.pose[:2], robot.reach(slow)
    driven(robot, (0.0, 0.0), slow, 1)
    assert 0.04 < math.dist(before, robot.pose[:2]) <= reach - RADIUS_M + 1e-9
