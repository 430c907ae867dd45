"""Turning back to look: the robot retraces its recent path, then returns to where it turned back. IROS 2005 section IV.D.

So it sees each region from both directions, and what it has just learnt at once a second time.
"""

from __future__ import annotations

import math

from app.pilot.local_movement import LocalMovement
from app.pilot.params import PilotParams
from disk import kind
from ratslam_core import Odometry, Pose2
from ratslam_core.pose_graph.transitions import moved_by
from ratslam_core.types import IDENTITY, wrap_angle

LOOK_BACK_RAD = math.radians(30)  # C IV.D: a turn by so much makes it look back, too
STEP_M, AHEAD_M = 0.1, 0.5  # between two points of its path, and how far ahead on it the robot aims
STRAIGHT_RAD = 0.05  # between two points of a straight path
REACHED_M = 0.2  # from the end of a leg
ASTRAY_M = 1.0  # from the end of its path: it has been elsewhere since, on a way to a goal
PATIENCE = 3.0  # a leg that takes so many times longer than at cruise speed is given up


@kind("looking back/1")
class LookingBack:
    """Remembers the path since the robot last looked back, by its odometry, and drives along it to and fro."""

    def __init__(self) -> None:
        self._robot = IDENTITY  # in the frame of its odometry
        self._path = [IDENTITY]
        self._ahead: list[Pose2] = []  # what is left of this leg
        self._way = self._leg_s = 0.0  # m of path; s since this leg began
        self._turns = True  # whether its path bends where it is

    def move(self, odometry: Odometry) -> None:
        self._robot, self._leg_s = self._robot.compose(moved_by(odometry)), self._leg_s + odometry.dt

    def note(self) -> None:
        """The robot is on its way: this belongs to the path."""
        gone = _far(self._robot, self._path[-1])
        if gone > ASTRAY_M:
            self.begin_path()
        elif gone > STEP_M:
            self._turns = _turn(self._path[-1], self._robot) > STRAIGHT_RAD
            self._path.append(self._robot)
            self._way += gone

    def is_due(self, p: PilotParams) -> bool:
        """After so long a path, or round a corner: while it still turns, there is more of it to come."""
        round_it = _turn(self._path[0], self._robot) > LOOK_BACK_RAD and not self._turns
        return self._way > p.look_back_after_m or round_it

    def begin_leg(self, *, back: bool) -> None:
        self._ahead, self._leg_s = self._path[::-1] if back else self._path[:], 0.0

    def begin_path(self) -> None:
        self._path, self._way, self._turns = [self._robot], 0.0, True

    def drive(self, local: LocalMovement, p: PilotParams) -> tuple[float, float] | None:
        """Speed and yaw rate along the path; None at its end."""
        while len(self._ahead) > 1 and _far(self._robot, self._ahead[0]) < AHEAD_M:
            del self._ahead[0]
        aim = self._robot.inverse().compose(self._ahead[0])
        near = AHEAD_M if aim.x <= 0 else REACHED_M
        if math.hypot(aim.x, aim.y) < near or self._leg_s > PATIENCE * p.look_back_after_m / p.cruise_speed:
            return None
        return local.towards(aim.x, aim.y, p)


def _far(a: Pose2, b: Pose2) -> float:
    return math.hypot(a.x - b.x, a.y - b.y)


def _turn(a: Pose2, b: Pose2) -> float:
    return abs(wrap_angle(b.heading_rad - a.heading_rad))
