"""Plateaus of the temporal map: cells from which two ways to the goal, in opposite directions, take the same time.

IROS 2005 V.D, point C: "it is possible for the goal memory movement vectors to be split evenly between taking the upper and
lower paths. The choice of the robot as to which path to take in this condition is arbitrary". It is the watershed of the
times: where they are highest along a loop, since times grow from the goal on both ways round until they meet. That
is a maximum, so the robot always leaves it, and no local minimum.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ratslam_core.goal_memory import GoalMemory


def lead_s(memory: GoalMemory, T: NDArray[np.float64], apart_m: float = 2.0) -> NDArray[np.float64]:
    """By how many seconds the quickest way from each cell leads over the quickest other way, shape (n_y, n_x).

    T: s, from `GoalMemory.times_to`. Near 0 is a plateau; inf where there is one way only. Another way begins with a link to
    a cell with a lower T, too, and comes at least `apart_m` away from the first. test_goal_plateau.py.
    """
    n_y, n_x = memory.shape[1:]
    if T.shape != (n_y, n_x):
        raise ValueError(f"T must have shape {(n_y, n_x)}, as times_to gives it, got {T.shape}")
    pairs, tau = memory.links
    t = T.ravel()
    here, there = np.concatenate([pairs, pairs[:, ::-1]]).T
    via = t[there] + np.concatenate([tau, tau])
    down = np.isfinite(via) & (t[there] < t[here])
    here, there, via = here[down], there[down], via[down]
    order = np.lexsort((via, here))
    cells, first = np.unique(here[order], return_index=True)
    following = np.full(t.size, -1)
    following[cells] = there[order][first]
    quickest = np.full(t.size, np.inf)
    quickest[cells] = via[order][first]
    lead = np.full(t.size, np.inf)
    ways: dict[int, NDArray[np.int64]] = {}
    for row in order:
        i, j = int(here[row]), int(there[row])
        if lead[i] == np.inf and j != following[i]:  # the quickest links come first
            best, other = (ways.setdefault(k, _way(k, following)) for k in (int(following[i]), j))
            if memory.cell_m * _parting(best, other, n_x, n_y) >= apart_m:
                lead[i] = via[row] - quickest[i]
    return lead.reshape(n_y, n_x)


def _way(cell: int, following: NDArray[np.int64]) -> NDArray[np.int64]:
    """The cells from this one to the goal."""
    way = [cell]
    while following[way[-1]] >= 0:
        way.append(int(following[way[-1]]))
    return np.array(way)


def _parting(a: NDArray[np.int64], b: NDArray[np.int64], n_x: int, n_y: int) -> float:
    """The largest distance (cells) of a cell of either way from the other way."""
    dx, dy = _offset(a[:, None] % n_x, b[None] % n_x, n_x), _offset(a[:, None] // n_x, b[None] // n_x, n_y)
    apart = np.hypot(dx, dy)
    return float(max(apart.min(0).max(), apart.min(1).max()))


def _offset(a: NDArray[np.int64], b: NDArray[np.int64], size: int) -> NDArray[np.float64]:
    """Cells from a to b, the shorter way round."""
    return ((b - a + size / 2) % size - size / 2).astype(np.float64)
