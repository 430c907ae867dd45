"""From a picture to walls: which part of it is the floor, where a robot may start on it, and the borders of the floor.

The borders are traced along the pixels, then simplified within a tolerance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.world.world_file import WorldError

STARTS = 4
_AMPLE_M = 0.6  # distance from a start to the nearest wall, where there is room for it
_TURNS = 16  # headings tried for a start
_DX = np.array([1, 0, -1, 0])
_DY = np.array([0, 1, 0, -1])


def choose_floor(name: str, free: NDArray[np.bool_], scale_m: float, radius_m: float) -> Floor:
    """The largest connected part of `free` (row 0 at the bottom) on which a robot of this radius can drive.

    [ours] A part that covers most of the picture's rim is taken for the paper around the plan, unless it is more than
    ten times as large as every other part: test_picture_maps.py::test_the_paper_around_a_plan_is_not_its_floor.
    """
    clear = cv2.distanceTransform(np.pad(free, 1).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    clear_m = (clear - 1.5) * scale_m  # to the pixel's edge, less one pixel, since simplified walls may stray by that
    count, rooms = _components(clear_m >= radius_m, 8)
    if count == 1:
        raise WorldError(
            f"{name}: no place where a robot of {radius_m:g} m radius fits: the widest is {2 * clear.max() * scale_m:.2f} m "
            f"across, of {free.sum()} free pixels of {scale_m:g} m; is the scale right, and the floor light?"
        )
    sizes = np.bincount(rooms.ravel(), minlength=count)
    sizes[0] = 0
    _, parts = _components(free, 4)
    rim = np.concatenate([parts[0], parts[-1], parts[:, 0], parts[:, -1]])
    room = int(np.argmax(sizes))
    paper = int(parts[rooms == room][0])
    if (rim == paper).mean() > 0.5:
        others = np.where(np.isin(np.arange(count), rooms[parts == paper]), 0, sizes)
        if others.max() * 10 >= sizes[room]:
            room = int(np.argmax(others))
    part = int(parts[rooms == room][0])
    return Floor(parts == part, _starts(free, rooms == room, clear_m, scale_m))


@dataclass(frozen=True, slots=True, eq=False)
class Floor:
    """mask: the pixels of the chosen floor, row 0 at the bottom. starts: (k, 3) column, row, heading (rad), in pixels."""

    mask: NDArray[np.bool_]
    starts: NDArray[np.float64]


def _components(cells: NDArray[np.bool_], connectivity: int) -> tuple[int, NDArray[np.int32]]:
    """The number of connected parts, counting part 0 (cells in none), and the part of each cell."""
    count, parts = cv2.connectedComponents(cells.astype(np.uint8), connectivity=connectivity)
    return count, np.asarray(parts, np.int32)


def _starts(
    free: NDArray[np.bool_], room: NDArray[np.bool_], clear_m: NDArray[np.float32], scale_m: float
) -> NDArray[np.float64]:
    """(k, 3) starts with ample room: the first near the middle, each other as far as possible from those before."""
    ample = room & (clear_m >= min(_AMPLE_M, 0.8 * float(clear_m[room].max())))
    rows, columns = np.nonzero(ample)
    away = np.hypot(columns - np.median(columns), rows - np.median(rows))
    chosen = [int(np.argmin(away))]
    away = np.hypot(columns - columns[chosen[0]], rows - rows[chosen[0]])
    while len(chosen) < STARTS and away.max() * scale_m > 2.0:
        chosen.append(int(np.argmax(away)))
        away = np.minimum(away, np.hypot(columns - columns[chosen[-1]], rows - rows[chosen[-1]]))
    return np.array([(columns[k] + 0.5, rows[k] + 0.5, _longest(free, columns[k], rows[k])) for k in chosen])


def _longest(free: NDArray[np.bool_], column: int, row: int) -> float:
    """Of so many headings (rad), the one with the longest free way."""
    best, best_way = 0.0, -1
    for k in range(_TURNS):
        angle = 2 * math.pi * k / _TURNS
        ways = np.arange(1, int(max(free.shape)))
        x = np.rint(column + ways * math.cos(angle)).astype(int)
        y = np.rint(row + ways * math.sin(angle)).astype(int)
        inside = (x >= 0) & (y >= 0) & (x < free.shape[1]) & (y < free.shape[0])
        hit = ~free[y[inside], x[inside]]
        way = int(np.argmax(hit)) if hit.any() else int(inside.sum())
        if way > best_way:
            best, best_way = angle, way
    return best


def trace(floor: NDArray[np.bool_]) -> list[NDArray[np.int32]]:
    """The borders of the floor as closed rings of corners (k, 2), pixels; row 0 is at the bottom, pixel (0, 0) spans 0 to 1.

    The rings run along the edges of pixels with the floor on their left: counter-clockwise around the floor, clockwise
    around obstacles. Obstacles that touch at a corner are connected, so a slanting line of single pixels is a closed
    wall.
    """
    padded = np.zeros((floor.shape[0] + 2, floor.shape[1] + 2), np.bool_)
    padded[1:-1, 1:-1] = floor
    flat, ends = _follow(padded)
    return [flat[begin:end] for begin, end in zip([0, *ends[:-1]], ends, strict=True)] if len(ends) else []


@njit(cache=True, nogil=True)
def _follow(floor: NDArray[np.bool_]) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """All rings of a padded picture, one after the other, and where each ends. An edge that runs in +x finds each."""
    rows, columns = floor.shape
    walked = np.zeros((rows, columns), np.bool_)  # whether the lower edge of a pixel, which runs in +x, is in a ring
    edges = _edges(floor)
    points = np.empty((edges, 2), np.int32)
    ends = np.empty(edges // 4 + 1, np.int64)
    n = rings = 0
    for row in range(1, rows - 1):
        for column in range(1, columns - 1):
            if not floor[row, column] or floor[row - 1, column] or walked[row, column]:
                continue
            x, y, d, last = column, row, 0, -1
            while not (d == 0 and walked[y, x]):
                if d == 0:
                    walked[y, x] = True
                if d != last:
                    points[n] = x - 1, y - 1
                    n, last = n + 1, d
                x, y = x + _DX[d], y + _DY[d]
                if not _ahead(floor, x, y, d, 1):
                    d = (d + 1) % 4
                elif _ahead(floor, x, y, d, 0):
                    d = (d + 3) % 4
            if last == 0:  # the ring began in the middle of a straight side
                first = 0 if rings == 0 else ends[rings - 1]
                if points[first, 1] == points[n - 1, 1] and n - first > 4:
                    points[first] = points[n - 1]
                    n -= 1
            ends[rings] = n
            rings += 1
    return points[:n], ends[:rings]


@njit(cache=True, nogil=True)
def _edges(floor: NDArray[np.bool_]) -> int:
    """How many edges of pixels lie between floor and not floor."""
    edges = 0
    for j in range(1, floor.shape[0] - 1):
        for i in range(1, floor.shape[1] - 1):
            if floor[j, i]:
                edges += 4 - floor[j - 1, i] - floor[j + 1, i] - floor[j, i - 1] - floor[j, i + 1]
    return edges


@njit(cache=True, nogil=True, inline="always")
def _ahead(floor: NDArray[np.bool_], x: int, y: int, d: int, left: int) -> bool:
    """Whether the pixel ahead of lattice point (x, y), to the left or right of heading d, is floor."""
    if d == 0:
        return floor[y - 1 + left, x]
    if d == 1:
        return floor[y, x - left]
    if d == 2:
        return floor[y - left, x - 1]
    return floor[y - 1, x - 1 + left]


def simplify(ring: NDArray[np.int32], into_floor: float = 1.0, into_wall: float = 1.5) -> NDArray[np.int32]:
    """The ring with the fewest corners, taken from the given ones, that keeps within the tolerances.

    into_floor, into_wall: how far (pixels) it may stray to either side of the border. Imai and Iri 1988: the shortest
    path over all chords within the tolerances, begun at the lowest corner. A thin obstacle may end up as two corners.
    """
    start = int(np.lexsort((ring[:, 0], ring[:, 1]))[0])
    closed = np.concatenate([ring[start:], ring[: start + 1]]).astype(np.float64)
    return closed[_fewest(closed, into_floor, into_wall)].astype(np.int32)


@njit(cache=True, nogil=True)
def _fewest(points: NDArray[np.float64], into_floor: float, into_wall: float) -> NDArray[np.int64]:
    """Numbers of the points on the shortest path from the first point to the last, without the last.

    A chord from point i must pass every point in between so that this lies at most `into_floor` to its right or
    `into_wall` to its left. The wedge of such directions shrinks from point to point; once it is empty, no chord
    reaches farther.
    """
    n = points.shape[0]
    hops = np.full(n, n, np.int64)
    before = np.full(n, -1, np.int64)
    hops[0] = 0
    for i in range(n - 1):
        x, y = points[i]
        low, high, middle, bound, far = -math.pi, math.pi, 0.0, False, 0.0
        for j in range(i + 1, n):
            dx, dy = points[j, 0] - x, points[j, 1] - y
            away = math.hypot(dx, dy)
            angle = _wrap(math.atan2(dy, dx) - middle) if bound else math.atan2(dy, dx)
            open_here = not bound or low <= angle <= high
            if open_here and far <= away + 0.5 * into_floor and away > 0.0 and hops[i] + 1 < hops[j]:
                hops[j], before[j] = hops[i] + 1, i
            far = max(far, away)
            if away <= into_floor:
                continue
            left = math.asin(min(into_wall / away, 1.0))
            right = math.asin(into_floor / away)
            if not bound:
                bound, middle = True, angle
                low, high = -left, right
            else:
                low, high = max(low, angle - left), min(high, angle + right)
            if low > high:
                break
    chosen = np.empty(n, np.int64)
    k, at = n, n - 1
    while before[at] >= 0:
        at = before[at]
        k -= 1
        chosen[k] = at
    return chosen[k:]


@njit(cache=True, nogil=True)
def _wrap(angle: float) -> float:
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


def ring_area(ring: NDArray[np.generic]) -> float:
    """The area that a ring encloses; positive if it runs counter-clockwise."""
    x, y = ring[:, 0].astype(np.float64), ring[:, 1].astype(np.float64)
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
