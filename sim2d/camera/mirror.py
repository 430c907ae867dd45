"""Reflections in glass: a column's ray is reflected at the pane and followed to the first thing it meets."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.geometry.wall_index import WallIndex, crossing, first_wall

_OFF_M = 1e-6


@njit(cache=True, nogil=True)
def mirrored(
    index: WallIndex,
    segments: NDArray[np.float64],
    elements: NDArray[np.int64],
    glass: NDArray[np.bool_],
    x: float,
    y: float,
    heading: float,
    rays: NDArray[np.float64],
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
    at: NDArray[np.int64],
    strips: NDArray[np.int64],
    found: NDArray[np.float64],
) -> None:
    """For each column: which of its hits is its nearest pane (`at`, -1: none), and what is seen in it.

    elements: numbers of the actors' sides that are present. strips: (w,) the strip that the reflected ray meets, -1:
    none. found: (w, 3) as one row of hits; its inverse distance is that of the whole way.
    """
    cos, sin = math.cos(heading), math.sin(heading)
    for c in range(counts.size):
        at[c], strips[c] = -1, -1
        for k in range(counts[c]):
            pane = walls[c, k] >> 1
            if not glass[pane]:
                continue
            ux, uy = rays[c, 0, 0] * cos - rays[c, 0, 1] * sin, rays[c, 0, 0] * sin + rays[c, 0, 1] * cos
            ex, ey = segments[pane, 2] - segments[pane, 0], segments[pane, 3] - segments[pane, 1]
            scale = 2.0 * (ux * ex + uy * ey) / (ex * ex + ey * ey)
            vx, vy = scale * ex - ux, scale * ey - uy  # reflected at the pane, of the same length
            t = 1.0 / hits[c, k, 0]
            px, py = x + t * ux + _OFF_M * vx, y + t * uy + _OFF_M * vy
            best, shortest, along = first_wall(index, px, py, vx, vy, 1e6)
            for i in elements:
                d, s = crossing(segments, i, px, py, vx, vy)
                if d < shortest:
                    best, shortest, along = i, d, s
            at[c] = k
            if best >= 0:
                ax, ay = segments[best, 0] - px, segments[best, 1] - py
                bx, by = segments[best, 2] - px, segments[best, 3] - py
                strips[c] = 2 * best + (0 if ax * by - ay * bx > 0.0 else 1)
                found[c, 0], found[c, 1], found[c, 2] = 1.0 / (t + shortest), along, along
            break
