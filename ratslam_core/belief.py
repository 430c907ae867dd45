"""[ours] Where the robot is in the map: what it sees, weighed against where odometry says it must have come to.

A single look tells place and heading within decimetres and degrees only; taken at its word at each experience, it makes
the robot swerve. test_belief.py::test_a_doubtful_look_moves_the_belief_little.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ratslam_core.types import IDENTITY, Pose2, wrap_angle

SNAP_M = 1.0  # a look that disagrees more is a relocalisation: it is believed at once
SNAP_RAD = 0.8
LEAST_SIGMA_M = 0.06  # a belief is never firmer, so that it can follow the map


@dataclass(slots=True)
class Belief:
    """A pose in the frame of the active experience and how far off it may be (m)."""

    local: Pose2 = IDENTITY
    sigma: float = 0.0

    def move(self, moved: Pose2, drift_m: float) -> None:
        """The robot moved by odometry, which may be wrong by `drift_m`."""
        self.local = self.local.compose(moved)
        self.sigma += drift_m

    def see(self, look: Pose2, sigma: float) -> None:
        """A look says that the robot is at `look`, give or take `sigma` metres."""
        dx, dy = look.x - self.local.x, look.y - self.local.y
        turn = wrap_angle(look.heading_rad - self.local.heading_rad)
        if math.hypot(dx, dy) > SNAP_M or abs(turn) > SNAP_RAD:
            self.local, self.sigma = look, sigma
            return
        own = max(self.sigma, LEAST_SIGMA_M)
        gain = own**2 / (own**2 + sigma**2) if sigma > 0 else 1.0
        heading = wrap_angle(self.local.heading_rad + gain * turn)
        self.local = Pose2(self.local.x + gain * dx, self.local.y + gain * dy, heading)
        self.sigma = own * math.sqrt(1 - gain)
