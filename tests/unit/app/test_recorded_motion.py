"""How a recorded robot moved: by wheels, gyro and throttle, pictures, or a laser."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recordings.motion import Motion
from app.recordings.recording import About, Moment
from app.recordings.scan_matching import Walls, points_of
from app.recordings.scan_odometry import ScanOdometry
from app.recordings.scan_ties import ScanTies
from app.recordings.visual_odometry import VisualOdometry
from ratslam_core import Odometry, Packet, Pose2, RatSlam, Recognition
from sim2d import Drive, Simulator, load_world

ANGLES = np.radians(np.arange(-89.5, 90.0))
CAR = About("car", "test", 9, 9.0, frozenset({"camera", "yaw rate", "throttle"}))


def _picture(level: int = 0) -> np.ndarray:
    return np.random.default_rng(level).integers(0, 255, (24, 32, 3), np.uint8)


def _moment(dt: float, throttle: float, yaw_rate: float, level: int) -> Moment:
    return Moment(0, 0.0, dt, _picture(level), throttle=throttle, yaw_rate=yaw_rate)


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


def _room(x: float, y: float, heading: float) -> np.ndarray:
    """Ranges in a room of 8 m x 5 m with a pillar in a corner."""
    c, s = np.cos(ANGLES + heading), np.sin(ANGLES + heading)
    with np.errstate(divide="ignore"):
        ahead = np.where(c > 0, (4.5 - x) / c, (-3.5 - x) / c)
        aside = np.where(s > 0, (3.0 - y) / s, (-2.0 - y) / s)
    return np.minimum(np.minimum(np.abs(ahead), np.abs(aside)), 20.0)


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.5, 0.5), st.floats(-0.2, 0.2))
def test_a_movement_in_a_room_is_found(x: float, y: float, heading: float, wrong: float) -> None:
    before, now = points_of(_room(0, 0, 0), ANGLES, 20.0), points_of(_room(x, y, heading), ANGLES, 20.0)
    found = Walls(before).match(now, Pose2(x + wrong / 2, y - wrong / 2, heading + wrong))
    assert found is not None
    assert (found.x, found.y, found.heading_rad) == pytest.approx((x, y, heading), abs=0.03)


def test_where_nothing_is_seen_wheels_are_believed() -> None:
    about = About("laser", "test", 2, 1.0, frozenset({"ranges"}), beam_angles_rad=tuple(ANGLES.tolist()))
    scans, told = ScanOdometry(about), Odometry(0.3, 0.2, 1.0)
    nothing = np.full(len(ANGLES), np.inf)
    assert scans.better(told, nothing) == told
    assert scans.better(told, nothing) == told


def test_a_laser_makes_wheels_better() -> None:
    about = About("laser", "test", 2, 1.0, frozenset({"ranges"}), beam_angles_rad=tuple(ANGLES.tolist()))
    scans = ScanOdometry(about)
    scans.better(Odometry(0.0, 0.0, 1.0), _room(0, 0, 0))
    found = scans.better(Odometry(0.25, 0.2, 1.0), _room(0.2, 0.0, 0.1))
    assert (found.yaw_rate, found.speed) == pytest.approx((0.1, 0.2), abs=0.02)


def test_a_scan_ties_an_experience_to_an_old_one_where_it_belongs() -> None:
    """Odometry is 0.3 m and 0.1 rad wrong when the robot comes back; the scan says so, and the map follows."""
    about = About("laser", "test", 2, 1.0, frozenset({"ranges"}), beam_angles_rad=tuple(ANGLES.tolist()))
    ties, map_ = ScanTies(about), RatSlam().experience_map
    path = [(0.0, 0.0, 0.0)] + [(0.1 * k, 0.0, 0.0) for k in range(1, 20)] + [(0.3, 0.0, 0.1)]
    before = path[0]
    for k, at in enumerate(path):
        way = (at[0] - before[0], at[2] - before[2])
        seen = Recognition(k, True, -1, math.inf)
        map_.step(Packet(3.0 * k % 64, 9.0, 0.0, 1.0), seen, Odometry(way[0], way[1], 1.0))
        true = (0.0, 0.0, 0.0) if k == len(path) - 1 else at
        ties.made(map_, _room(*true))
        before = at
    assert map_.closures > 0
    for _ in range(400):
        map_.correct()
    first, last = map_.pose(0), map_.pose(len(path) - 1)
    assert math.hypot(last.x - first.x, last.y - first.y) < 0.15
