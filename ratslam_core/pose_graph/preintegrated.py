"""Odometry summed up since a certain moment."""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from ratslam_core.types import IDENTITY, Odometry, Pose2, pose_of, wrap_angle


@kind("preintegrated odometry/1")
@dataclass(slots=True)
class PreintegratedOdometry:
    """The movement in the frame of where it began, the distance driven, the time the wheels turned, and all the time."""

    moved: Pose2 = IDENTITY
    way_m: float = 0.0
    turning_s: float = 0.0
    time_s: float = 0.0

    def add(self, moved: Pose2, odometry: Odometry) -> None:
        self.moved = self.moved.compose(moved)
        self.way_m += abs(odometry.speed * odometry.dt)
        self.turning_s += odometry.dt * (not odometry.still)
        self.time_s += odometry.dt


def moved_by(odometry: Odometry) -> Pose2:
    """One step in the robot's own frame: straight along the heading in the middle of the step."""
    middle = odometry.yaw_rate * odometry.dt / 2
    step = odometry.speed * odometry.dt
    return pose_of(step * math.cos(middle), step * math.sin(middle), wrap_angle(2 * middle))
