"""All textures of a world in one array, made for the camera: summed along the wall, halved in height level by level.

A pixel's footprint on a wall seen askance is long along the wall. With sums along the wall the mean over any stretch
costs two look-ups (Crow 1984, one-dimensional), and with halved rows the mean in height costs one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim2d.texture import TEXEL_M, paint_strip
from sim2d.world import Wall

LEVELS = 5
MOST_FINE_M2 = 1500.0  # with more wall than this the texels grow, so that memory does not
MIDDLE = 128.0  # taken off before summing: the sums stay small and float32 keeps them exact enough


@dataclass(frozen=True, slots=True, eq=False)
class Atlas:
    """Strip 2 i is the left side of wall i, 2 i + 1 its right side; equal sides share texels.

    texels: float32, flat; a strip at a level is (columns + 1, rows >> level, 3), summed along the columns.
    first: (2 n, LEVELS) where a strip's level begins. columns, rows: (2 n,) at level 0.
    """

    texels: NDArray[np.float32]
    first: NDArray[np.int64]
    columns: NDArray[np.int64]
    rows: NDArray[np.int64]


def build_atlas(walls: tuple[Wall, ...]) -> Atlas:
    """Paint every wall; those that look alike share their texels."""
    area = sum(wall.length * (wall.height - wall.bottom) for wall in walls)
    large = area > MOST_FINE_M2
    texel_m = TEXEL_M * math.sqrt(area / MOST_FINE_M2) if large else TEXEL_M
    pieces: list[NDArray[np.float32]] = []
    known: dict[object, tuple[NDArray[np.int64], int, int]] = {}
    first = np.zeros((2 * len(walls), LEVELS), np.int64)
    columns, rows = np.zeros(len(first), np.int64), np.zeros(len(first), np.int64)
    end = 0
    for strip in range(len(first)):
        wall, side = walls[strip // 2], ("left", "right")[strip % 2]
        panels = tuple(panel for panel in wall.panels if panel.side in (side, "both"))
        plain = large and not panels  # the same all along: one column will do
        look = (0.0 if plain else wall.length, wall.kind, wall.height, wall.bottom, wall.colour, panels)
        if look not in known:
            texels = paint_strip(wall, side, texel_m)
            if plain:
                texels = texels[:1]
            begins = np.zeros(LEVELS, np.int64)
            shape = texels.shape[:2]
            for level in range(LEVELS):
                begins[level] = end
                pieces.append(_summed(texels).ravel())
                end += pieces[-1].size
                if level + 1 < LEVELS:
                    texels = 0.5 * (texels[:, 0::2] + texels[:, 1::2])
            known[look] = (begins, *shape)
        first[strip], columns[strip], rows[strip] = known[look]
    return Atlas(np.concatenate(pieces), first, columns, rows)


def _summed(texels: NDArray[np.float32]) -> NDArray[np.float32]:
    sums = np.zeros((texels.shape[0] + 1, *texels.shape[1:]), np.float64)
    np.cumsum(texels - MIDDLE, axis=0, out=sums[1:])
    return sums.astype(np.float32)
