"""Sonars and laser: the nearest echo within each cone, and the first thing on each beam that is not glass."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.geometry.wall_index import WallIndex, crossing, first_wall, nearest_within, squared_distance

# From left to right, as on the front of a Pioneer.
SONAR_ANGLES_RAD: tuple[float, ...] = tuple(math.radians(a) for a in (90, 50, 30, 10, -10, -30, -50, -90))

_Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
def sonar_ranges(
    index: WallIndex,
    elements: _Array,
    x: float,
    y: float,
    heading: float,
    angles: _Array,
    cone: float,
    rays: int,
    farthest: float,
    errors: _Array,
    touch: float,
) -> tuple[NDArray[np.float32], bool]:
    """(n,): distance (m) from the robot's middle to the nearest echo on the rays of each cone; `farthest` if there
    is none.

    Also returns whether anything is nearer than `touch` metres to the middle, in any direction.
    elements: (m, 4) sides of actors, besides the walls of the index. errors: (n,) added to each echo (m).
    """
    near = within(elements, x, y, farthest)
    out = np.empty(angles.size, np.float32)
    for i in range(angles.size):
        shortest = farthest
        for k in range(rays):
            angle = heading + angles[i] + cone * (k / (rays - 1) - 0.5)
            shortest = _range(index, near, x, y, angle, shortest)
        if shortest < farthest:
            shortest = min(max(shortest + errors[i], 0.0), farthest)
        out[i] = shortest
    return out, not is_clear(index, near, x, y, touch)


@njit(cache=True, nogil=True)
def is_clear(index: WallIndex, elements: _Array, x: float, y: float, reach: float) -> bool:
    """Whether no wall of the index and none of the (m, 4) elements is nearer than `reach` metres to (x, y)."""
    for i in range(elements.shape[0]):
        if squared_distance(elements, i, x, y) < reach * reach:
            return False
    return nearest_within(index, x, y, reach) >= reach


@njit(cache=True, nogil=True)
def laser_ranges(
    index: WallIndex,
    elements: _Array,
    x: float,
    y: float,
    heading: float,
    fov: float,
    farthest: float,
    errors: _Array,
) -> NDArray[np.float32]:
    """(n,), from left to right: distance (m) to the first thing on each beam; `farthest` if there is none.

    index: of the walls that are not glass, since a laser passes through glass. errors: (n,) added to what is measured
    (m).
    """
    n = errors.size
    near = within(elements, x, y, farthest)
    step = fov / n if fov > 2.0 * math.pi - 1e-9 else fov / max(n - 1, 1)
    out = np.empty(n, np.float32)
    for i in range(n):
        length = _range(index, near, x, y, heading + 0.5 * fov - i * step, farthest)
        out[i] = min(max(length + errors[i], 0.0), farthest) if length < farthest else farthest
    return out


@njit(cache=True, nogil=True, inline="always")
def _range(index: WallIndex, near: _Array, x: float, y: float, angle: float, farthest: float) -> float:
    ux, uy = math.cos(angle), math.sin(angle)
    shortest = first_wall(index, x, y, ux, uy, farthest)[1]
    for i in range(near.shape[0]):
        shortest = min(shortest, crossing(near, i, x, y, ux, uy)[0])
    return shortest


@njit(cache=True, nogil=True)
def within(segments: _Array, x: float, y: float, reach: float) -> _Array:
    """Those of the (m, 4) segments whose bounding box is within `reach` metres of (x, y) in both axes."""
    out = np.empty_like(segments)
    n = 0
    for i in range(segments.shape[0]):
        if (
            min(segments[i, 0], segments[i, 2]) <= x + reach
            and max(segments[i, 0], segments[i, 2]) >= x - reach
            and min(segments[i, 1], segments[i, 3]) <= y + reach
            and max(segments[i, 1], segments[i, 3]) >= y - reach
        ):
            for k in range(4):
                out[n, k] = segments[i, k]
            n += 1
    return out[:n]
