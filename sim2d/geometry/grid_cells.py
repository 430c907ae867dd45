"""Which cells of a grid are connected with given ones: rows are cut into runs of free cells, touching runs joined.

Marking what lies within some metres of driving from given cells of a grid, in the window that they can reach.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def connected(free: NDArray[np.bool_], seeds: NDArray[np.int64]) -> NDArray[np.bool_]:
    """All free cells that are connected, across edges or corners, with one of `seeds`, (n, 2) rows and columns."""
    n_y, n_x = free.shape
    most = n_y * (n_x // 2 + 1)
    begin, end = np.empty(most, np.int32), np.empty(most, np.int32)  # run k of a row: columns begin to end - 1
    parent = np.empty(most, np.int32)
    first = np.zeros(n_y + 1, np.int64)  # the first run of each row
    n = 0
    for j in range(n_y):
        row = free[j]
        above = first[j - 1] if j > 0 else 0
        i = 0
        while i < n_x:
            if not row[i]:
                i += 1
                continue
            begin[n] = i
            while i < n_x and row[i]:
                i += 1
            end[n] = i
            parent[n] = n
            while above < first[j] and end[above] < begin[n]:
                above += 1
            k = above
            while k < first[j] and begin[k] <= end[n]:
                a, b = _root(parent, k), _root(parent, n)
                parent[max(a, b)] = min(a, b)
                k += 1
            n += 1
        first[j + 1] = n
    wanted = _chosen(seeds, first, begin, end, parent, n)
    out = np.zeros((n_y, n_x), np.bool_)
    for j in range(n_y):
        for k in range(first[j], first[j + 1]):
            if wanted[_root(parent, k)]:
                out[j, begin[k] : end[k]] = True
    return out


@njit(cache=True, nogil=True)
def _chosen(
    seeds: NDArray[np.int64],
    first: NDArray[np.int64],
    begin: NDArray[np.int32],
    end: NDArray[np.int32],
    parent: NDArray[np.int32],
    n: int,
) -> NDArray[np.bool_]:
    """Which of the n runs are roots of a part that contains a seed."""
    wanted = np.zeros(n, np.bool_)
    for s in range(seeds.shape[0]):
        for k in range(first[seeds[s, 0]], first[seeds[s, 0] + 1]):
            if begin[k] <= seeds[s, 1] < end[k]:
                wanted[_root(parent, k)] = True
    return wanted


@njit(cache=True, nogil=True, inline="always")
def _root(parent: NDArray[np.int32], k: int) -> int:
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


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
