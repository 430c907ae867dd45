"""How long the robot has been in one place, by its own odometry."""

from __future__ import annotations

import math

from disk import kind
from ratslam_core import Odometry

PLACE_M = 1.0  # it stays while it comes no farther than this


@kind("stay/1")
class Stay:
    """`seconds`: since it came to a place that it has not left."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._x = self._y = 0.0  # m, from that place
        self._heading = 0.0  # rad

    def leave(self) -> None:
        """It is counted from now."""
        self.seconds = self._x = self._y = 0.0

    def move(self, odometry: Odometry) -> None:
        step, turn = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        middle = self._heading + turn / 2
        self._heading += turn
        self._x += step * math.cos(middle)
        self._y += step * math.sin(middle)
        self.seconds += odometry.dt
        if math.hypot(self._x, self._y) > PLACE_M:
            self.leave()
