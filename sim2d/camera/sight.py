"""The camera's rays: which walls may be visible at all, and which of them each column of the image meets.

The inverse depth of a wall, and the position along it divided by depth, are linear across the image of a flat lens. So
each wall is transformed into camera coordinates once, and every column finds its hits by interpolation: 2.5-D, with no
ray per pixel. Low walls (desks, partitions) do not hide high ones, so a column keeps its nearest hits up to the first
wall of full height. A round lens casts a ray per column.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.geometry.wall_index import FAR, WallIndex, crossing, enter

MAX_HITS = 8
NEAR_M = 0.02  # anything nearer than this is not seen
SAME = 1e-6  # of two walls in one place, nearer to each other than this share of the distance, the first is seen
MOST_FLAT_RAD = 2.4  # widest view of a flat lens: a wider one would stretch the edges of the image too much
_WITHIN = 1e-9  # only a wall that is met at least this far from its ends is sure to hide what is behind


def lens_rays(width: int, fov_rad: float) -> tuple[NDArray[np.float64], float]:
    """(w + 1, 2, 2): for each column the rays of its middle and left edge, (ahead, left); and the focal length, pixels.

    Up to MOST_FLAT_RAD the lens is flat: all rays have 1 as their component ahead, so that multiples of a ray count
    depth. A wider lens is round: all rays have length 1, so that multiples count distance.
    """
    column = np.arange(width + 1)[:, None] + np.array([0.5, 0.0])
    if fov_rad <= MOST_FLAT_RAD:
        focal = 0.5 * width / math.tan(0.5 * fov_rad)
        left = np.asarray((0.5 * width - column) / focal, np.float64)
        return np.stack([np.ones_like(left), left], axis=2), focal
    focal = width / fov_rad
    angle = (0.5 * width - column) / focal
    return np.stack([np.cos(angle), np.sin(angle)], axis=2), focal


@njit(cache=True, nogil=True)
def seen_walls(
    index: WallIndex,
    full: NDArray[np.bool_],
    x: float,
    y: float,
    heading: float,
    rays: NDArray[np.float64],
    marks: NDArray[np.int64],
    mark: int,
    seen: NDArray[np.int64],
) -> int:
    """All walls in the cells that the columns' middle rays pass on their way to the first full wall, in ascending order.

    marks: (n,) scratch, none of it equal to `mark`. seen: (>= n,) is filled with the walls' numbers. Returns how many.
    """
    n = 0
    cos, sin = math.cos(heading), math.sin(heading)
    for column_of_image in range(rays.shape[0] - 1):
        ahead, left = rays[column_of_image, 0, 0], rays[column_of_image, 0, 1]
        ux, uy = ahead * cos - left * sin, ahead * sin + left * cos
        inside, column, row, next_x, next_y = enter(index, x, y, ux, uy)
        if not inside:
            continue
        step_x, step_y = (1 if ux > 0.0 else -1), (1 if uy > 0.0 else -1)
        per_x = index.cell / abs(ux) if ux != 0.0 else FAR
        per_y = index.cell / abs(uy) if uy != 0.0 else FAR
        stop = FAR
        while 0 <= column < index.n_x and 0 <= row < index.n_y:
            c = row * index.n_x + column
            for k in range(index.first[c], index.first[c + 1]):
                i = index.items[k]
                if marks[i] != mark:
                    marks[i] = mark
                    seen[n] = i
                    n += 1
                if full[i]:
                    t, s = crossing(index.segments, i, x, y, ux, uy)
                    if t > NEAR_M and _WITHIN < s < 1.0 - _WITHIN:
                        stop = min(stop, t)
            if stop <= min(next_x, next_y):
                break
            if next_x < next_y:
                column += step_x
                next_x += per_x
            else:
                row += step_y
                next_y += per_y
    seen[:n].sort()
    return n


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


@njit(cache=True, nogil=True)
def round_hits(
    segments: NDArray[np.float64],
    full: NDArray[np.bool_],
    chosen: NDArray[np.int64],
    x: float,
    y: float,
    heading: float,
    rays: NDArray[np.float64],
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    hits: NDArray[np.float64],
) -> None:
    """`column_hits` for a round lens: inverse distance instead of inverse depth."""
    cos, sin = math.cos(heading), math.sin(heading)
    counts[:] = 0
    for c in range(counts.size):
        ux, uy = rays[c, 0, 0] * cos - rays[c, 0, 1] * sin, rays[c, 0, 0] * sin + rays[c, 0, 1] * cos
        for i in chosen:
            t, s = crossing(segments, i, x, y, ux, uy)
            if t < NEAR_M or t >= FAR:
                continue
            n, inverse = counts[c], 1.0 / t
            beyond = inverse * (1.0 - SAME)
            if n > 0 and hits[c, n - 1, 0] >= beyond and (n == MAX_HITS or full[walls[c, n - 1] >> 1]):
                continue
            left = _along(segments, i, x, y, rays[c, 1], cos, sin, s)
            right = _along(segments, i, x, y, rays[c + 1, 1], cos, sin, s)
            k = min(n, MAX_HITS - 1)
            while k > 0 and hits[c, k - 1, 0] < beyond:
                walls[c, k] = walls[c, k - 1]
                for part in range(3):  # one by one: copying rows takes numba three seconds to compile
                    hits[c, k, part] = hits[c, k - 1, part]
                k -= 1
            ax, ay = segments[i, 0] - x, segments[i, 1] - y
            bx, by = segments[i, 2] - x, segments[i, 3] - y
            walls[c, k] = 2 * i + (0 if ax * by - ay * bx > 0.0 else 1)
            hits[c, k, 0], hits[c, k, 1], hits[c, k, 2] = inverse, min(left, right), max(left, right)
            counts[c] = k + 1 if full[i] else min(n + 1, MAX_HITS)


@njit(cache=True, nogil=True)
def _along(
    segments: NDArray[np.float64],
    i: int,
    x: float,
    y: float,
    ray: NDArray[np.float64],
    cos: float,
    sin: float,
    middle: float,
) -> float:
    """Where the ray of a column's edge meets a wall, as a fraction of its length, limited to the wall's ends."""
    ux, uy = ray[0] * cos - ray[1] * sin, ray[0] * sin + ray[1] * cos
    px, py = segments[i, 0] - x, segments[i, 1] - y
    ex, ey = segments[i, 2] - segments[i, 0], segments[i, 3] - segments[i, 1]
    cross = ux * ey - uy * ex
    if cross == 0.0 or (px * ey - py * ex) / cross <= 0.0:
        return middle
    return min(max((px * uy - py * ux) / cross, 0.0), 1.0)
