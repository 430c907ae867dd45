"""[ours] Odometry of wheels, made better by a laser: each scan is laid over the one before.

test_recorded_motion.py::test_a_laser_makes_wheels_better.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.recordings.recording import About
from app.recordings.scan_matching import Points, Walls, points_of
from disk import kind
from ratslam_core import Odometry, Pose2

LEAST_BEAMS = 60  # fewer are sonars
FARTHEST_M = 20.0  # two beams side by side are too far apart beyond


def is_laser(about: About) -> bool:
    """Whether its ranges are a laser's."""
    return len(about.beam_angles_rad) >= LEAST_BEAMS


@kind("scan odometry/1")
class ScanOdometry:
    """Remembers the scan before."""

    def __init__(self, about: About) -> None:
        self._angles = np.array(about.beam_angles_rad)
        self._limit_m = min(FARTHEST_M, about.range_limit_m or FARTHEST_M)
        self._before: Points | None = None

    def better(self, told: Odometry, ranges_m: NDArray[np.float64]) -> Odometry:
        """The movement that lays this scan over the one before, near what the wheels told; that itself where none does."""
        now, before = points_of(ranges_m, self._angles, self._limit_m), self._before
        self._before = now
        way, turn = told.speed * told.dt, told.yaw_rate * told.dt
        if before is None or (way == 0 and turn == 0):
            return told
        found = Walls(before).match(now, Pose2(way * math.cos(turn / 2), way * math.sin(turn / 2), turn))
        if found is None:
            return told
        turn = found.heading_rad
        forwards = found.x * math.cos(turn / 2) + found.y * math.sin(turn / 2)
        return Odometry(forwards / told.dt, turn / told.dt, told.dt)
