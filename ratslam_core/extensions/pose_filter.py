"""[ours] Where the robot is in the map: each observation is weighed against odometry.

A single observation is precise to decimetres and degrees only. If each were taken as it is, the estimate would swerve.
test_pose_filter.py::test_an_uncertain_observation_moves_the_estimate_little. One without a sigma is believed as it is, as in ACRA
2006 section 3: the robot is at the active experience, moved on by the odometry since
(test_pose_filter.py::test_an_observation_without_a_sigma_is_where_the_robot_is).
"""

from __future__ import annotations

import math

from disk import kind
from ratslam_core.types import IDENTITY, Pose2, wrap_angle

SNAP, SNAP_RAD = 4.0, 0.8  # cells; an observation farther off, or turned by more, is believed at once ...
SNAP_SIGMA = 3.0  # ... if that is more than so many of its deviations, too
LEAST_SIGMA = 0.24  # cells: the error of the estimate is never taken as smaller, so that it can follow the map


@kind("pose filter/4")
class PoseFilter:
    """The pose in the frame of the active experience, and how far off it may be (m)."""

    def __init__(self, cell_m: float) -> None:
        """cell_m: side of a cell of the pose cells."""
        self.cell_m = cell_m
        self.local = IDENTITY
        self.sigma_m: float = 0.0  # how far off it may be

    def forget(self, sigma_m: float) -> None:
        """The robot was carried away."""
        self.sigma_m = sigma_m

    def make(self, *, sure: bool) -> None:
        """An experience was made where the robot is. sure: it is the first of its map, so that this is certain."""
        self.local = IDENTITY
        if sure:
            self.sigma_m = 0.0

    def move(self, moved: Pose2, drift_m: float) -> None:
        """The robot moved by odometry, which may be wrong by `drift_m`."""
        self.local = self.local.compose(moved)
        self.sigma_m += drift_m

    def see(self, observation: Pose2, sigma_m: float) -> bool:
        """The robot was observed at `observation`, give or take `sigma_m`. Returns whether that agrees with the pose so far."""
        dx, dy = observation.x - self.local.x, observation.y - self.local.y
        turn = wrap_angle(observation.heading_rad - self.local.heading_rad)
        if math.hypot(dx, dy) > max(SNAP * self.cell_m, SNAP_SIGMA * sigma_m) or abs(turn) > SNAP_RAD:
            self.local, self.sigma_m = observation, sigma_m
            return False
        own = max(self.sigma_m, LEAST_SIGMA * self.cell_m)
        gain = own**2 / (own**2 + sigma_m**2)
        heading = wrap_angle(self.local.heading_rad + gain * turn)
        self.local = Pose2(self.local.x + gain * dx, self.local.y + gain * dy, heading)
        self.sigma_m = own * math.sqrt(1 - gain)
        return True
