"""Which walls are near: a uniform grid that rays walk through (Amanatides, Woo 1987); distant walls cost nothing."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

_SMALLEST_M, _LARGEST_M, _MOST_CELLS = 0.4, 16.0, 400_000
_EDGE_M = 1e-6  # a wall on a cell's edge is in both cells
FAR = 1e18


class WallIndex(NamedTuple):
    """Segments sorted into square cells. items[first[c] : first[c + 1]] are the numbers of the segments in cell c."""

    segments: NDArray[np.float64]  # (n, 4)
    x0: float
    y0: float
    cell: float
    n_x: int
    n_y: int
    first: NDArray[np.int64]  # (n_x n_y + 1,)
    items: NDArray[np.int64]


def build_index(segments: NDArray[np.float64]) -> WallIndex:
    """The index of (n, 4) segments; n may be 0."""
    if len(segments) == 0:
        return WallIndex(np.zeros((0, 4)), 0.0, 0.0, 1.0, 1, 1, np.zeros(2, np.int64), np.zeros(0, np.int64))
    xs, ys = segments[:, 0::2], segments[:, 1::2]
    x0, y0 = float(xs.min()) - 0.01, float(ys.min()) - 0.01
    width, depth = float(xs.max()) + 0.01 - x0, float(ys.max()) + 0.01 - y0
    cell = min(max(math.sqrt(width * depth / (2 * len(segments))), _SMALLEST_M), _LARGEST_M)
    cell = max(cell, math.sqrt(width * depth / _MOST_CELLS))
    n_x, n_y = int(width / cell) + 1, int(depth / cell) + 1
    first = np.zeros(n_x * n_y + 1, np.int64)
    _sort_in(segments, x0, y0, cell, n_x, n_y, first, np.zeros(0, np.int64))
    items = np.zeros(int(first[-1]), np.int64)
    _sort_in(segments, x0, y0, cell, n_x, n_y, first, items)
    return WallIndex(segments, x0, y0, cell, n_x, n_y, first, items)


@njit(cache=True, nogil=True)
def _sort_in(
    segments: NDArray[np.float64],
    x0: float,
    y0: float,
    cell: float,
    n_x: int,
    n_y: int,
    first: NDArray[np.int64],
    items: NDArray[np.int64],
) -> None:
    """Called twice: with empty `items` it counts the entries of each cell into `first`; then it fills `items`."""
    counting = items.size == 0
    at = first.copy()
    for i in range(segments.shape[0]):
        ax, ay, bx, by = segments[i, 0], segments[i, 1], segments[i, 2], segments[i, 3]
        low = max(0, int((min(ay, by) - _EDGE_M - y0) / cell))
        high = min(n_y - 1, int((max(ay, by) + _EDGE_M - y0) / cell))
        for row in range(low, high + 1):
            u, v = 0.0, 1.0  # the part of the segment in this row of cells
            if ay != by:
                u = (y0 + row * cell - _EDGE_M - ay) / (by - ay)
                v = (y0 + (row + 1) * cell + _EDGE_M - ay) / (by - ay)
                u, v = min(max(min(u, v), 0.0), 1.0), min(max(max(u, v), 0.0), 1.0)
            left, right = ax + u * (bx - ax), ax + v * (bx - ax)
            begin = max(0, int((min(left, right) - _EDGE_M - x0) / cell))
            end = min(n_x - 1, int((max(left, right) + _EDGE_M - x0) / cell))
            for column in range(begin, end + 1):
                c = row * n_x + column
                if counting:
                    first[c + 1] += 1
                else:
                    items[at[c]] = i
                    at[c] += 1
    if counting:
        for c in range(n_x * n_y):
            first[c + 1] += first[c]


@njit(cache=True, nogil=True, inline="always")
def crossing(segments: NDArray[np.float64], i: int, x: float, y: float, ux: float, uy: float) -> tuple[float, float]:
    """Where the ray from (x, y) along (ux, uy) meets segment i: t along the ray, s in 0-1 along the segment; (FAR, 0):
    nowhere.

    Solves p + t d = a + s e by cross products: t = (a-p) x e / d x e, s = (a-p) x d / d x e.
    """
    px, py = segments[i, 0] - x, segments[i, 1] - y
    ex, ey = segments[i, 2] - segments[i, 0], segments[i, 3] - segments[i, 1]
    cross = ux * ey - uy * ex
    if cross == 0.0:  # parallel: seen edge-on, a wall without thickness hides nothing
        return FAR, 0.0
    t, s = (px * ey - py * ex) / cross, (px * uy - py * ux) / cross
    if t < 0.0 or s < 0.0 or s > 1.0:
        return FAR, 0.0
    return t, s


@njit(cache=True, nogil=True)
def enter(index: WallIndex, x: float, y: float, ux: float, uy: float) -> tuple[bool, int, int, float, float]:
    """Where a ray's walk begins: whether it meets the grid, first column and row, t of its next edges in x and y."""
    t = 0.0
    right, top = index.x0 + index.n_x * index.cell, index.y0 + index.n_y * index.cell
    for p, u, low, high in ((x, ux, index.x0, right), (y, uy, index.y0, top)):
        if low <= p <= high:
            continue
        if (p < low and u <= 0.0) or (p > high and u >= 0.0):
            return False, 0, 0, 0.0, 0.0
        t = max(t, ((low if p < low else high) - p) / u)
    column = min(max(int((x + t * ux - index.x0) / index.cell), 0), index.n_x - 1)
    row = min(max(int((y + t * uy - index.y0) / index.cell), 0), index.n_y - 1)
    next_x = next_y = FAR
    if ux != 0.0:
        next_x = (index.x0 + (column + (1 if ux > 0.0 else 0)) * index.cell - x) / ux
    if uy != 0.0:
        next_y = (index.y0 + (row + (1 if uy > 0.0 else 0)) * index.cell - y) / uy
    return True, column, row, next_x, next_y


@njit(cache=True, nogil=True)
def first_wall(index: WallIndex, x: float, y: float, ux: float, uy: float, farthest: float) -> tuple[int, float, float]:
    """The first segment on a ray: number (-1: none), t (in lengths of (ux, uy), at most `farthest`), s along it."""
    best, shortest, along = -1, farthest, 0.0
    inside, column, row, next_x, next_y = enter(index, x, y, ux, uy)
    if not inside:
        return best, shortest, along
    step_x, step_y = (1 if ux > 0.0 else -1), (1 if uy > 0.0 else -1)
    per_x = index.cell / abs(ux) if ux != 0.0 else FAR
    per_y = index.cell / abs(uy) if uy != 0.0 else FAR
    while 0 <= column < index.n_x and 0 <= row < index.n_y:
        c = row * index.n_x + column
        for k in range(index.first[c], index.first[c + 1]):
            t, s = crossing(index.segments, index.items[k], x, y, ux, uy)
            if t < shortest:
                best, shortest, along = index.items[k], t, s
        leaves = min(next_x, next_y)
        if shortest <= leaves:
            break
        if next_x < next_y:
            column += step_x
            next_x += per_x
        else:
            row += step_y
            next_y += per_y
    return best, shortest, along


@njit(cache=True, nogil=True)
def nearest_within(index: WallIndex, x: float, y: float, reach: float) -> float:
    """Distance (m) from (x, y) to the nearest segment; `reach` if all are farther away."""
    nearest = reach * reach
    left, right = int((x - reach - index.x0) / index.cell), int((x + reach - index.x0) / index.cell)
    low, high = int((y - reach - index.y0) / index.cell), int((y + reach - index.y0) / index.cell)
    for row in range(max(low, 0), min(high, index.n_y - 1) + 1):
        for column in range(max(left, 0), min(right, index.n_x - 1) + 1):
            c = row * index.n_x + column
            for k in range(index.first[c], index.first[c + 1]):
                nearest = min(nearest, squared_distance(index.segments, index.items[k], x, y))
    return math.sqrt(nearest)


@njit(cache=True, nogil=True, inline="always")
def squared_distance(segments: NDArray[np.float64], i: int, x: float, y: float) -> float:
    """Squared distance (m²) from (x, y) to segment i."""
    ax, ay = segments[i, 0], segments[i, 1]
    dx, dy = segments[i, 2] - ax, segments[i, 3] - ay
    along = min(max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0), 1.0)
    ex, ey = x - ax - along * dx, y - ay - along * dy
    return ex * ex + ey * ey
