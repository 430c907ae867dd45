"""The robot's body without an office: on free floor it rolls as physics would have it roll."""

from __future__ import annotations

import math

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
