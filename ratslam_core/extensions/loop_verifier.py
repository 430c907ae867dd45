"""[ours] A sight that would make the robot jump in the map is believed only after several in a row agree.

One look-alike must not close a loop. test_loop_verifier.py::test_one_look_alike_closes_no_loop. With
`experience_map.confirm_jumps` 0 every sight is believed at once, as in the papers.
"""

from __future__ import annotations

import math

from disk import kind
from ratslam_core.params import PoseFilterParams
from ratslam_core.types import Pose2, wrap_angle


@kind("loop verifier/2")
class LoopVerifier:
    """Counts the sights that agree on one displacement in the map."""

    def __init__(self, params: PoseFilterParams) -> None:
        self.params = params
        self.sights = 0
        self._dx = self._dy = self._turn = 0.0

    def believes(self, robot: Pose2, claimed: Pose2, needed: int) -> bool:
        """Whether to believe a look that claims another pose in the map than the robot's. needed: sights that must agree."""
        p = self.params
        dx, dy = claimed.x - robot.x, claimed.y - robot.y
        turn = wrap_angle(claimed.heading_rad - robot.heading_rad)
        if needed == 0 or (math.hypot(dx, dy) <= p.snap_m and abs(turn) <= p.snap_rad):
            self.sights = 0
            return True
        alike = abs(wrap_angle(turn - self._turn)) <= p.agrees_rad
        near = alike and math.hypot(dx - self._dx, dy - self._dy) <= p.agrees_m
        self.sights = self.sights + 1 if self.sights and near else 1
        self._dx, self._dy, self._turn = dx, dy, turn
        if self.sights < needed:
            return False
        self.sights = 0
        return True
