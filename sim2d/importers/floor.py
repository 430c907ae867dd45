"""Which part of a plan is the floor, and where on it a robot may start."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim2d.world.world_file import WorldError

STARTS = 4
_AMPLE_M = 0.6  # distance from a start to the nearest wall, where there is room for it
_TURNS = 16  # headings tried for a start


@dataclass(frozen=True, slots=True, eq=False)
class Floor:
    """mask: the pixels of the chosen floor, row 0 at the bottom. starts: (k, 3) column, row, heading (rad), in pixels."""

    mask: NDArray[np.bool_]
    starts: NDArray[np.float64]


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
    """Of sixteen headings (rad), the one with the longest free way."""
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
