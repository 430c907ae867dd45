"""The robot's way through the made-up office."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from web.messages import Pose

from .office import DESKS, PARTITIONS

STEP_M = 0.03  # the robot's way in a tick
_STOPS = [(0.8, 0.8), (5.0, 0.8), (9.1, 0.8), (0.8, 4.1), (4.9, 3.9), (9.1, 4.2), (0.8, 7.2), (5.0, 7.2), (9.1, 7.2)]
_STOPS += [(2.4, 4.2), (8.6, 1.6), (7.3, 4.2), (5.2, 5.6), (2.5, 1.0), (3.0, 7.1)]


@lru_cache(maxsize=1)
def long_walk() -> NDArray[np.float64]:
    """A long walk between stops in sight of each other, (n, 2): a point every 5 cm, with rounded corners."""
    rng = np.random.default_rng(7)
    stops = np.array(_STOPS)
    sees = [[j for j in range(len(stops)) if j != i and _clear(stops[i], stops[j])] for i in range(len(stops))]
    here, before, chain = 4, -1, [stops[4]]
    visits = np.zeros(len(stops))
    for _ in range(190):
        choices = [j for j in sees[here] if j != before] or sees[here]
        before, here = here, min(choices, key=lambda j: visits[j] + rng.uniform(0, 1.5))
        visits[here] += 1
        chain.append(stops[here] + rng.normal(0, 0.12, 2))
    corners = np.array(chain)
    arc = np.r_[0, np.cumsum(np.hypot(*np.diff(corners, axis=0).T))]
    fine = np.arange(0, arc[-1], 0.05)
    way = np.column_stack([np.interp(fine, arc, corners[:, k]) for k in (0, 1)])
    window = np.hanning(19)
    padded = np.pad(way, ((9, 9), (0, 0)), mode="edge")
    return np.column_stack([np.convolve(padded[:, k], window / window.sum(), "valid") for k in (0, 1)])


def _clear(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    if math.dist(a, b) > 5.5:
        return False
    for t in np.linspace(0, 1, 40):
        x, y = a + t * (b - a)
        for x1, y1, x2, y2 in DESKS + PARTITIONS:
            if x1 - 0.35 < x < x2 + 0.35 and y1 - 0.35 < y < y2 + 0.35:
                return False
    return True


def positions(ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    way = long_walk()
    arc = (ticks * STEP_M / 0.05) % (len(way) - 2)
    low = arc.astype(int)
    return way[low] + (arc - low)[:, None] * (way[low + 1] - way[low])


def truth_at(tick: int) -> Pose:
    here, ahead = positions(np.array([tick, tick + 3]))
    return Pose(float(here[0]), float(here[1]), math.atan2(ahead[1] - here[1], ahead[0] - here[0]))
