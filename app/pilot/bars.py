"""[ours] Bars: short lines in the map that the robot could not cross, by which routes are delayed for a while.

ACRA 2006 3.4 counts a failed trial against the links, and deletes them in the end. A door that is shut, a person, or a
desk corner that the map has half a metre beside its place would so cut a way for good. A bar only makes it slower to
take: it is about as wide as the robot, fades, and grows when the robot fails there again. Then it lasts twice
as long, or a robot between two dead ends would try each again as soon as it has failed at the other.
test_bars.py::{test_a_bar_delays_what_crosses_it_and_fades, test_failing_again_at_a_bar_makes_it_last_longer}.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from app.pilot.params import PilotParams
from disk import kind
from ratslam_core import Pose2

BAR_AHEAD_M = 0.4  # how far ahead of the robot a bar lies
BAR_M, WIDEST_BAR_M = 0.6, 1.4  # its width; each time the robot fails there again, as much wider, up to this
LONGEST_BAR_S = 3600.0  # longest time in which a bar fades: a door may have been opened since
BAR_DELAY_S = 30.0  # of each way across a new bar, times how often the robot failed there

_Array = NDArray[np.float64]


@kind("bar/1")
@dataclass(slots=True)
class Bar:
    """ends: (2, 2), m, map frame. left_s of lasts_s: until it has faded; it stays if `lasts_s` is 0. failures: how
    often the robot failed here."""

    ends: _Array
    left_s: float
    lasts_s: float
    failures: int

    @property
    def strength(self) -> float:
        """Failures, of which less and less is left as the bar fades."""
        return self.failures * (self.left_s / self.lasts_s if self.lasts_s else 1.0)


@kind("bars/1")
class Bars:
    """All bars that have not faded yet."""

    def __init__(self) -> None:
        self._bars: list[Bar] = []

    def __len__(self) -> int:
        return len(self._bars)

    def forget(self) -> None:
        """None is left."""
        self._bars = []

    @property
    def failures(self) -> float:
        """How often the robot failed of late; a failure counts less as its bar fades."""
        return sum(bar.strength for bar in self._bars)

    def fade(self, dt: float) -> None:
        for bar in self._bars:
            bar.left_s -= dt
        if any(bar.left_s <= 0 < bar.lasts_s for bar in self._bars):
            self._bars = [bar for bar in self._bars if bar.left_s > 0 or not bar.lasts_s]

    def add(self, robot: Pose2, bearing: float, p: PilotParams) -> None:
        """The robot could not get on in this direction (rad, robot's frame)."""
        ends = bar_ahead(robot, bearing, BAR_M)
        middle = ends.mean(axis=0)
        for old in self._bars:
            if math.hypot(*(old.ends.mean(axis=0) - middle)) < BAR_M:
                failures = old.failures + 1
                old.ends = bar_ahead(robot, bearing, min(failures * BAR_M, WIDEST_BAR_M))
                old.failures, old.lasts_s = failures, min(2 * old.lasts_s, LONGEST_BAR_S)
                old.left_s = old.lasts_s
                return
        self._bars.append(Bar(ends, p.bar_fade_s, p.bar_fade_s, 1))

    def delays(self, ends: NDArray[np.int64], places: _Array) -> _Array | None:
        """Seconds, (m,), by which the bars delay links between experiences `ends` (m, 2) at `places` (n, >= 2).

        None without a bar.
        """
        if not self._bars:
            return None
        out = np.zeros(len(ends))
        for bar in self._bars:
            _delay(out, ends, places, bar.ends, BAR_DELAY_S * bar.strength)
        return out

    def between(self, x: float, y: float, places: _Array) -> NDArray[np.bool_]:
        """Which of the places (n, 2) lie behind a bar, seen from (x, y)."""
        behind = np.zeros(len(places), np.bool_)
        for bar in self._bars:
            behind |= crosses(bar.ends, np.array([[x, y]]), places)
        return behind


def bar_ahead(robot: Pose2, bearing: float, width: float) -> _Array:
    """The two ends (2, 2), map frame, of a bar that lies across the way in this direction (rad, robot's frame)."""
    ahead = robot.compose(Pose2(0.0, 0.0, bearing)).compose(Pose2(BAR_AHEAD_M, 0.0, 0.0))
    left, right = (ahead.compose(Pose2(0.0, side * width / 2, 0.0)) for side in (1, -1))
    return np.array([(left.x, left.y), (right.x, right.y)])


def crosses(bar: _Array, a: _Array, b: _Array) -> NDArray[np.bool_]:
    """Which of the segments from a to b, (n, 2) each, cross the bar, (2, 2)."""

    def side(start: _Array, end: _Array, point: _Array) -> _Array:
        along, to = end - start, point - start
        return along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0]

    apart = side(bar[0], bar[1], a) * side(bar[0], bar[1], b) < 0
    return apart & (side(a, b, bar[0]) * side(a, b, bar[1]) < 0)


@njit(cache=True, nogil=True)
def _delay(out: _Array, ends: NDArray[np.int64], places: _Array, bar: _Array, seconds: float) -> None:
    """Add the seconds to each link that crosses the bar. The same as `crosses`, without arrays in between."""
    bx, by = bar[0, 0], bar[0, 1]
    ux, uy = bar[1, 0] - bx, bar[1, 1] - by
    for row in range(len(ends)):
        ax, ay = places[ends[row, 0], 0] - bx, places[ends[row, 0], 1] - by
        cx, cy = places[ends[row, 1], 0] - bx, places[ends[row, 1], 1] - by
        if (ux * ay - uy * ax) * (ux * cy - uy * cx) < 0:
            vx, vy = cx - ax, cy - ay
            if (vy * ax - vx * ay) * (vx * (uy - ay) - vy * (ux - ax)) < 0:
                out[row] += seconds
