"""How a recorded robot moved: by wheels, gyro and throttle, pictures, or a laser."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recordings.motion import Motion, VisualOdometry
from app.recordings.recording import About, Moment
from app.recordings.scans import ScanOdometry, ScanRules, Walls, points_of
from ratslam_core import Odometry, Pose2
from sim2d import Drive, Simulator, load_world

from .made_scans import ANGLES, room

CAR = About("car", "test", 9, 9.0, frozenset({"camera", "yaw rate", "throttle"}))
LASER = About("laser", "test", 2, 1.0, frozenset({"ranges"}), beam_angles_rad=tuple(ANGLES.tolist()))


def _moment(dt: float, throttle: float, yaw_rate: float, level: int) -> Moment:
    picture = np.random.default_rng(level).integers(0, 255, (24, 32, 3), np.uint8)
    return Moment(0, 0.0, dt, picture, throttle=throttle, yaw_rate=yaw_rate)


def test_turns_are_seen_the_right_way_round() -> None:
    """A turn to the right is a turn to the right, and a robot that stands does nothing."""
    simulator = Simulator(load_world("office"), seed=1)
    sees = VisualOdometry(simulator.params.camera_fov_rad)
    sees.see(simulator.observe().image)
    for yaw_rate in (0.4, -0.4):
        turn = true = 0.0
        for _ in range(12):
            before = simulator.truth.heading_rad
            turn += sees.see(simulator.step(Drive(0.0, yaw_rate)).image)[0]
            true += math.remainder(simulator.truth.heading_rad - before, math.tau)
        assert turn == pytest.approx(true, rel=0.35)
    image = simulator.observe().image
    sees.see(image)
    assert sees.see(image) == (0.0, 0.0, True)


def test_a_car_whose_picture_stands_stands() -> None:
    motion = Motion(CAR, 0.05, 1.0)
    motion.of(_moment(0.05, 0.2, 0.0, 0))
    assert motion.of(_moment(0.05, 0.2, 0.1, 1)) == Odometry(0.4, 0.1, 0.05)
    assert motion.of(_moment(0.05, 0.2, 0.1, 1)) == Odometry(0.0, 0.0, 0.05)
    assert motion.of(_moment(0.05, -0.2, 0.1, 2)).speed == 0.0  # it brakes


def test_a_late_moment_tells_of_its_end_only() -> None:
    motion = Motion(CAR, 0.05, 1.0)
    motion.of(_moment(0.05, 0.2, 0.0, 0))
    motion.of(_moment(0.05, 0.2, 1.0, 1))
    assert motion.of(_moment(1.0, 0.0, 0.0, 2)) == Odometry(0.2, 0.5, 1.0)
    assert not motion.gap
    assert motion.of(_moment(4.0, 0.2, 1.0, 3)) == Odometry(0.0, 0.0, 4.0)
    assert motion.gap


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5), st.floats(-0.2, 0.2))
def test_a_movement_in_a_room_is_found(x: float, y: float, heading: float, wrong: float) -> None:
    before, now = points_of(room(0, 0, 0), ANGLES, 20.0), points_of(room(x, y, heading), ANGLES, 20.0)
    found = Walls(before).match(now, Pose2(x + wrong / 2, y - wrong / 2, heading + wrong))
    assert found is not None
    pose = found.pose
    assert (pose.x, pose.y, pose.heading_rad) == pytest.approx((x, y, heading), abs=0.03)


def test_a_laser_makes_wheels_better() -> None:
    """Where it sees nothing, they are believed."""
    scans, told = ScanOdometry(LASER), Odometry(0.3, 0.2, 1.0)
    nothing = np.full(len(ANGLES), np.inf)
    assert [scans.better(told, nothing) for _ in range(2)] == [told, told]
    scans = ScanOdometry(LASER)
    scans.better(Odometry(0.0, 0.0, 1.0), room(0, 0, 0))
    found = scans.better(Odometry(0.25, 0.2, 1.0), room(0.2, 0.0, 0.1))
    assert (found.yaw_rate, found.speed) == pytest.approx((0.1, 0.2), abs=0.02)


def test_errors_do_not_grow_with_the_rate_of_scans() -> None:
    """A metre and a half in steps of a centimetre, with ranges that are 3 cm noisy: the plain twin adds up all its errors."""
    off = {True: 0.0, False: 0.0}
    for local_map, seed in ((kind, seed) for kind in off for seed in range(3)):
        rng, scans, at = (
            np.random.default_rng(seed),
            ScanOdometry(LASER, ScanRules(local_map=local_map)),
            Pose2(0.0, 0.0, 0.0),
        )
        for k in range(151):
            told = Odometry(0.01 * (k > 0), 0.0, 1.0)
            found = scans.better(told, room(0.01 * k, 0, 0) + 0.03 * rng.standard_normal(len(ANGLES)))
            turn = found.yaw_rate
            at = at.compose(Pose2(found.speed * math.cos(turn / 2), found.speed * math.sin(turn / 2), turn))
        off[local_map] += math.hypot(at.x - 1.5, at.y) / 3
    assert off[True] < 0.01 < off[False]
