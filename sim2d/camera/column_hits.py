"""Which walls each column of the camera's image meets.

The inverse depth of a wall, and the position along it divided by depth, are linear across the image. So each wall is
transformed into camera coordinates once, and every column finds its hits by interpolation: 2.5-D, with no ray per
pixel. Low walls (desks, partitions) do not hide high ones, so a column keeps its nearest hits up to the first wall of
full height.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

MAX_HITS = 8
NEAR_M = 0.02  # anything nearer than this is not seen
SAME = 1e-6  # of two walls in one place, nearer to each other than this share of the distance, the first is seen


@njit(cache=True, nogil=True)
def column_hits(
    segments: NDArray[np.float64],
    full: NDArray[np.bool_],
    chosen: NDArray[np.int64],
    x: float,
    y: float,
    heading: float,
    focal: float,
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
) -> None:
    """For each column, find the chosen walls that its middle ray meets, near to far, up to the first full one.

    full: (n,) walls that hide everything behind them. chosen: numbers of the walls to look at. Filled in are counts:
    (w,) how many; walls: (w, k) their strips (2 i + side); hits: (w, k, 3) inverse depth (1/m), and the stretch of the
    wall that the column covers, as two fractions of its length, the smaller first.
    """
    width = counts.size
    cos, sin = math.cos(heading), math.sin(heading)
    counts[:] = 0
    for i in chosen:
        ax, ay = segments[i, 0] - x, segments[i, 1] - y
        bx, by = segments[i, 2] - x, segments[i, 3] - y
        za, zb = ax * cos + ay * sin, bx * cos + by * sin  # depth
        if za < NEAR_M and zb < NEAR_M:
            continue
        la, lb = -ax * sin + ay * cos, -bx * sin + by * cos  # to the left
        side = 0 if ax * by - ay * bx > 0.0 else 1
        ua, ub = 0.0, 1.0
        if za < NEAR_M:
            ua = (NEAR_M - za) / (zb - za)
            la, za = la + ua * (lb - la), NEAR_M
        elif zb < NEAR_M:
            ub = (NEAR_M - za) / (zb - za)
            lb, zb = la + ub * (lb - la), NEAR_M
        sa, sb = 0.5 * width - focal * la / za, 0.5 * width - focal * lb / zb
        wa, wb = 1.0 / za, 1.0 / zb
        pa, pb = ua * wa, ub * wb  # position over depth
        if sa > sb:
            sa, sb, wa, wb, pa, pb = sb, sa, wb, wa, pb, pa
        begin = max(0, math.ceil(sa - 0.5))
        end = min(width, math.ceil(sb - 0.5))
        if begin >= end:
            continue
        dw, dp = (wb - wa) / (sb - sa), (pb - pa) / (sb - sa)
        for c in range(begin, end):
            inverse = wa + (c + 0.5 - sa) * dw
            n, beyond = counts[c], inverse * (1.0 - SAME)
            if n > 0 and hits[c, n - 1, 0] >= beyond and (n == MAX_HITS or full[walls[c, n - 1] >> 1]):
                continue
            left, right = max(c - sa, 0.0), min(c + 1.0, sb) - sa
            u0 = (pa + left * dp) / (wa + left * dw)
            u1 = (pa + right * dp) / (wa + right * dw)
            k = min(n, MAX_HITS - 1)
            while k > 0 and hits[c, k - 1, 0] < beyond:
                walls[c, k] = walls[c, k - 1]
                for part in range(3):  # one by one: copying rows takes numba three seconds to compile
                    hits[c, k, part] = hits[c, k - 1, part]
                k -= 1
            walls[c, k] = 2 * i + side
            hits[c, k, 0], hits[c, k, 1], hits[c, k, 2] = inverse, min(u0, u1), max(u0, u1)
            counts[c] = k + 1 if full[i] else min(n + 1, MAX_HITS)
