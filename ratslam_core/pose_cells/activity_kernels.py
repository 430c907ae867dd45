"""Compiled array functions of the pose cells. They touch active cells only, so a larger network costs no more time.

A set of active cells is (cells, values, n): in the first n rows of `cells` x, y, theta and the flat index
(theta * n_y + y) * n_x + x, in `values` their activities. `slot[flat]` is 1 + the row of an active cell, 0 for all others;
every function says which set it indexes. Coordinates are stored because integer division would be the largest cost.
"""

from __future__ import annotations

from typing import TypeAlias, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core.types import Floats, Ints32, Singles

X, Y, THETA, FLAT = 0, 1, 2, 3
PATCH = 32
Cells: TypeAlias = Ints32  # (room, 4)
Values: TypeAlias = Singles  # (room,)
Slot: TypeAlias = Ints32  # (n_theta * n_y * n_x,)
Shape: TypeAlias = tuple[int, int, int]  # n_theta, n_y, n_x
Number = TypeVar("Number", int, float)


@njit(cache=True, nogil=True, inline="always")
def add(x: int, y: int, t: int, flat: int, value: float, cells: Cells, values: Values, n: int, slot: Slot) -> int:
    """Add activity to one cell; returns the new number of active cells.

    Written without a branch: no processor can foresee whether a cell was active, and to guess wrong takes longer than
    all the rest.
    """
    at = slot[flat] - 1
    new = at < 0
    row = n if new else at
    before = values[row]
    values[row] = value if new else before + value
    cells[row, X], cells[row, Y], cells[row, THETA], cells[row, FLAT] = x, y, t, flat
    slot[flat] = row + 1
    return n + 1 if new else n


@njit(cache=True, nogil=True, inline="always")
def wrap(place: int, size: int) -> int:
    """A coordinate on a ring of this size; `place` is less than two turns."""
    return place - size if place >= size else place


@njit(cache=True, nogil=True, inline="always")
def offset(a: Number, b: Number, size: int) -> Number:
    """a - b on a ring of this size, the shorter way round."""
    d = a - b
    if 2 * d > size:
        return d - size
    if 2 * d < -size:
        return d + size
    return d


@njit(cache=True, nogil=True)
def index(cells: Cells, n: int, slot: Slot) -> None:
    """Make `slot` index this set; it must be clear before."""
    for i in range(n):
        slot[cells[i, FLAT]] = i + 1


@njit(cache=True, nogil=True)
def clear(cells: Cells, n: int, slot: Slot) -> None:
    for i in range(n):
        slot[cells[i, FLAT]] = 0


@njit(cache=True, nogil=True)
def first_bad(flats: Ints32, more: Singles, size: int) -> int:
    """The first row with a cell outside the network or an activity that is negative or not finite, -1 when all are right."""
    for i in range(flats.size):
        if not (0 <= flats[i] < size and 0.0 <= more[i] < np.inf):
            return i
    return -1


@njit(cache=True, nogil=True)
def inject(flats: Ints32, more: Singles, cells: Cells, values: Values, n: int, slot: Slot, shape: Shape) -> int:
    """P <- P + injection. A eq. 4. `slot` indexes P before and after."""
    n_y, n_x = shape[1], shape[2]
    for i in range(flats.size):
        row = flats[i] // n_x
        n = add(flats[i] - row * n_x, row % n_y, row // n_y, flats[i], more[i], cells, values, n, slot)
    return n


@njit(cache=True, nogil=True)
def shift(
    cells: Cells, values: Values, n: int, distance: float, yaw: float, headings: Floats, out_cells: Cells,
    out_values: Values, slot: Slot, shape: Shape, patch: Singles,
) -> int:  # fmt: skip
    """P'_xyz = sum over a 2x2x2 cube of alpha_abc P. A eqs. 5-9. `slot` indexes the input, afterwards the output.

    distance: how far each layer moves along its own heading, headings[t] = cos, sin (cells); yaw: the turn (layers). patch:
    scratch, PATCH x PATCH zeros. Successive cells of the same layer are summed up there first, so that each cell of the
    result is looked up twice rather than eight times.
    """
    n_theta, n_y, n_x = shape
    clear(cells, n, slot)
    middle = PATCH // 2
    whole_t = np.floor(yaw)
    ft = np.float32(yaw - whole_t)
    gt = np.float32(1.0) - ft
    m = 0
    i = 0
    while i < n:
        t = cells[i, THETA]
        dx, dy = distance * headings[t, 0], distance * headings[t, 1]
        whole_x, whole_y = np.floor(dx), np.floor(dy)
        fx, fy = np.float32(dx - whole_x), np.float32(dy - whole_y)
        gx, gy = np.float32(1.0) - fx, np.float32(1.0) - fy
        first_x, first_y = cells[i, X], cells[i, Y]
        low_x = low_y = middle
        high_x = high_y = middle
        while i < n and cells[i, THETA] == t:
            x = offset(cells[i, X], first_x, n_x) + middle
            y = offset(cells[i, Y], first_y, n_y) + middle
            if x < 0 or y < 0 or x > PATCH - 2 or y > PATCH - 2:
                break
            low_x, high_x, low_y, high_y = min(low_x, x), max(high_x, x), min(low_y, y), max(high_y, y)
            v0, v1 = values[i] * gx, values[i] * fx
            patch[y, x] += v0 * gy
            patch[y, x + 1] += v1 * gy
            patch[y + 1, x] += v0 * fy
            patch[y + 1, x + 1] += v1 * fy
            i += 1
        t0 = (t + int(whole_t)) % n_theta
        t1 = wrap(t0 + 1, n_theta)
        from_x = (first_x + int(whole_x) + low_x - middle) % n_x
        to_y = (first_y + int(whole_y) + low_y - middle) % n_y
        for y in range(low_y, high_y + 2):
            row0, row1 = (t0 * n_y + to_y) * n_x, (t1 * n_y + to_y) * n_x
            to_x = from_x
            for x in range(low_x, high_x + 2):
                v = patch[y, x]
                if v > 0.0:
                    patch[y, x] = 0.0
                    m = add(to_x, to_y, t0, row0 + to_x, v * gt, out_cells, out_values, m, slot)
                    if ft > 0.0:
                        m = add(to_x, to_y, t1, row1 + to_x, v * ft, out_cells, out_values, m, slot)
                to_x = wrap(to_x + 1, n_x)
            to_y = wrap(to_y + 1, n_y)
    return m


@njit(cache=True, nogil=True)
def cluster(
    cells: Cells, values: Values, n: int, shape: Shape, window: int, radius: int, owner: Ints32, peaks: Ints32,
    bounds: NDArray[np.int8],
) -> tuple[int, int]:  # fmt: skip
    """Divide the active cells into clusters: repeatedly, the strongest free cell and all free cells within `window` of it.

    Writes the cluster of each cell to `owner`, the row of each cluster's strongest cell to `peaks`, and how far the
    cluster reaches from there to `bounds`: lowest x, y, theta, highest x, y, theta. Returns the number of clusters, and
    how many cells their boxes have in all with a margin of `radius` on each side.
    """
    n_theta, n_y, n_x = shape
    wx, wy, wt = min(window, (n_x - 1) // 2), min(window, (n_y - 1) // 2), min(window, (n_theta - 1) // 2)
    owner[:n] = -1
    found = room = 0
    best = 0
    for i in range(n):
        if values[i] > values[best]:
            best = i
    while best >= 0:
        peak = best
        peaks[found] = peak
        px, py, pt = cells[peak, X], cells[peak, Y], cells[peak, THETA]
        low_x = low_y = low_t = high_x = high_y = high_t = 0
        best = -1
        most = np.float32(-1.0)  # the activity of a cell may be 0
        for i in range(n):
            if owner[i] >= 0:
                continue
            dy = offset(cells[i, Y], py, n_y)
            if abs(dy) <= wy:
                dx = offset(cells[i, X], px, n_x)
                if abs(dx) <= wx:
                    dt = offset(cells[i, THETA], pt, n_theta)
                    if abs(dt) <= wt:
                        owner[i] = found
                        low_x, low_y, low_t = min(low_x, dx), min(low_y, dy), min(low_t, dt)
                        high_x, high_y, high_t = max(high_x, dx), max(high_y, dy), max(high_t, dt)
                        continue
            if values[i] > most:
                best, most = i, values[i]
        for axis, bound in enumerate((low_x, low_y, low_t, high_x, high_y, high_t)):
            bounds[found, axis] = bound
        more = 1 + 2 * radius
        room += (high_x - low_x + more) * (high_y - low_y + more) * (high_t - low_t + more)
        found += 1
    return found, room
