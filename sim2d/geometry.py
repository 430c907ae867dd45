"""Distances in the plane, compiled: from a point to segments, along a ray to segments, inside a ring."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def nearest_segment(segments: NDArray[np.float64], x: float, y: float) -> tuple[int, float]:
    """Number of the segment nearest to (x, y) and its distance, metres. `segments` is (n, 4), n > 0."""
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
def ray_length(segments: NDArray[np.float64], x: float, y: float, angle: float, farthest: float) -> float:
    """Metres from (x, y) along `angle` to the first segment, at most `farthest`.

    Solves p + t d = a + s e for each segment a, e by cross products: t = (a-p) x e / d x e, s = (a-p) x d / d x e.
    """
    ux, uy = math.cos(angle), math.sin(angle)
    shortest = farthest
    for i in range(segments.shape[0]):
        px, py = segments[i, 0] - x, segments[i, 1] - y
        ex, ey = segments[i, 2] - segments[i, 0], segments[i, 3] - segments[i, 1]
        cross = ux * ey - uy * ex
        if cross == 0.0:  # parallel: seen edge-on, a wall without thickness hides nothing
            continue
        t = (px * ey - py * ex) / cross
        if t < 0.0 or t >= shortest:
            continue
        s = (px * uy - py * ux) / cross
        if 0.0 <= s <= 1.0:
            shortest = t
    return shortest


@njit(cache=True, nogil=True)
def inside_ring(ring: NDArray[np.float64], x: float, y: float) -> bool:
    """Whether (x, y) is inside the closed ring (k, 2): an odd number of its edges lie to the right."""
    inside = False
    j = ring.shape[0] - 1
    for i in range(ring.shape[0]):
        xi, yi, xj, yj = ring[i, 0], ring[i, 1], ring[j, 0], ring[j, 1]
        if (yi > y) != (yj > y) and x < (xj - xi) * (y - yi) / (yj - yi) + xi:
            inside = not inside
        j = i
    return inside


@njit(cache=True, nogil=True)
def clearance_grid(
    segments: NDArray[np.float64], ring: NDArray[np.float64], xs: NDArray[np.float64], ys: NDArray[np.float64]
) -> NDArray[np.float32]:
    """(len(ys), len(xs)): metres to the nearest segment, 0 outside of the ring."""
    out = np.zeros((ys.size, xs.size), np.float32)
    for j in range(ys.size):
        for i in range(xs.size):
            if inside_ring(ring, xs[i], ys[j]):
                out[j, i] = nearest_segment(segments, xs[i], ys[j])[1]
    return out
