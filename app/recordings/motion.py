"""How a recorded robot moved, from what its recording has: wheels, gyro, throttle, or pictures alone."""

from __future__ import annotations

import math

from app.recordings.recording import About, Moment
from app.recordings.visual_odometry import VisualOdometry
from ratslam_core import Odometry

THROTTLE_SPEED = 2.0  # m/s at full throttle, of a toy car; the rules measure all lengths by the typical speed anyway
GAP_TIMES, GAP_S = 10.0, 1.0  # a moment that comes so many typical times later, and so many seconds, comes after a gap


class Motion:
    """One odometry for each moment. Who needs the turn from pictures has to know the camera's field of view."""

    def __init__(self, about: About, dt: float, field_of_view: float, levels_per_m: float = 1.0) -> None:
        """dt: of a typical moment, s; levels_per_m: how much a picture changes while the robot drives a metre."""
        self._about, self._dt, self._field_of_view, self._levels_per_m = about, dt, field_of_view, levels_per_m
        self._sees = VisualOdometry(field_of_view) if "camera" in about.has and not _wheels(about) else None
        self.gap = False  # whether the newest moment comes after a gap in which nobody knows what the robot did

    def anew(self) -> Motion:
        """The same for another time through the recording."""
        return Motion(self._about, self._dt, self._field_of_view, self._levels_per_m)

    def of(self, moment: Moment) -> Odometry:
        """The movement that led to this moment.

        Without wheels a robot stands while its picture does. A negative throttle brakes. Across a gap, nothing is told
        by a gyro or a throttle of this moment: the robot counts as standing, and `gap` says so unless its picture stood.
        """
        turn, change, stands = self._look(moment)
        dt = max(moment.dt, 1e-6)
        speed, yaw_rate = moment.speed, moment.yaw_rate
        self.gap = speed is None and not stands and dt > max(GAP_TIMES * self._dt, GAP_S)
        if speed is None and (stands or self.gap):
            return Odometry(0.0, 0.0 if stands or self.gap or yaw_rate is None else yaw_rate, dt)
        if speed is None:
            speed = change / self._levels_per_m / dt if moment.throttle is None else self._driven(moment.throttle)
        return Odometry(speed, turn / dt if yaw_rate is None else yaw_rate, dt)

    def _driven(self, throttle: float) -> float:
        return THROTTLE_SPEED * max(throttle, 0.0)

    def _look(self, moment: Moment) -> tuple[float, float, bool]:
        if self._sees is None or moment.image is None:
            return 0.0, 0.0, False
        return self._sees.see(moment.image)


def _wheels(about: About) -> bool:
    return {"speed", "yaw rate"} <= about.has


def typical(values: list[float]) -> float:
    """The median of those that are not zero; 0 when there is none."""
    some = sorted(abs(v) for v in values if v != 0 and math.isfinite(v))
    return some[len(some) // 2] if some else 0.0
