"""What a recording's line or message tells, before moments are made of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation

import numpy as np
from numpy.typing import NDArray

from app.recordings.recording import Pose

MOST_NS = 10**20  # some three thousand years

Picture = Callable[[], NDArray[np.uint8]]  # unpacks it when it is needed; ValueError says what is wrong with it


@dataclass(frozen=True, slots=True)
class Sensed:
    """One line or message; None: it does not have it. Rates are those of the time since the one before."""

    time_ns: int
    where: str  # "line 7", "message 12 of /odom"
    image: Picture | None = None
    ranges_m: NDArray[np.float64] | None = None
    speed: float | None = None
    yaw_rate: float | None = None
    throttle: float | None = None
    truth: Pose | None = None
    behaviour: int | None = None
    frame: int | None = None  # the picture's or scan's number, where some that cannot be read are counted, too
    source: str = ""  # what it is counted under, as in `Problems.seen`: "messages of /odom"


class Rates:
    """Speed and yaw rate from odometry's poses, each since the pose before."""

    def __init__(self) -> None:
        self._last: tuple[int, Pose] | None = None

    def since(self, time_ns: int, pose: Pose) -> tuple[float, float] | None:
        """m/s forwards and rad/s; None for the first pose, or when no time has passed.

        The way between two poses is taken as straight along the middle of their headings, as the engine does.
        """
        if self._last is None or time_ns < self._last[0]:
            self._last = time_ns, pose
            return None
        dt = (time_ns - self._last[0]) / 1e9
        if dt == 0:
            return None
        (x0, y0, h0), (x1, y1, h1) = self._last[1], pose
        self._last = time_ns, pose
        turn = math.remainder(h1 - h0, math.tau)
        middle = h0 + turn / 2
        return ((x1 - x0) * math.cos(middle) + (y1 - y0) * math.sin(middle)) / dt, turn / dt


def ns_of(text: str, unit_ns: int = 1_000_000_000) -> int:
    """A time as it is written, in whole nanoseconds: a float would lose some of those since 1970. ValueError: it is none."""
    try:
        time = float(text) if len(text) < 100 else math.nan
        if not abs(time) * unit_ns < MOST_NS:
            raise ValueError
        return int((Decimal(text.strip()) * unit_ns).to_integral_value())
    except (ValueError, InvalidOperation):
        raise ValueError(f"{text[:40]!r} is no time") from None


def heading_of(w: float, x: float, y: float, z: float) -> float:
    """The heading (rad) of a quaternion's turn about the vertical."""
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
