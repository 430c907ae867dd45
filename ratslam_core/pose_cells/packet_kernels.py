"""Compiled array functions of packets: which clusters form one packet, where packets are, how they move and keep their ids.

A packet is a row: x, y, theta, then the columns named below. Sets of active cells are those of `activity_kernels`.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core.pose_cells.activity_kernels import THETA, Cells, Shape, Slot, Values, X, Y, cluster, offset
from ratslam_core.types import Floats, Ints, Ints32

MASS, COS, SIN = 3, 4, 5  # columns after x, y, theta
ROW = 6


@njit(cache=True, nogil=True)
def find(
    cells: Cells, values: Values, n: int, slot: Slot, shape: Shape, window: int, owner: Ints32, peaks: Ints32,
    bounds: NDArray[np.int8], headings: Floats, old: Floats, old_ids: Ints, n_old: int, new: Floats, new_ids: Ints,
) -> tuple[int, int]:  # fmt: skip
    """The packets in the activity as it is, written to `new`, each with the id of the one that was expected there.

    Returns how many clusters and how many packets there are; when `new` has not as many rows as there are clusters,
    nothing is written, and there are -1 packets.
    """
    clusters, _ = cluster(cells, values, n, shape, window, 0, owner, peaks, bounds)
    if clusters > len(new):
        return clusters, -1
    join_flanks(cells, values, slot, shape, owner, peaks, clusters)
    found = packet_rows(cells, values, n, shape, owner, peaks, clusters, headings, new)
    follow(old, old_ids, n_old, new, new_ids, found, shape, window)
    return clusters, found


@njit(cache=True, nogil=True)
def join_flanks(
    cells: Cells, values: Values, slot: Slot, shape: Shape, owner: Ints32, peaks: Ints32, clusters: int
) -> None:
    """A cluster whose strongest cell has a stronger neighbour is a flank of that one's cluster: one packet. `slot` indexes P.

    peaks[c] becomes the strongest cell of the packet that cluster c belongs to.
    """
    n_theta, n_y, n_x = shape
    for c in range(1, clusters):
        peak = peaks[c]
        best = peak
        for t in range(cells[peak, THETA] - 1, cells[peak, THETA] + 2):
            for y in range(cells[peak, Y] - 1, cells[peak, Y] + 2):
                for x in range(cells[peak, X] - 1, cells[peak, X] + 2):
                    at = slot[((t % n_theta) * n_y + y % n_y) * n_x + x % n_x] - 1
                    if at >= 0 and values[at] > values[best]:
                        best = at
        if best != peak:
            peaks[c] = peaks[owner[best]]


@njit(cache=True, nogil=True)
def packet_rows(
    cells: Cells, values: Values, n: int, shape: Shape, owner: Ints32, peaks: Ints32, clusters: int, headings: Floats,
    out: Floats,
) -> int:  # fmt: skip
    """Write the packets, heaviest first; returns how many. Clusters with the same peak are one. `owner` then names packets.

    out rows: x, y, theta (cells, fractions), mass, mean cosine and sine of the headings.
    """
    n_theta, n_y, n_x = shape
    rank = np.empty(clusters, np.int64)
    found = 0
    for c in range(clusters):
        r = 0
        while r < found and peaks[r] != peaks[c]:
            r += 1
        peaks[r], rank[c] = peaks[c], r  # the first `found` of peaks are all different
        found = max(found, r + 1)
    sums = np.zeros((found, 6))
    for i in range(n):
        owner[i] = c = rank[owner[i]]
        peak = peaks[c]
        v = values[i]
        sums[c, X] += v * offset(cells[i, X], cells[peak, X], n_x)
        sums[c, Y] += v * offset(cells[i, Y], cells[peak, Y], n_y)
        sums[c, THETA] += v * offset(cells[i, THETA], cells[peak, THETA], n_theta)
        sums[c, MASS] += v
        sums[c, COS] += v * headings[cells[i, THETA], 0]
        sums[c, SIN] += v * headings[cells[i, THETA], 1]
    out[:found] = 0.0
    for r in range(found):
        c = 0
        for other in range(found):
            if sums[other, MASS] > sums[c, MASS]:
                c = other
        rank[c] = r
        mass = sums[c, MASS]
        for axis in range(3):
            out[r, axis] = (cells[peaks[c], axis] + sums[c, axis] / mass) % shape[2 - axis]
        out[r, MASS] = mass
        out[r, COS] = sums[c, COS] / mass
        out[r, SIN] = sums[c, SIN] / mass
        sums[c, MASS] = -1.0
    for i in range(n):
        owner[i] = rank[owner[i]]
    return found


@njit(cache=True, nogil=True)
def follow(
    old: Floats, old_ids: Ints, n_old: int, new: Floats, new_ids: Ints, n_new: int, shape: Shape, window: int
) -> None:
    """Give packets their ids: each old packet, heaviest first, goes on as the nearest new one. The others get the
    lowest numbers that no packet has. The number of one that has just gone is not used, or it would seem to live on
    elsewhere."""
    new_ids[:n_new] = 0
    for p in range(n_old):
        best, least = -1, np.inf
        for q in range(n_new):
            if new_ids[q] == 0:
                apart = 0.0
                for axis in range(3):
                    d = abs(offset(new[q, axis], old[p, axis], shape[2 - axis]))
                    apart = apart + d * d if d <= window else np.inf
                if apart < least:
                    best, least = q, apart
        if best >= 0:
            new_ids[best] = old_ids[p]
    free = 1
    for q in range(n_new):
        if new_ids[q] == 0:
            while free in old_ids[:n_old] or free in new_ids[:n_new]:
                free += 1
            new_ids[q] = free


@njit(cache=True, nogil=True)
def advance(rows: Floats, n: int, shape: Shape, distance: float, yaw: float) -> None:
    """Move the rows of packets to where `shift` takes their activity. distance: cells; yaw: layers."""
    for p in range(n):
        row = rows[p]
        row[X] = (row[X] + distance * row[COS]) % shape[2]
        row[Y] = (row[Y] + distance * row[SIN]) % shape[1]
        row[THETA] = (row[THETA] + yaw) % shape[0]
