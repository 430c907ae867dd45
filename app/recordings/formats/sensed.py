"""What a recording's line or message tells, before moments are made of it; and what is wrong with it, in sentences: the first
ones of each kind, and how many more there are. How much of each source was read is counted where it comes in and again
where it is used.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation

import numpy as np
from numpy.typing import NDArray

from app.recordings.recording import Count, Pose
from disk.words import plain

MOST_NS = 10**20  # some three thousand years

Picture = Callable[[], NDArray[np.uint8]]  # unpacks it when it is needed; ValueError says what is wrong with it


@dataclass(frozen=True, slots=True)
class Beams:
    """Of a laser or of sonars: angles from straight ahead (rad, left positive), and how far it sees (m)."""

    angles_rad: tuple[float, ...] = ()
    limit_m: float | None = None


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
    beams: Beams | None = None  # those of the ranges
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


TOLD = 10  # sentences of one kind


class Problems:
    """Collects sentences. The same one counts once, so that a recording may be read more than once."""

    def __init__(self) -> None:
        self._told: dict[str, dict[str, None]] = {}
        self._more: dict[str, int] = {}
        self._there: dict[str, int] = {}
        self._read: dict[str, int] = {}

    def seen(self, source: str) -> None:
        """One more message, line or picture of this source has come, whatever becomes of it."""
        self._there[source] = self._there.get(source, 0) + 1

    def read(self, source: str) -> None:
        """One of them is used."""
        self._read[source] = self._read.get(source, 0) + 1

    @property
    def counts(self) -> tuple[Count, ...]:
        """Of every source of which something has come."""
        return tuple(Count(source, self._read.get(source, 0), there) for source, there in self._there.items())

    def add(self, kind: str, where: str, what: str) -> None:
        """kind: of which the first few are told; where: the message, line or file; what: is wrong with it."""
        sentence = f"{where}: {plain(what)}"
        told = self._told.setdefault(kind, {})
        if len(told) < TOLD:
            told[sentence] = None
        elif sentence not in told:
            self._more[kind] = self._more.get(kind, 0) + 1

    def begin(self) -> None:
        """The recording is read from its beginning again: what was only counted is counted anew."""
        self._more.clear()
        self._there.clear()
        self._read.clear()

    def __bool__(self) -> bool:
        return bool(self._told)

    @property
    def sentences(self) -> tuple[str, ...]:
        lines = [sentence for told in self._told.values() for sentence in told]
        return (*lines, *(f"and {count} more: {kind}" for kind, count in self._more.items()))
