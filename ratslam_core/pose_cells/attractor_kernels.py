"""The attractor's compiled functions: excitation, inhibition, normalisation. ACRA 2004 eqs. 10-12.

Sets of active cells are those of `activity_kernels`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core.pose_cells.activity_kernels import (
    FLAT,
    THETA,
    Cells,
    Shape,
    Slot,
    Values,
    X,
    Y,
    add,
    clear,
    cluster,
    offset,
)
from ratslam_core.types import Ints, Ints32, Singles


def gaussian(sigma: float, radius: int = 0) -> Singles:
    """A normalised Gaussian over so many cells to either side; three sigma, and two at least, if none is given."""
    radius = radius or max(2, math.ceil(3 * sigma))
    at = np.arange(-radius, radius + 1)
    weights = np.exp(-0.5 * (at / sigma) ** 2)
    return (weights / weights.sum()).astype(np.float32)


@njit(cache=True, nogil=True)
def excite(
    cells: Cells, values: Values, n: int, owner: Ints32, peaks: Ints32, bounds: NDArray[np.int8], out_cells: Cells,
    out_values: Values, slot: Slot, shape: Shape, window: int, weights: Singles, floor: float | np.float32,
    box_a: Singles, box_b: Singles,
) -> tuple[int, int]:  # fmt: skip
    """P <- eps * P: circular convolution with a 3-D Gaussian as three 1-D passes. A eq. 10.

    The active cells are split into clusters, each of which fits a small dense box. The boxes' results add up, since
    convolution is linear. Cells up to `floor` are left out where no other box can add to them, since inhibition would
    remove them at once. `slot` indexes the input, afterwards the output. owner, peaks, bounds, box_a, box_b: scratch.

    Returns how many cells are active then, and how many the output must have room for; if it has not, nothing has
    changed, and the first is -1.
    """
    radius = weights.size // 2
    clusters, room = cluster(cells, values, n, shape, window, radius, owner, peaks, bounds)
    if min(room, slot.size) > len(out_cells):
        return -1, room
    n_theta, n_y, n_x = shape
    clear(cells, n, slot)
    kept = np.empty(box_a.size, np.uint32)
    m = 0
    for c in range(clusters):
        px, py, pt = cells[peaks[c], X], cells[peaks[c], Y], cells[peaks[c], THETA]
        low_x, low_y, low_t = int(bounds[c, 0]) - radius, int(bounds[c, 1]) - radius, int(bounds[c, 2]) - radius
        more = 1 + radius
        bx, by, bt = (
            int(bounds[c, 3]) - low_x + more,
            int(bounds[c, 4]) - low_y + more,
            int(bounds[c, 5]) - low_t + more,
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
        _pass(box_a, box_b, size, inner, layer // layer, weights)  # 1, but no literal: else compiled twice
        _pass(box_b, box_a, size, inner, bx, weights)
        _pass(box_a, box_b, size, inner, layer, weights)
        alone = bx <= n_x and by <= n_y and bt <= n_theta
        least = np.float32(floor if alone and _apart(c, clusters, cells, peaks, bounds, radius, shape) else 0.0)
        # Which cells stay is noted first without a branch, since no processor can foresee them; then they are added.
        stay = 0
        for at in range(size):
            kept[stay] = at
            stay += box_b[at] > least
        xs, ys, ts = _ring(px + low_x, bx, n_x), _ring(py + low_y, by, n_y), _ring(pt + low_t, bt, n_theta)
        width, depth = np.uint32(bx), np.uint32(by)
        for k in range(stay):
            at: int = kept[k]
            row = at // width
            x: int = xs[at % width]
            y: int = ys[row % depth]
            t: int = ts[row // depth]
            m = add(x, y, t, (t * n_y + y) * n_x + x, box_b[at], out_cells, out_values, m, slot)
    return m, room


@njit(cache=True, nogil=True)
def _ring(first: int, count: int, size: int) -> Ints:
    """The coordinates of so many successive cells on a ring of this size."""
    at = np.empty(count, np.int64)
    for k in range(count):
        at[k] = (first + k) % size
    return at


@njit(cache=True, nogil=True)
def _pass(source: Singles, target: Singles, size: int, inner: tuple[int, int], stride: int, weights: Singles) -> None:
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
def _apart(
    c: int, clusters: int, cells: Cells, peaks: Ints32, bounds: NDArray[np.int8], radius: int, shape: Shape
) -> bool:
    """Whether no other cluster's box, with its margin, shares a cell with that of cluster c."""
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
def inhibit_and_normalise(cells: Cells, values: Values, n: int, slot: Slot, phi: float | np.float32) -> int:
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
