"""Compiled array functions of packets: which clusters form one packet, where packets are, how they move and keep their ids.

A packet is a row: x, y, theta, then the columns named below. Sets of active cells are those of `activity_kernels`.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core.pose_cells.activity_kernels import THETA, Cells, Shape, Slot, Values, X, Y, cluster, offset

MASS, COS, SIN, CARRY = 3, 4, 5, 6  # columns after x, y, theta; CARRY is three columns
ROW = 9
LEAST_AGREEMENT = 0.25  # of headings, 1 = all the same


@njit(cache=True, nogil=True)
def find(
    cells: Cells,
    values: Values,
    n: int,
    slot: Slot,
    shape: Shape,
    window: int,
    owner: NDArray[np.int32],
    peaks: NDArray[np.int32],
    bounds: NDArray[np.int8],
    headings: NDArray[np.float64],
    old: NDArray[np.float64],
    old_ids: NDArray[np.int64],
    n_old: int,
    new: NDArray[np.float64],
    new_ids: NDArray[np.int64],
    carry: bool,
) -> tuple[int, int]:
    """The packets in the activity as it is, written to `new`, each with the id of the one that was expected there.

    carry: the attractor has just moved them, and what it moved is subtracted from their carry. Returns how many clusters
    and how many packets there are; when `new` has not as many rows as there are clusters, nothing is written, and there
    are -1 packets.
    """
    clusters, _ = cluster(cells, values, n, shape, window, 0, owner, peaks, bounds)
    if clusters > len(new):
        return clusters, -1
    if carry:
        weigh(cells, values, n, shape, 2 * window, old, n_old, -1.0)
    join_flanks(cells, values, slot, shape, owner, peaks, clusters)
    found = packet_rows(cells, values, n, shape, owner, peaks, clusters, headings, new)
    follow(old, old_ids, n_old, new, new_ids, found, shape, window)
    return clusters, found


@njit(cache=True, nogil=True)
def join_flanks(
    cells: Cells,
    values: Values,
    slot: Slot,
    shape: Shape,
    owner: NDArray[np.int32],
    peaks: NDArray[np.int32],
    clusters: int,
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
    cells: Cells,
    values: Values,
    n: int,
    shape: Shape,
    owner: NDArray[np.int32],
    peaks: NDArray[np.int32],
    clusters: int,
    headings: NDArray[np.float64],
    out: NDArray[np.float64],
) -> int:
    """Write the packets, heaviest first; returns how many. Clusters with the same peak are one. `owner` then names packets.

    out rows: x, y, theta (cells, fractions), mass, mean cosine and sine of the headings; the carry is cleared.
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
def _among(number: int, ids: NDArray[np.int64], n: int) -> bool:
    for p in range(n):  # noqa: SIM110
        if ids[p] == number:
            return True
    return False


@njit(cache=True, nogil=True)
def follow(
    old: NDArray[np.float64],
    old_ids: NDArray[np.int64],
    n_old: int,
    new: NDArray[np.float64],
    new_ids: NDArray[np.int64],
    n_new: int,
    shape: Shape,
    window: int,
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
            for k in range(CARRY, new.shape[1]):
                new[best, k] = old[p, k]
    free = 1
    for q in range(n_new):
        if new_ids[q] == 0:
            while _among(free, old_ids, n_old) or _among(free, new_ids, n_new):
                free += 1
            new_ids[q] = free


@njit(cache=True, nogil=True)
def advance(
    rows: NDArray[np.float64],
    n: int,
    shape: Shape,
    distance: float,
    turn: float,
    exact: bool,
    moves: NDArray[np.float64],
    yaws: NDArray[np.float64],
) -> None:
    """Move the rows of packets on, and write what `shift` needs to moves and yaws. distance: cells; turn: rad.

    exact: the robot drives an arc, whose chord points along the heading in its middle; and the layers of a packet have
    different headings, which multiplies its movement by the mean of exp(i theta), so that it is divided by that complex
    number, whose modulus counts as at least LEAST_AGREEMENT. Else straight on, as in the papers.
    """
    unit = 2.0 * np.pi / shape[0]
    bend = turn / 2 if exact else 0.0
    chord = distance * np.sin(bend) / bend if bend != 0.0 else distance
    for p in range(n):
        row = rows[p]
        heading = unit * (row[THETA] + row[CARRY + 2]) + bend
        to_x, to_y = chord * np.cos(heading), chord * np.sin(heading)
        if exact:
            agreement = max(row[COS] ** 2 + row[SIN] ** 2, LEAST_AGREEMENT**2)
            moves[p, 0] = (to_x * row[COS] + to_y * row[SIN]) / agreement
            moves[p, 1] = (to_y * row[COS] - to_x * row[SIN]) / agreement
        else:
            moves[p, 0], moves[p, 1] = distance, 0.0
            to_x = moves[p, 0] * row[COS] - moves[p, 1] * row[SIN]
            to_y = moves[p, 0] * row[SIN] + moves[p, 1] * row[COS]
        moves[p, 2], moves[p, 3] = row[CARRY], row[CARRY + 1]
        yaws[p] = turn / unit + row[CARRY + 2]
        row[X] = (row[X] + to_x + row[CARRY]) % shape[2]
        row[Y] = (row[Y] + to_y + row[CARRY + 1]) % shape[1]
        row[THETA] = (row[THETA] + yaws[p]) % shape[0]
        row[CARRY:] = 0.0


@njit(cache=True, nogil=True)
def _half_way_to_the_next(rows: NDArray[np.float64], packets: int, shape: Shape) -> NDArray[np.float64]:
    """Squares of half the distance from each packet to the nearest other; a cell within that has no nearer packet."""
    own = np.full(packets, np.inf)
    for p in range(packets):
        for q in range(p):
            apart = 0.0
            for axis in range(3):
                apart += offset(rows[p, axis], rows[q, axis], shape[2 - axis]) ** 2
            own[p], own[q] = min(own[p], apart / 4), min(own[q], apart / 4)
    return own


@njit(cache=True, nogil=True)
def weigh(
    cells: Cells, values: Values, n: int, shape: Shape, reach: int, rows: NDArray[np.float64], packets: int, sign: float
) -> None:
    """Add sign times each packet's centre, as the offset from the place in its row, to the row's carry.

    A cell counts for the nearest packet that is within `reach` along each axis. So the same part of the torus counts
    before and after the attractor, however packets grow and shrink.
    """
    n_theta, n_y, n_x = shape
    wx, wy, wt = min(reach, (n_x - 1) // 2), min(reach, (n_y - 1) // 2), min(reach, (n_theta - 1) // 2)
    sums = np.zeros((packets, 4))
    own = _half_way_to_the_next(rows, packets, shape)
    before = 0
    for i in range(n):
        mine, least = -1, np.inf
        x = y = t = 0.0
        for k in range(packets):
            p = (before + k) % packets  # the nearest is most often that of the cell before
            dx = offset(cells[i, X], rows[p, X], n_x)
            dy = offset(cells[i, Y], rows[p, Y], n_y)
            dt = offset(cells[i, THETA], rows[p, THETA], n_theta)
            apart = dx * dx + dy * dy + dt * dt
            if apart < least and abs(dx) <= wx and abs(dy) <= wy and abs(dt) <= wt:
                mine, least = p, apart
                x, y, t = dx, dy, dt
                if apart < own[p]:
                    break
        if mine >= 0:
            before = mine
            v = values[i]
            sums[mine, X] += v * x
            sums[mine, Y] += v * y
            sums[mine, THETA] += v * t
            sums[mine, MASS] += v
    for p in range(packets):
        for axis in range(3):
            if sums[p, MASS] > 0.0:
                rows[p, CARRY + axis] += sign * sums[p, axis] / sums[p, MASS]
