"""[ours] Odometry of wheels, made better by a laser: each scan is laid over what was seen shortly before.

That is a local map of some scans, not the last scan alone: then errors grow with the way, not with the number of scans.
test_recorded_motion.py::{test_a_laser_makes_wheels_better,test_errors_do_not_grow_with_the_rate_of_scans}. `ScanRules.local_map`
off is the plain twin.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.recordings.recording import About
from app.recordings.scan_matching import Walls, points_of
from app.recordings.scan_rules import ScanRules
from disk import kind
from ratslam_core import Odometry, Pose2

IDENTITY = Pose2(0.0, 0.0, 0.0)
LEAST_BEAMS = 60  # fewer are sonars
FARTHEST_M = 20.0  # two beams side by side are too far apart beyond
KEY_M, KEY_RAD = 0.4, 0.3  # a scan so far from the last one that was kept is kept
MOST_KEPT, KEPT_M = 8, 2.0  # scans that are kept, and along how much way; from farther off, walls look otherwise


def is_laser(about: About) -> bool:
    """Whether its ranges are a laser's."""
    return len(about.beam_angles_rad) >= LEAST_BEAMS


@kind("scan odometry/2")
class ScanOdometry:
    """Remembers the scans before."""

    def __init__(self, about: About, rules: ScanRules | None = None) -> None:
        self._rules = rules or ScanRules()
        self._angles = np.array(about.beam_angles_rad)
        self._limit_m = min(FARTHEST_M, about.range_limit_m or FARTHEST_M)
        self._at = IDENTITY  # the robot in the frame of the newest scan that was kept
        self._kept: list[tuple[Pose2, Walls]] = []  # in that frame, the newest last
        self._walls: Walls | None = None  # all of them

    def better(self, told: Odometry, ranges_m: NDArray[np.float64]) -> Odometry:
        """The movement that lays this scan over those before, near what the wheels told; that itself where none does."""
        way, turn = told.speed * told.dt, told.yaw_rate * told.dt
        if self._walls is not None and way == 0 and turn == 0:
            return told
        now = points_of(ranges_m, self._angles, self._limit_m)
        before = self._at
        self._at = before.compose(_along(way, turn))
        found = None if self._walls is None else self._walls.match(now, self._at)
        if found is not None:
            moved = before.inverse().compose(found.pose)
            turn = moved.heading_rad
            way = moved.x * math.cos(turn / 2) + moved.y * math.sin(turn / 2)
            self._at = before.compose(_along(way, turn))  # wheels do not slip sideways
        if self._walls is None or self._is_new():
            self._keep(Walls(now))
        return told if found is None else Odometry(way / told.dt, turn / told.dt, told.dt)

    def _is_new(self) -> bool:
        far = math.hypot(self._at.x, self._at.y) > KEY_M or abs(self._at.heading_rad) > KEY_RAD
        return far or not self._rules.local_map

    def _keep(self, walls: Walls) -> None:
        back = self._at.inverse()
        kept = [(back.compose(at), each) for at, each in self._kept]
        near = [(at, each) for at, each in kept if math.hypot(at.x, at.y) < KEPT_M]
        self._kept = [*near[1 - MOST_KEPT :], (IDENTITY, walls)] if self._rules.local_map else [(IDENTITY, walls)]
        self._walls = Walls.joined(self._kept)
        self._at = IDENTITY


def _along(way: float, turn: float) -> Pose2:
    return Pose2(way * math.cos(turn / 2), way * math.sin(turn / 2), turn)
