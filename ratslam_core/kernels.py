"""Compiled array functions of the pose cells. They touch active cells only, so that size costs nothing.

A set of active cells is (cells, values, n): in the first n rows of `cells` x, y, theta and the flat index
(theta * n_y + y) * n_x + x, in `values` their activities. `slot[flat]` is 1 + the row of an active cell, 0 for all others;
every function says which set it indexes. Coordinates are kept because integer division is what would cost most.
"""

from __future__ import annotations

import numpy as np
from numba import njit

X, Y, THETA, FLAT = 0, 1, 2, 3
PATCH = 32


@njit(cache=True, nogil=True, inline="always")
def _add(x, y, t, flat, value, cells, values, n, slot):
    """Add activity to one cell; returns the new number of active cells."""
    at = slot[flat]
    if at == 0:
        cells[n, X] = x
        cells[n, Y] = y
        cells[n, THETA] = t
        cells[n, FLAT] = flat
        values[n] = value
        slot[flat] = n + 1
        return n + 1
    values[at - 1] += value
    return n


@njit(cache=True, nogil=True, inline="always")
def _wrap(place, size):
    """A place on a ring of this size, from less than one turn beyond."""
    return place - size if place >= size else place


@njit(cache=True, nogil=True, inline="always")
def offset(a, b, size):
    """a - b on a ring of this size, the shorter way round."""
    d = a - b
    if 2 * d > size:
        return d - size
    if 2 * d < -size:
        return d + size
    return d


@njit(cache=True, nogil=True)
def index(cells, n, slot):
    """Make `slot` index this set; it must be clear before."""
    for i in range(n):
        slot[cells[i, FLAT]] = i + 1


@njit(cache=True, nogil=True)
def clear(cells, n, slot):
    for i in range(n):
        slot[cells[i, FLAT]] = 0


@njit(cache=True, nogil=True)
def first_bad(flats, more, size):
    """The first row with a cell outside the network or an activity that is none, -1 when all are right."""
    for i in range(flats.size):
        if not (0 <= flats[i] < size and 0.0 <= more[i] < np.inf):
            return i
    return -1


@njit(cache=True, nogil=True)
def inject(flats, more, cells, values, n, owner, slot, shape):
    """P <- P + injection. A eq. 4. New cells move with the winner. `slot` indexes P before and after."""
    n_y, n_x = shape[1], shape[2]
    before = n
    for i in range(flats.size):
        row = flats[i] // n_x
        n = _add(flats[i] - row * n_x, row % n_y, row // n_y, flats[i], more[i], cells, values, n, slot)
    owner[before:n] = 0
    return n


@njit(cache=True, nogil=True)
def shift(
    cells, values, n, owner, moves, yaws, headings, out_cells, out_values, out_owner, slot, shape, patch
):  # fmt: skip
    """P'_xyz = sum over a 2x2x2 cube of alpha_abc P. A eqs. 5-9. `slot` indexes the input, afterwards the output.

    owner: the packet of each cell; moves, shape (packets, 4): the packet's way forwards and to its left (cells, each layer
    along its own heading, headings[t] = cos, sin), and what is added to x and y of all its layers; yaws: layers.
    patch: scratch, PATCH x PATCH zeros. Rows of cells in the same layer are laid out there first, so that each cell of the
    result is looked up twice rather than eight times.
    """
    n_theta, n_y, n_x = shape
    clear(cells, n, slot)
    middle = PATCH // 2
    m = 0
    i = 0
    while i < n:
        t, p = cells[i, THETA], owner[i]
        cos, sin = headings[t, 0], headings[t, 1]
        dx = moves[p, 0] * cos - moves[p, 1] * sin + moves[p, 2]
        dy = moves[p, 0] * sin + moves[p, 1] * cos + moves[p, 3]
        whole_x, whole_y, whole_t = np.floor(dx), np.floor(dy), np.floor(yaws[p])
        fx, fy, ft = np.float32(dx - whole_x), np.float32(dy - whole_y), np.float32(yaws[p] - whole_t)
        gx, gy, gt = np.float32(1.0) - fx, np.float32(1.0) - fy, np.float32(1.0) - ft
        first_x, first_y = cells[i, X], cells[i, Y]
        low_x = low_y = middle
        high_x = high_y = middle
        while i < n and cells[i, THETA] == t and owner[i] == p:
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
        t1 = _wrap(t0 + 1, n_theta)
        from_x = (first_x + int(whole_x) + low_x - middle) % n_x
        to_y = (first_y + int(whole_y) + low_y - middle) % n_y
        began = m
        for y in range(low_y, high_y + 2):
            row0, row1 = (t0 * n_y + to_y) * n_x, (t1 * n_y + to_y) * n_x
            to_x = from_x
            for x in range(low_x, high_x + 2):
                v = patch[y, x]
                if v > 0.0:
                    patch[y, x] = 0.0
                    m = _add(to_x, to_y, t0, row0 + to_x, v * gt, out_cells, out_values, m, slot)
                    if ft > 0.0:
                        m = _add(to_x, to_y, t1, row1 + to_x, v * ft, out_cells, out_values, m, slot)
                to_x = _wrap(to_x + 1, n_x)
            to_y = _wrap(to_y + 1, n_y)
        out_owner[began:m] = p
    return m


@njit(cache=True, nogil=True)
def cluster(cells, values, n, shape, window, radius, owner, peaks, bounds):
    """Give every active cell to a cluster: the strongest free cell and all free cells within `window` of it, again and again.

    Writes the cluster of each cell to `owner`, the row of each cluster's strongest cell to `peaks`, and how far the cluster
    reaches from there to `bounds`: lowest x, y, theta, highest x, y, theta. Returns the number of clusters and the cells of
    all their boxes with `radius` more on each side.
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
        most = np.float32(-1.0)  # cells may hold nothing
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


@njit(cache=True, nogil=True)
def convolve(
    cells, values, n, owner, peaks, bounds, clusters, out_cells, out_values, slot, shape, weights, floor, box_a, box_b
):  # fmt: skip
    """P <- eps * P: circular convolution with a 3-D Gaussian as three 1-D passes. A eq. 10.

    `owner`, `peaks`, `bounds` split the active cells into clusters that fit a small dense box each; the boxes' results add up,
    since convolution is linear. Cells up to `floor` are left out where no other box can add to them: inhibition would take
    them at once. `slot` indexes the input, afterwards the output. box_a, box_b: scratch.
    """
    n_theta, n_y, n_x = shape
    clear(cells, n, slot)
    taps = weights.size
    radius = taps // 2
    m = 0
    for c in range(clusters):
        px, py, pt = cells[peaks[c], X], cells[peaks[c], Y], cells[peaks[c], THETA]
        low_x, low_y, low_t = int(bounds[c, 0]) - radius, int(bounds[c, 1]) - radius, int(bounds[c, 2]) - radius
        bx, by, bt = (
            int(bounds[c, 3]) - low_x + 1 + radius,
            int(bounds[c, 4]) - low_y + 1 + radius,
            int(bounds[c, 5]) - low_t + 1 + radius,
        )
        layer = by * bx
        size = bt * layer
        box_a[:size] = 0.0
        for i in range(n):
            if owner[i] == c:
                dx = offset(cells[i, X], px, n_x) - low_x
                dy = offset(cells[i, Y], py, n_y) - low_y
                dt = offset(cells[i, THETA], pt, n_theta) - low_t
                box_a[(dt * by + dy) * bx + dx] = values[i]
        # The margin of zeros lets each pass run over the box as one long row.
        inner = radius * layer, size - radius * layer
        _pass(box_a, box_b, size, inner, 1, weights)
        _pass(box_b, box_a, size, inner, bx, weights)
        _pass(box_a, box_b, size, inner, layer, weights)
        alone = bx <= n_x and by <= n_y and bt <= n_theta
        least = np.float32(floor if alone and _apart(c, clusters, cells, peaks, bounds, radius, shape) else 0.0)
        first_x, to_y, to_t = (px + low_x) % n_x, (py + low_y) % n_y, (pt + low_t) % n_theta
        at = 0
        for _t in range(bt):
            for _y in range(by):
                row = (to_t * n_y + to_y) * n_x
                to_x = first_x
                for _x in range(bx):
                    if box_b[at] > least:
                        m = _add(to_x, to_y, to_t, row + to_x, box_b[at], out_cells, out_values, m, slot)
                    at += 1
                    to_x = _wrap(to_x + 1, n_x)
                to_y = _wrap(to_y + 1, n_y)
            to_y = (py + low_y) % n_y
            to_t = _wrap(to_t + 1, n_theta)
    return m


@njit(cache=True, nogil=True)
def _pass(source, target, size, inner, stride, weights):
    """1-D convolution of the cells from inner[0] to inner[1] along the axis of this stride."""
    radius = weights.size // 2
    target[:size] = 0.0
    fro = source[inner[0] : inner[1]]
    for k in range(weights.size):
        weight = weights[k]
        to = target[inner[0] + (k - radius) * stride :]
        for i in range(fro.size):
            to[i] += weight * fro[i]


@njit(cache=True, nogil=True)
def _apart(c, clusters, cells, peaks, bounds, radius, shape):
    """No other cluster's box, with its margin, shares a cell with that of cluster c."""
    for other in range(clusters):
        touching = other != c
        for axis in range(3):
            size = shape[2 - axis]
            ahead = (
                cells[peaks[other], axis] + int(bounds[other, axis]) - cells[peaks[c], axis] - int(bounds[c, axis])
            ) % size
            width = int(bounds[c, 3 + axis]) - int(bounds[c, axis]) + 2 * radius
            other_width = int(bounds[other, 3 + axis]) - int(bounds[other, axis]) + 2 * radius
            touching = touching and (ahead <= width or size - ahead <= other_width)
        if touching:
            return False
    return True


@njit(cache=True, nogil=True)
def subtract(values, slot, other_cells, other_values, m, gain):
    """P <- P - gain Q where P is active. `slot` indexes P."""
    for i in range(m):
        at = slot[other_cells[i, FLAT]]
        if at > 0:
            values[at - 1] -= gain * other_values[i]


@njit(cache=True, nogil=True)
def inhibit_and_normalise(cells, values, n, slot, phi):
    """P <- max(P - phi, 0) / sum P. A eqs. 11-12. Returns how many cells stay active, 0 when none does."""
    m = 0
    total = 0.0
    for i in range(n):
        left = values[i] - phi
        slot[cells[i, FLAT]] = 0
        if left > 0.0:
            for k in range(4):
                cells[m, k] = cells[i, k]
            values[m] = left
            total += left
            m += 1
            slot[cells[i, FLAT]] = m
    for i in range(m):
        values[i] = np.float32(values[i] / total)
    return m
