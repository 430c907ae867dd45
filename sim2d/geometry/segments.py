"""Compiled geometry in the plane: distances to segments, points in a ring; and what an edit has changed."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def nearest_segment(segments: NDArray[np.float64], x: float, y: float) -> tuple[int, float]:
    """The number of the segment nearest to (x, y), and its distance (m). segments: (n, 4), n > 0."""
    best = -1
    best_squared = math.inf
    for i in range(segments.shape[0]):
        ax, ay = segments[i, 0], segments[i, 1]
        dx, dy = segments[i, 2] - ax, segments[i, 3] - ay
        along = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)
        along = min(max(along, 0.0), 1.0)
        ex, ey = x - ax - along * dx, y - ay - along * dy
        squared = ex * ex + ey * ey
        if squared < best_squared:
            best_squared = squared
            best = i
    return best, math.sqrt(best_squared)


@njit(cache=True, nogil=True)
def inside_ring(ring: NDArray[np.float64], x: float, y: float) -> bool:
    """Whether (x, y) is inside the closed ring (k, 2): a ray to the right then crosses an odd number of edges."""
    inside = False
    j = ring.shape[0] - 1
    for i in range(ring.shape[0]):
        xi, yi, xj, yj = ring[i, 0], ring[i, 1], ring[j, 0], ring[j, 1]
        if (yi > y) != (yj > y) and x < (xj - xi) * (y - yi) / (yj - yi) + xi:
            inside = not inside
        j = i
    return inside


@njit(cache=True, nogil=True)
def free_cells(
    segments: NDArray[np.float64],
    ring: NDArray[np.float64],
    xs: NDArray[np.float64],
    ys: NDArray[np.float64],
    radius: float,
) -> NDArray[np.bool_]:
    """(len(ys), len(xs)): cells whose centre is in the ring and at least `radius` metres from every segment.

    xs, ys: evenly spaced, ascending. Only cells in the ring and around the segments are looked at.
    """
    out = np.zeros((ys.size, xs.size), np.bool_)
    _fill_ring(ring, xs, ys, out)
    step = xs[1] - xs[0] if xs.size > 1 else 1.0
    for i in range(segments.shape[0]):
        ax, ay, bx, by = segments[i, 0], segments[i, 1], segments[i, 2], segments[i, 3]
        dx, dy = bx - ax, by - ay
        low = max(0, int((min(ay, by) - radius - ys[0]) / step) - 1)
        high = min(ys.size, int((max(ay, by) + radius - ys[0]) / step) + 3)
        for j in range(low, high):
            from_u, to_u = 0.0, 1.0  # the part of the segment that is near enough to this row
            if dy != 0.0:
                u, v = (ys[j] - radius - ay) / dy, (ys[j] + radius - ay) / dy
                from_u, to_u = min(max(min(u, v), 0.0), 1.0), min(max(max(u, v), 0.0), 1.0)
            left, right = ax + from_u * dx, ax + to_u * dx
            begin = max(0, int((min(left, right) - radius - xs[0]) / step) - 1)
            end = min(xs.size, int((max(left, right) + radius - xs[0]) / step) + 3)
            for k in range(begin, end):
                if out[j, k] and np.float32(nearest_segment(segments[i : i + 1], xs[k], ys[j])[1]) < np.float32(radius):
                    out[j, k] = False
    return out


@njit(cache=True, nogil=True)
def _fill_ring(
    ring: NDArray[np.float64], xs: NDArray[np.float64], ys: NDArray[np.float64], out: NDArray[np.bool_]
) -> None:
    """`inside_ring` for every cell, row by row: x is inside if an odd number of edges cross the row beyond it."""
    crossings = np.empty(ring.shape[0])
    for j in range(ys.size):
        y, n, last = ys[j], 0, ring.shape[0] - 1
        for i in range(ring.shape[0]):
            xi, yi, xj, yj = ring[i, 0], ring[i, 1], ring[last, 0], ring[last, 1]
            if (yi > y) != (yj > y):
                crossing = (xj - xi) * (y - yi) / (yj - yi) + xi
                at = n  # insertion sort: they are few, and numpy's sort takes numba two seconds to compile
                while at > 0 and crossings[at - 1] > crossing:
                    crossings[at] = crossings[at - 1]
                    at -= 1
                crossings[at] = crossing
                n += 1
            last = i
        passed = 0
        for k in range(xs.size):
            while passed < n and crossings[passed] <= xs[k]:
                passed += 1
            out[j, k] = (n - passed) % 2 == 1


def differing(a: NDArray[np.float64], b: NDArray[np.float64]) -> list[tuple[float, ...]]:
    """The rows that are in only one of two lists of segments, (n, 4) and (m, 4), sorted."""
    most = min(len(a), len(b))
    same = np.append((a[:most] == b[:most]).all(axis=1), False)
    first = int(np.argmin(same))  # equal rows at the beginning and at the end are skipped quickly
    same = np.append((a[len(a) - most :] == b[len(b) - most :]).all(axis=1)[first:][::-1], False)
    last = int(np.argmin(same))
    mine, others = ({tuple[float, ...](row) for row in part[first : len(part) - last].tolist()} for part in (a, b))
    return sorted(mine ^ others)
