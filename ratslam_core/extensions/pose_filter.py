"""[ours] Where the robot is in the map: each look is weighed against odometry.

A single look is precise to decimetres and degrees only. If each were taken as it is, the estimate would swerve.
test_pose_filter.py::test_a_doubtful_look_moves_the_belief_little. `LatestLook` is the plain twin: in ACRA 2006 section
3 the robot is at the active experience, moved on by the odometry since.
"""

from __future__ import annotations

import math
from typing import Protocol

from disk import kind
from ratslam_core.params import PoseFilterParams
from ratslam_core.types import IDENTITY, Pose2, wrap_angle


class PoseEstimate(Protocol):
    """A pose in the frame of the active experience."""

    params: PoseFilterParams
    local: Pose2
    sigma_m: float  # how far off it may be

    def forget(self, sigma_m: float, /) -> None:
        """The robot was carried away."""
        ...

    def make(self, *, sure: bool) -> None:
        """An experience was made where the robot is. sure: it is the first of its map, so that this is certain."""
        ...

    def move(self, moved: Pose2, drift_m: float, /) -> None:
        """The robot moved by odometry, which may be wrong by `drift_m`."""
        ...

    def see(self, look: Pose2, sigma_m: float, /) -> bool:
        """A look puts the robot at `look`, give or take `sigma_m`. Returns whether that agrees with the pose so far."""
        ...


@kind("pose filter/3")
class PoseFilter:
    """The pose and how far off it may be (m)."""

    def __init__(self, params: PoseFilterParams) -> None:
        self.params = params
        self.local = IDENTITY
        self.sigma_m = 0.0

    def forget(self, sigma_m: float) -> None:
        self.sigma_m = sigma_m

    def make(self, *, sure: bool) -> None:
        self.local = IDENTITY
        if sure:
            self.sigma_m = 0.0

    def move(self, moved: Pose2, drift_m: float) -> None:
        self.local = self.local.compose(moved)
        self.sigma_m += drift_m

    def see(self, look: Pose2, sigma_m: float) -> bool:
        dx, dy = look.x - self.local.x, look.y - self.local.y
        turn = wrap_angle(look.heading_rad - self.local.heading_rad)
        if math.hypot(dx, dy) > self.params.snap_m or abs(turn) > self.params.snap_rad:
            self.local, self.sigma_m = look, sigma_m
            return False
        own = max(self.sigma_m, self.params.least_sigma_m)
        gain = own**2 / (own**2 + sigma_m**2)
        heading = wrap_angle(self.local.heading_rad + gain * turn)
        self.local = Pose2(self.local.x + gain * dx, self.local.y + gain * dy, heading)
        self.sigma_m = own * math.sqrt(1 - gain)
        return True


@kind("latest look/2")
class LatestLook:
    """As in the papers: the robot is where the last look put it, moved on by the odometry since."""

    sigma_m = math.inf  # it does not know

    def __init__(self, params: PoseFilterParams) -> None:
        self.params = params
        self.local = IDENTITY

    def forget(self, _sigma_m: float) -> None:
        """It does not know how far off it may be."""

    def make(self, *, sure: bool) -> None:  # noqa: ARG002
        self.local = IDENTITY

    def move(self, moved: Pose2, _drift_m: float) -> None:
        self.local = self.local.compose(moved)

    def see(self, look: Pose2, _sigma_m: float) -> bool:
        self.local = look
        return True


def pose_estimate(params: PoseFilterParams) -> PoseEstimate:
    """The estimate that the parameters choose."""
    return PoseFilter(params) if params.enabled else LatestLook(params)
