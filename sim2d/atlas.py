"""All textures of a world in one array, made for the camera: summed along the wall, halved in height level by level.

A pixel's footprint on a wall seen askance is long along the wall. With sums along the wall the mean over any stretch
costs two look-ups (Crow 1984, one-dimensional), and with halved rows the mean in height costs one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim2d.texture import paint_strip
from sim2d.world import World

LEVELS = 5
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


def build_atlas(world: World) -> Atlas:
    """Paint every wall of a world."""
    pieces: list[NDArray[np.float32]] = []
    first = np.zeros((2 * len(world.walls), LEVELS), np.int64)
    columns, rows = np.zeros(len(first), np.int64), np.zeros(len(first), np.int64)
    end = 0
    for i, wall in enumerate(world.walls):
        left, right = paint_strip(wall, "left"), paint_strip(wall, "right")
        for strip, texels in ((2 * i, left), (2 * i + 1, right)):
            columns[strip], rows[strip] = texels.shape[:2]
            if strip % 2 and np.array_equal(left, right):
                first[strip] = first[strip - 1]
                continue
            for level in range(LEVELS):
                first[strip, level] = end
                pieces.append(_summed(texels).ravel())
                end += pieces[-1].size
                if level + 1 < LEVELS:
                    texels = 0.5 * (texels[:, 0::2] + texels[:, 1::2])
    return Atlas(np.concatenate(pieces), first, columns, rows)


def _summed(texels: NDArray[np.float32]) -> NDArray[np.float32]:
    sums = np.zeros((texels.shape[0] + 1, *texels.shape[1:]), np.float64)
    np.cumsum(texels - MIDDLE, axis=0, out=sums[1:])
    return sums.astype(np.float32)
