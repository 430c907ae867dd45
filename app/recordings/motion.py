"""How a recorded robot moved, from what its recording has: wheels, gyro, throttle, or pictures alone."""

from __future__ import annotations

import math

from app.recordings.recording import About, Moment
from app.recordings.scan_odometry import ScanOdometry, is_laser
from app.recordings.scan_rules import ScanRules
from app.recordings.visual_odometry import VisualOdometry
from disk import copy_state, kind
from ratslam_core import Odometry

THROTTLE_SPEED = 2.0  # m/s at full throttle, of a toy car; the rules measure all lengths by the typical speed anyway
LATE_TIMES = 3.0  # a moment that comes so many typical times later is late: what it tells is not that of the whole time
GAP_TIMES, GAP_S = 10.0, 3.0  # and so many times, and seconds, later, nobody knows what the robot did


@kind("motion/1")
class Motion:
    """One odometry for each moment. Who needs the turn from pictures has to know the camera's field of view."""

    def __init__(
        self,
        about: About,
        dt: float,
        field_of_view: float,
        levels_per_m: float = 1.0,
        *,
        scans: ScanRules | None = None,
    ) -> None:
        """scans: how a laser, if there is one, makes the wheels better, None: it does not; dt: of a typical moment, s.

        levels_per_m: how much a picture changes while the robot drives a metre.
        """
        self._dt, self._levels_per_m = dt, levels_per_m
        wheels = "speed" in about.has
        self._sees = VisualOdometry(field_of_view) if "camera" in about.has and not wheels else None
        self._scans = ScanOdometry(about, scans) if scans is not None and wheels and is_laser(about) else None
        self._before: tuple[float, float] | None = None  # speed and yaw rate that were told last
        self.gap = False  # whether the newest moment comes after a gap

    def anew(self) -> Motion:
        """The same for another time through the recording. This one must not have been used."""
        return copy_state(self)

    def of(self, moment: Moment) -> Odometry:
        """The movement that led to this moment.

        Without wheels a robot stands while its picture does. A gyro and a throttle tell of an instant: of a late moment,
        the mean of what they tell now and told before counts, and across a gap nothing (`gap`).
        """
        self.gap = False
        dt = max(moment.dt, 1e-6)
        if moment.speed is not None:
            told = Odometry(moment.speed, moment.yaw_rate or 0.0, dt)
            return told if self._scans is None or moment.ranges_m is None else self._scans.better(told, moment.ranges_m)
        turn, change, stands = self._look(moment)
        speed = change / self._levels_per_m / dt if moment.throttle is None else _driven(moment.throttle)
        yaw_rate = turn / dt if moment.yaw_rate is None else moment.yaw_rate
        told, before = (speed, yaw_rate), self._before
        self._before = told
        if stands:
            return Odometry(0.0, 0.0, dt)
        self.gap = dt > max(GAP_TIMES * self._dt, GAP_S)
        if self.gap:
            return Odometry(0.0, 0.0, dt)
        if dt > LATE_TIMES * self._dt and before is not None:
            speed = speed if moment.throttle is None else (speed + before[0]) / 2
            yaw_rate = yaw_rate if moment.yaw_rate is None else (yaw_rate + before[1]) / 2
        return Odometry(speed, yaw_rate, dt)

    def _look(self, moment: Moment) -> tuple[float, float, bool]:
        if self._sees is None or moment.image is None:
            return 0.0, 0.0, False
        return self._sees.see(moment.image)


def lengths(about: About) -> str | None:
    """What a length in the map is where no wheels tell of metres; None where they do."""
    if "speed" in about.has:
        return None
    if "throttle" in about.has:
        return f"lengths are no metres: full throttle is taken for {THROTTLE_SPEED:g} m/s"
    return "lengths are no metres: by pictures alone nobody knows how fast the robot is, and its typical speed is the office's"


def _driven(throttle: float) -> float:
    """m/s; a throttle below zero brakes."""
    return THROTTLE_SPEED * max(throttle, 0.0)


def typical(values: list[float]) -> float:
    """The median of those that are not zero; 0 when there is none."""
    some = sorted(abs(v) for v in values if v != 0 and math.isfinite(v))
    return some[len(some) // 2] if some else 0.0
