"""What spoke for the place that a robot believes, and what against it, observation by observation, for people to see."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from ratslam_core import ExperienceMap, Pose2
from ratslam_core.extensions.evidence import HEADING, ODDS, X, Y

MOST_TICKS = 1800  # that are looked back on
SAME_M, SAME_RAD = 0.5, 0.4  # in a tick no hypothesis goes farther
BARS = 24


class SpokenFor:
    """Call `watch` after each tick."""

    def __init__(self) -> None:
        self._kept: deque[tuple[float, NDArray[np.float64]]] = deque(maxlen=MOST_TICKS)

    def watch(self, time_s: float, map_: ExperienceMap) -> None:
        """Keep the hypotheses of this tick; none once the map is one again, so that the next time begins anew."""
        if map_.carried:
            self._kept.append((time_s, map_.evidence.hypotheses[:, [X, Y, HEADING, ODDS]].copy()))
        else:
            self._kept.clear()

    def of(self, place: Pose2) -> list[tuple[float, float]]:
        """Since when this place was a hypothesis, and what was said of it then: (s, nats), at most BARS of them.

        The first is what it began with. Positive speaks for it.
        """
        at, odds = np.array([place.x, place.y, place.heading_rad]), list[tuple[float, float]]()
        for time_s, rows in reversed(self._kept):
            off = np.hypot(rows[:, 0] - at[0], rows[:, 1] - at[1])
            turn = np.abs(np.remainder(rows[:, 2] - at[2] + math.pi, 2 * math.pi) - math.pi)
            near = np.flatnonzero((off < SAME_M) & (turn < SAME_RAD))
            if not len(near):
                break
            row = rows[near[np.argmin(off[near])]]
            at = row[:3]
            odds.append((time_s, float(row[3])))
        return _said(odds[::-1])


def _said(odds: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Log odds over time as changes, in so many parts."""
    ends = [odds[(k + 1) * len(odds) // min(BARS, len(odds)) - 1] for k in range(min(BARS, len(odds)))]
    before = [0.0, *(value for _, value in ends)]
    return [(time_s, value - old) for (time_s, value), old in zip(ends, before, strict=False)]
