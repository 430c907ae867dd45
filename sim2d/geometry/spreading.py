"""Marking what lies within some metres of driving from given cells of a grid, in the window that they can reach."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def spread(
    free: NDArray[np.bool_], marked: NDArray[np.bool_], seeds: NDArray[np.int64], reach: float, moves: NDArray[np.int64]
) -> int:
    """Mark the free cells that are within `reach` (cells) of one of `seeds`; how many were not marked before.

    free, marked: (n_y, n_x); seeds: (n, 2) rows and columns, those that are not free count for nothing; moves: (k, 2)
    rows and columns, from free cell to free cell, both ways. The work is that of the seeds' bounding box.
    """
    r = math.ceil(reach)
    low_y, low_x = max(seeds[:, 0].min() - r, 0), max(seeds[:, 1].min() - r, 0)
    n_y, n_x = (
        min(seeds[:, 0].max() + r + 1, free.shape[0]) - low_y,
        min(seeds[:, 1].max() + r + 1, free.shape[1]) - low_x,
    )
    away = np.full((n_y, n_x), np.inf)
    queue, queued = np.empty((n_y * n_x, 2), np.int64), np.zeros((n_y, n_x), np.bool_)
    head, waiting = 0, 0
    for s in range(seeds.shape[0]):
        y, x = seeds[s, 0] - low_y, seeds[s, 1] - low_x
        if 0 <= y < n_y and 0 <= x < n_x and free[seeds[s, 0], seeds[s, 1]] and not queued[y, x]:
            away[y, x], queued[y, x] = 0.0, True
            queue[waiting, 0], queue[waiting, 1] = y, x
            waiting += 1
    while waiting > 0:
        y, x = queue[head, 0], queue[head, 1]
        head, waiting, queued[y, x] = (head + 1) % queue.shape[0], waiting - 1, False
        for m in range(moves.shape[0]):
            j, i = y + moves[m, 0], x + moves[m, 1]
            if 0 <= j < n_y and 0 <= i < n_x and free[low_y + j, low_x + i]:
                there = away[y, x] + math.hypot(moves[m, 0], moves[m, 1])
                if there <= reach and there < away[j, i]:
                    away[j, i] = there
                    if not queued[j, i]:
                        end = (head + waiting) % queue.shape[0]
                        queue[end, 0], queue[end, 1], queued[j, i] = j, i, True
                        waiting += 1
    new = 0
    for y in range(n_y):
        for x in range(n_x):
            if away[y, x] <= reach and not marked[low_y + y, low_x + x]:
                marked[low_y + y, low_x + x] = True
                new += 1
    return new
