"""Compiled array functions of the pose cells. They touch active cells only, so that size costs nothing.

A set of active cells is (cells, values, n): in the first n rows of `cells` x, y, theta and the flat index
(theta * n_y + y) * n_x + x, in `values` their activities. `slot[flat]` is 1 + the row of an active cell, 0 for all others;
every function says which set it indexes. Coordinates are kept because integer division is what would cost most.
"""

from __future__ import annotations

import numpy as np
from numba import njit

X, Y, THETA, FLAT = 0, 1, 2, 3


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
def _offset(a, b, size):
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
def inject(flats, more, cells, values, n, slot, shape):
    """P <- P + injection. A eq. 4. `slot` indexes P before and after."""
    n_y, n_x = shape[1], shape[2]
    for i in range(flats.size):
        row = flats[i] // n_x
        n = _add(flats[i] - row * n_x, row % n_y, row // n_y, flats[i], more[i], cells, values, n, slot)
    return n


@njit(cache=True, nogil=True)
def shift(cells, values, n, out_cells, out_values, slot, shape, along, yaw, extra_x, extra_y):
    """P'_xyz = sum over a 2x2x2 cube of alpha_abc P. A eqs. 5-9. `slot` indexes the input, afterwards the output.

    along: cells forwards, each layer along its own heading; yaw: layers; extra_x, extra_y: cells, the same for all layers.
    """
    n_theta, n_y, n_x = shape
    clear(cells, n, slot)
    whole = np.empty((n_theta, 2), np.int64)
    part = np.empty((n_theta, 2))
    for t in range(n_theta):
        heading = 2.0 * np.pi * t / n_theta
        dx = along * np.cos(heading) + extra_x
        dy = along * np.sin(heading) + extra_y
        whole[t, 0] = int(np.floor(dx)) % n_x
        whole[t, 1] = int(np.floor(dy)) % n_y
        part[t, 0] = dx - np.floor(dx)
        part[t, 1] = dy - np.floor(dy)
    part_t = yaw - np.floor(yaw)
    whole_t = int(np.floor(yaw)) % n_theta
    m = 0
    for i in range(n):
        t = cells[i, THETA]
        x0 = _wrap(cells[i, X] + whole[t, 0], n_x)
        y0 = _wrap(cells[i, Y] + whole[t, 1], n_y)
        x1 = _wrap(x0 + 1, n_x)
        fx = part[t, 0]
        fy = part[t, 1]
        for c in range(2):
            at = values[i] * (part_t if c else 1.0 - part_t)
            if at == 0.0:
                continue
            to_t = _wrap(_wrap(t + whole_t, n_theta) + c, n_theta)
            for b in range(2):
                ab = at * (fy if b else 1.0 - fy)
                if ab == 0.0:
                    continue
                to_y = _wrap(y0 + b, n_y)
                row = (to_t * n_y + to_y) * n_x
                m = _add(x0, to_y, to_t, row + x0, np.float32(ab * (1.0 - fx)), out_cells, out_values, m, slot)
                if fx > 0.0:
                    m = _add(x1, to_y, to_t, row + x1, np.float32(ab * fx), out_cells, out_values, m, slot)
    return m


@njit(cache=True, nogil=True)
def cluster(cells, values, n, shape, window, owner, peaks):
    """Give every active cell to a cluster: the strongest free cell and all free cells within `window` of it, again and again.

    Writes the cluster of each cell to `owner` and the row of each cluster's strongest cell to `peaks`; returns their number.
    """
    n_theta, n_y, n_x = shape
    wx, wy, wt = min(window, (n_x - 1) // 2), min(window, (n_y - 1) // 2), min(window, (n_theta - 1) // 2)
    owner[:n] = -1
    found = 0
    best = 0
    for i in range(n):
        if values[i] > values[best]:
            best = i
    while best >= 0:
        peak = best
        peaks[found] = peak
        best = -1
        for i in range(n):
            if owner[i] < 0:
                if (
                    abs(_offset(cells[i, X], cells[peak, X], n_x)) <= wx
                    and abs(_offset(cells[i, Y], cells[peak, Y], n_y)) <= wy
                    and abs(_offset(cells[i, THETA], cells[peak, THETA], n_theta)) <= wt
                ):
                    owner[i] = found
                elif best < 0 or values[i] > values[best]:
                    best = i
        found += 1
    return found


@njit(cache=True, nogil=True)
def convolve(
    cells, values, n, owner, peaks, clusters, out_cells, out_values, slot, shape, window, weights, box_a, box_b
):
    """P <- eps * P: circular convolution with a 3-D Gaussian as three 1-D passes. A eq. 10.

    `owner` and `peaks` split the active cells into clusters that fit a small dense box each; the boxes' results add up,
    since convolution is linear. `slot` indexes the input, afterwards the output. box_a, box_b: scratch.
    """
    n_theta, n_y, n_x = shape
    clear(cells, n, slot)
    taps = weights.size
    radius = taps // 2
    bounds = np.empty((clusters, 6), np.int64)
    bounds[:, :3] = window + 1
    bounds[:, 3:] = -window - 1
    for i in range(n):
        c = owner[i]
        peak = peaks[c]
        for axis in range(3):
            d = _offset(cells[i, axis], cells[peak, axis], shape[2 - axis])
            bounds[c, axis] = min(bounds[c, axis], d)
            bounds[c, 3 + axis] = max(bounds[c, 3 + axis], d)
    m = 0
    for c in range(clusters):
        px, py, pt = cells[peaks[c], X], cells[peaks[c], Y], cells[peaks[c], THETA]
        low_x, low_y, low_t = bounds[c, 0], bounds[c, 1], bounds[c, 2]
        sx, sy, st = bounds[c, 3] - low_x + 1, bounds[c, 4] - low_y + 1, bounds[c, 5] - low_t + 1
        bx, by, bt = sx + 2 * radius, sy + 2 * radius, st + 2 * radius
        layer = sy * sx
        box_a[: st * layer] = 0.0
        for i in range(n):
            if owner[i] == c:
                dx = _offset(cells[i, X], px, n_x) - low_x
                dy = _offset(cells[i, Y], py, n_y) - low_y
                dt = _offset(cells[i, THETA], pt, n_theta) - low_t
                box_a[(dt * sy + dy) * sx + dx] = values[i]
        _pass(box_a, box_b, 1, st, layer, weights)
        _pass(box_b, box_a, bt, sy, sx, weights)
        _pass(box_a, box_b, bt * by, sx, 1, weights)
        first_x, first_y, first_t = (
            (px + low_x - radius) % n_x,
            (py + low_y - radius) % n_y,
            (pt + low_t - radius) % n_theta,
        )
        for t in range(bt):
            to_t = (first_t + t) % n_theta
            for y in range(by):
                to_y = (first_y + y) % n_y
                row = (to_t * n_y + to_y) * n_x
                at = (t * by + y) * bx
                to_x = first_x
                for x in range(bx):
                    if box_b[at + x] > 0.0:
                        m = _add(to_x, to_y, to_t, row + to_x, box_b[at + x], out_cells, out_values, m, slot)
                    to_x += 1
                    if to_x == n_x:
                        to_x = 0
    return m


@njit(cache=True, nogil=True)
def _pass(source, target, outer, size, inner, weights):
    """Full 1-D convolution along the middle axis of (outer, size, inner) into (outer, size + taps - 1, inner)."""
    taps = weights.size
    target[: outer * (size + taps - 1) * inner] = 0.0
    for o in range(outer):
        for k in range(taps):
            to = (o * (size + taps - 1) + k) * inner
            fro = o * size * inner
            for i in range(size * inner):
                target[to + i] += weights[k] * source[fro + i]


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


@njit(cache=True, nogil=True)
def packet_rows(cells, values, n, shape, owner, peaks, clusters, out):
    """The heaviest clusters as packets, heaviest first; returns how many.

    out rows: x, y, theta (cells, fractions), mass, mean resultant length of the headings.
    """
    n_theta, n_y, n_x = shape
    turn = 2.0 * np.pi / n_theta
    layers = np.empty((n_theta, 2))
    for t in range(n_theta):
        layers[t, 0] = np.cos(turn * t)
        layers[t, 1] = np.sin(turn * t)
    sums = np.zeros((clusters, 6))
    for i in range(n):
        c = owner[i]
        peak = peaks[c]
        v = values[i]
        sums[c, 0] += v * _offset(cells[i, X], cells[peak, X], n_x)
        sums[c, 1] += v * _offset(cells[i, Y], cells[peak, Y], n_y)
        sums[c, 2] += v * _offset(cells[i, THETA], cells[peak, THETA], n_theta)
        sums[c, 3] += v
        sums[c, 4] += v * layers[cells[i, THETA], 0]
        sums[c, 5] += v * layers[cells[i, THETA], 1]
    rows = min(clusters, out.shape[0])
    for r in range(rows):
        c = int(np.argmax(sums[:, 3]))
        mass = sums[c, 3]
        out[r, 0] = (cells[peaks[c], X] + sums[c, 0] / mass) % n_x
        out[r, 1] = (cells[peaks[c], Y] + sums[c, 1] / mass) % n_y
        out[r, 2] = (cells[peaks[c], THETA] + sums[c, 2] / mass) % n_theta
        out[r, 3] = mass
        out[r, 4] = np.sqrt(sums[c, 4] ** 2 + sums[c, 5] ** 2) / mass
        sums[c, 3] = 0.0
    return rows


@njit(cache=True, nogil=True)
def centre_near(cells, values, n, shape, window, x, y, t):
    """Centre of the activity within `window` of (x, y, t), as the offset from there (cells, layers), and its mass."""
    n_theta, n_y, n_x = shape
    wx, wy, wt = min(window, (n_x - 1) // 2), min(window, (n_y - 1) // 2), min(window, (n_theta - 1) // 2)
    mass = sx = sy = st = 0.0
    for i in range(n):
        dx = _offset(cells[i, X], x, n_x)
        dy = _offset(cells[i, Y], y, n_y)
        dt = _offset(cells[i, THETA], t, n_theta)
        if abs(dx) <= wx and abs(dy) <= wy and abs(dt) <= wt:
            v = values[i]
            mass += v
            sx += v * dx
            sy += v * dy
            st += v * dt
    if mass == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    return sx / mass, sy / mass, st / mass, mass
