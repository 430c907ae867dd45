"""How a recorded robot moved, from what its recording has: wheels, gyro, throttle, pictures alone, or its truth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.sensed import Rates
from app.recordings.recording import About, Moment, Recording, Wanted, every
from app.recordings.scans import ScanOdometry, ScanRules, is_laser
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
        """dt: of a typical moment, s; levels_per_m: how much a picture changes while the robot drives a metre.

        scans: how a laser, if there is one, makes the wheels better; None: it does not.
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
        if moment.throttle is None:
            speed = change / self._levels_per_m / dt
        else:
            speed = THROTTLE_SPEED * max(moment.throttle, 0.0)  # one below zero brakes
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


def typical(values: list[float]) -> float:
    """The median of those that are not zero; 0 when there is none."""
    some = sorted(abs(v) for v in values if v != 0 and math.isfinite(v))
    return some[len(some) // 2] if some else 0.0


COLUMNS = 64
BAND = 0.75  # share of the picture, from the top: the floor before a robot flows too fast to be compared
MOST = 24  # columns that two profiles may be shifted
STANDS = 1.0  # grey levels; pictures that differ by less show the camera's noise and nothing else

Profile = NDArray[np.float64]  # (COLUMNS,) mean grey level of each column, mean 0


@kind("visual odometry/1")
class VisualOdometry:
    """Odometry from pictures alone: the turn from the shift of their columns, the speed from what the shift leaves.

    Milford and Wyeth 2008, section III: two scanline intensity profiles are laid over each other. One unit of speed is
    what changes the profile by its typical change; whoever needs metres has to scale it.
    """

    def __init__(self, field_of_view: float) -> None:
        """field_of_view: width of the camera's view, rad."""
        self.field_of_view = field_of_view
        self._small: NDArray[np.float64] | None = None

    def see(self, image: NDArray[np.uint8]) -> tuple[float, float, bool]:
        """(turn in rad, left positive; change in grey levels; whether it stands) since the picture before.

        The first picture tells nothing: it stands.
        """
        small, before = small_grey(image), self._small
        self._small = small
        if before is None or float(np.abs(small - before).mean()) < STANDS:
            return 0.0, 0.0, True
        shift, left = shift_of(profile_of(small), profile_of(before))
        return shift * self.field_of_view / COLUMNS, left, False


def small_grey(image: NDArray[np.uint8]) -> NDArray[np.float64]:
    """A picture as 64 x 48 grey levels, in which the camera's noise has been averaged out."""
    grey = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)) if image.ndim == 3 else image
    return np.asarray(cv2.resize(grey, (COLUMNS, 48), interpolation=cv2.INTER_AREA), np.float64)


def profile_of(small: NDArray[np.float64]) -> Profile:
    """The scanline intensity profile of a small grey picture."""
    means = small[: int(BAND * len(small))].mean(axis=0)
    return means - means.mean()


def shift_of(new: Profile, old: Profile, most: int = MOST) -> tuple[float, float]:
    """By how many columns the scene has moved to the right from `old` to `new`, to a fraction; and the mean difference
    left. A robot that turns left, which is positive, sees the scene move to the right.
    """
    apart = np.array([_apart(new, old, s) for s in range(-most, most + 1)])
    best = int(apart.argmin())
    part = 0.0
    if 0 < best < 2 * most:
        left, least, right = apart[best - 1 : best + 2]
        steepest = max(left, right) - least
        part = (left - right) / (2 * steepest) if steepest > 0 else 0.0
    return best - most + part, float(apart[best])


def _apart(new: Profile, old: Profile, shift: int) -> float:
    """Mean absolute difference of two profiles over the columns that both show."""
    here, there = new[max(shift, 0) : COLUMNS + min(shift, 0)], old[max(-shift, 0) : COLUMNS - max(shift, 0)]
    off = here - there
    return float(np.abs(off - off.mean()).mean())


@dataclass(frozen=True, slots=True)
class OdometryErrors:
    """The errors that wheels would have made: odometry from a truth has them, in recordings that have no wheels."""

    speed_noise: float  # standard deviation, as a share of the speed
    yaw_noise: float  # standard deviation (rad/s)
    yaw_bias: float  # rad/s, the same all the time

    def __post_init__(self) -> None:
        for name, low in (("speed_noise", 0.0), ("yaw_noise", 0.0), ("yaw_bias", -10.0)):
            if not low <= getattr(self, name) <= 10.0:
                raise ValueError(f"{name} must be from {low:g} to 10, got {getattr(self, name):g}")


def parse_errors(text: str) -> OdometryErrors:
    """SPEED_NOISE,YAW_NOISE,BIAS as numbers. ValueError."""
    parts = text.split(",")
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if len(values) != 3:
        raise ValueError(
            f"--odometry-from-truth takes SPEED_NOISE,YAW_NOISE,BIAS (such as 0.1,0.02,0.005), got {text[:60]!r}"
        )
    return OdometryErrors(*values)


class WithMadeOdometry:
    """A recording whose speed and yaw rate are made from its truth. The same seed makes the same errors."""

    def __init__(self, recording: Recording, errors: OdometryErrors, seed: int) -> None:
        """ValueError: it has no truth."""
        if "truth" not in recording.about.has:
            raise ValueError(f"{recording.about.name}: has no truth that odometry could be made from")
        self._recording, self._errors, self._seed = recording, errors, seed

    @property
    def about(self) -> About:
        about, e = self._recording.about, self._errors
        made = (
            f"speed and yaw rate: made from the truth, with noise of {e.speed_noise:g} of the speed and "
            f"{e.yaw_noise:g} rad/s, and a bias of {e.yaw_bias:g} rad/s"
        )
        return replace(
            about,
            has=about.has | {"speed", "yaw rate"},
            uses=(*(use for use in about.uses if not use.startswith("no odometry")), made),
        )

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        rng, rates = np.random.default_rng(self._seed), Rates()
        for moment in self._recording.moments(wanted):
            speed = turn = 0.0
            if moment.truth is not None:
                speed, turn = rates.since(round(moment.time_s * 1e9), moment.truth) or (0.0, 0.0)
            noise = rng.standard_normal(2)
            speed *= 1 + self._errors.speed_noise * float(noise[0])
            turn += self._errors.yaw_noise * float(noise[1]) + self._errors.yaw_bias
            if not math.isfinite(speed + turn):
                speed = turn = 0.0
            yield replace(moment, speed=speed, yaw_rate=turn)
