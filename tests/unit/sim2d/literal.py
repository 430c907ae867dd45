"""A slow twin of the simulator's rays: every segment is looked at, one by one."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def ray_length(segments: NDArray[np.float64], x: float, y: float, angle: float, farthest: float) -> float:
    """Distance (m) from (x, y) along `angle` (rad) to the first segment, at most `farthest`.

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
