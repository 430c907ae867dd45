"""Which cells of a grid are connected with given ones: rows are cut into runs of free cells, touching runs joined."""

from __future__ import annotations

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
