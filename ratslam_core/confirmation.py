"""[ours] Sights that would move the robot through the map are believed when several in a row agree.

One look-alike is not enough to close a loop with. test_confirmation.py::test_one_look_alike_closes_no_loop.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ratslam_core.belief import SNAP_M, SNAP_RAD
from ratslam_core.types import Pose2, wrap_angle

AGREES_M = 0.5
AGREES_RAD = 0.4


@dataclass(slots=True)
class Confirmation:
    """Counts the sights that agree on one displacement in the map."""

    sights: int = 0
    _dx: float = 0.0
    _dy: float = 0.0
    _turn: float = 0.0

    def believes(self, robot: Pose2, claimed: Pose2, needed: int) -> bool:
        """Whether the robot, which believes to be at one pose of the map, may take a look that says another."""
        dx, dy = claimed.x - robot.x, claimed.y - robot.y
        turn = wrap_angle(claimed.heading_rad - robot.heading_rad)
        if needed == 0 or (math.hypot(dx, dy) <= SNAP_M and abs(turn) <= SNAP_RAD):
            self.sights = 0
            return True
        near = math.hypot(dx - self._dx, dy - self._dy) <= AGREES_M and abs(wrap_angle(turn - self._turn)) <= AGREES_RAD
        self.sights = self.sights + 1 if self.sights and near else 1
        self._dx, self._dy, self._turn = dx, dy, turn
        if self.sights < needed:
            return False
        self.sights = 0
        return True
