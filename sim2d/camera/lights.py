"""Brightness over the floor: daylight everywhere, plus each lamp that is on, where no wall hides it."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.geometry.segments import differing
from sim2d.geometry.wall_index import WallIndex, first_wall
from sim2d.world.elements import Lamp
from sim2d.world.world import World

_CELL_M = 0.25
_MOST_CELLS = 1_000_000
_STEP_BACK_M = 0.15  # a wall is as bright as the floor this far in front of it

Spot = tuple[slice, slice, NDArray[np.float64]]  # rows and columns of the grid, and the light there


class Lights:
    """The light of the lamps of one world, on a grid over its floor. A world without lamps has no grid."""

    def __init__(self, world: World, index: WallIndex, before: Lights | None = None) -> None:
        """before: of a world that may differ in a few walls; lamps that none of these is near are taken over."""
        x0, y0, x1, y1 = world.bounds
        self._lamps = world.lamps
        self._cell = max(_CELL_M, math.sqrt((x1 - x0) * (y1 - y0) / _MOST_CELLS))
        self._corner = (x0, y0)
        self._shape = (int((y1 - y0) / self._cell) + 2, int((x1 - x0) / self._cell) + 2) if world.lamps else (0, 0)
        self._segments = index.segments
        known = {} if before is None else self._unchanged(before)
        self._spots = [known.get(lamp) or self._spot(lamp, index) for lamp in world.lamps]
        self._on: tuple[bool, ...] = ()
        self._total = np.zeros(self._shape)

    def glow(
        self,
        lamp_on: NDArray[np.bool_],
        daylight: float,
        eye: tuple[float, float, float],
        rays: NDArray[np.float64],
        counts: NDArray[np.int64],
        hits: NDArray[np.float64],
        out: NDArray[np.float64],
    ) -> None:
        """Fill out, (w, k + 1): the brightness of every hit and, last, of each column's floor and ceiling."""
        if not self._lamps:
            out[:] = daylight
            return
        on = tuple(lamp_on.tolist())
        if on != self._on:
            self._on = on
            self._total = np.zeros(self._shape)
            for is_on, (rows, columns, light) in zip(on, self._spots, strict=True):
                if is_on:
                    self._total[rows, columns] += light
        _glow(self._total, *self._corner, self._cell, daylight, *eye, rays, counts, hits, out)

    def _unchanged(self, before: Lights) -> dict[Lamp, Spot]:
        """The light of those lamps in whose reach no wall has changed."""
        if (before._cell, before._corner, before._shape) != (self._cell, self._corner, self._shape):
            return {}
        changed = np.array(differing(before._segments, self._segments)).reshape(-1, 2, 2)
        low, high = changed.min(axis=1), changed.max(axis=1)
        return {
            lamp: spot
            for lamp, spot in zip(before._lamps, before._spots, strict=True)
            if not ((low <= np.add((lamp.x, lamp.y), lamp.reach)) & (high >= np.subtract((lamp.x, lamp.y), lamp.reach)))
            .all(axis=1)
            .any()
        }

    def _spot(self, lamp: Lamp, index: WallIndex) -> Spot:
        """The part of the grid that a lamp reaches, and its light: b (1 - (d / reach)^2)^2 if no wall hides it."""
        x0, y0 = self._corner
        left, low = (max(0, int((p - lamp.reach - q) / self._cell)) for p, q in ((lamp.x, x0), (lamp.y, y0)))
        right = min(self._shape[1], int((lamp.x + lamp.reach - x0) / self._cell) + 1)
        high = min(self._shape[0], int((lamp.y + lamp.reach - y0) / self._cell) + 1)
        xs = np.asarray(x0 + (np.arange(left, right) + 0.5) * self._cell, np.float64)
        ys = np.asarray(y0 + (np.arange(low, high) + 0.5) * self._cell, np.float64)
        light = _lamp_light(index, lamp.x, lamp.y, lamp.reach, lamp.brightness, xs, ys)
        return slice(low, high), slice(left, right), light


@njit(cache=True, nogil=True)
def _lamp_light(
    index: WallIndex,
    x: float,
    y: float,
    reach: float,
    brightness: float,
    xs: NDArray[np.float64],
    ys: NDArray[np.float64],
) -> NDArray[np.float64]:
    out = np.zeros((ys.size, xs.size))
    for j in range(ys.size):
        for i in range(xs.size):
            dx, dy = xs[i] - x, ys[j] - y
            share = (dx * dx + dy * dy) / (reach * reach)
            if share < 1.0 and first_wall(index, x, y, dx, dy, 1.0)[1] >= 1.0:
                out[j, i] = brightness * (1.0 - share) ** 2
    return out


@njit(cache=True, nogil=True)
def _glow(
    total: NDArray[np.float64],
    x0: float,
    y0: float,
    cell: float,
    daylight: float,
    x: float,
    y: float,
    heading: float,
    rays: NDArray[np.float64],
    counts: NDArray[np.int64],
    hits: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    cos, sin = math.cos(heading), math.sin(heading)
    here = _at(total, (x - x0) / cell, (y - y0) / cell)
    for c in range(counts.size):
        ux, uy = rays[c, 0, 0] * cos - rays[c, 0, 1] * sin, rays[c, 0, 0] * sin + rays[c, 0, 1] * cos
        back = _STEP_BACK_M / math.hypot(ux, uy)
        light = here
        for k in range(counts[c]):
            t = max(1.0 / hits[c, k, 0] - back, 0.0)
            light = _at(total, (x + t * ux - x0) / cell, (y + t * uy - y0) / cell)
            out[c, k] = daylight + light
        out[c, out.shape[1] - 1] = daylight + 0.5 * (here + light)


@njit(cache=True, nogil=True)
def _at(total: NDArray[np.float64], u: float, v: float) -> float:
    """Bilinear interpolation between the centres of the four nearest cells."""
    u, v = min(max(u - 0.5, 0.0), total.shape[1] - 1.001), min(max(v - 0.5, 0.0), total.shape[0] - 1.001)
    i, j = int(u), int(v)
    f, g = u - i, v - j
    low = total[j, i] * (1.0 - f) + total[j, i + 1] * f
    high = total[j + 1, i] * (1.0 - f) + total[j + 1, i + 1] * f
    return low * (1.0 - g) + high * g
