"""All textures of a world in one array, made for the camera: summed along the wall, halved in height level by level.

A side of a wall is painted when the camera first sees it: a world of 10,000 walls would take five seconds otherwise.

A pixel's footprint on a wall seen askance is long along the wall. With sums along the wall the mean over any stretch
costs two look-ups (Crow 1984, one-dimensional), and with halved rows the mean in height costs one.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.texture import TEXEL_M, paint_strip, strip_shape
from sim2d.world import Wall

LEVELS = 5
MOST_FINE_M2 = 1500.0  # with more wall than this the texels grow, so that memory does not
_SIDES = ("left", "right")
MIDDLE = 128.0  # taken off before summing: the sums stay small and float32 keeps them exact enough


class Atlas:
    """Strip 2 i is the left side of wall i, 2 i + 1 its right side; equal sides share texels.

    texels: float32, flat; a strip at a level is (columns + 1, rows >> level, 3), summed along the columns.
    first: (2 n, LEVELS) where a strip's level begins. columns, rows: (2 n,) at level 0.
    """

    def __init__(self, walls: tuple[Wall, ...]) -> None:
        area = sum(wall.length * (wall.height - wall.bottom) for wall in walls)
        self._walls, self._large = walls, area > MOST_FINE_M2
        self._texel_m = TEXEL_M * math.sqrt(area / MOST_FINE_M2) if self._large else TEXEL_M
        n = 2 * len(walls)
        self.first = np.zeros((n, LEVELS), np.int64)
        self.columns, self.rows = np.zeros(n, np.int64), np.zeros(n, np.int64)
        self._owner = np.zeros(n, np.int64)  # the strip whose texels these are
        self._painted = np.zeros(n, np.bool_)
        self._bare = np.zeros(n, np.int64)
        known: dict[object, int] = {}
        end = 0
        for strip in range(n):
            wall, side = walls[strip // 2], _SIDES[strip % 2]
            panels = tuple(panel for panel in wall.panels if panel.side in (side, "both"))
            plain = self._large and not panels  # the same all along: one column will do
            look = (0.0 if plain else wall.length, wall.kind, wall.height, wall.bottom, wall.colour, panels)
            owner = self._owner[strip] = known.setdefault(look, strip)
            if owner != strip:
                self.first[strip] = self.first[owner]
                self.columns[strip], self.rows[strip] = self.columns[owner], self.rows[owner]
                continue
            columns, rows = strip_shape(wall, self._texel_m)
            self.columns[strip], self.rows[strip] = 1 if plain else columns, rows
            for level in range(LEVELS):
                self.first[strip, level] = end
                end += int(self.columns[strip] + 1) * (rows >> level) * 3
        self.texels = np.empty(end, np.float32)  # of what is not painted yet the system keeps no page

    def paint_seen(
        self, counts: NDArray[np.int64], walls: NDArray[np.int64], mirrored: NDArray[np.int64] | None = None
    ) -> None:
        """Paint those strips that a picture needs and that are bare: `column_hits`' answer, `mirrored`'s strips."""
        for strip in self._bare[: _bare(counts, walls, self._owner, self._painted, self._bare)]:
            self._paint(int(strip))
        if mirrored is not None:
            ones = (mirrored >= 0).astype(np.int64)
            for strip in self._bare[: _bare(ones, mirrored[:, None], self._owner, self._painted, self._bare)]:
                self._paint(int(strip))

    def _paint(self, strip: int) -> None:
        texels = paint_strip(self._walls[strip // 2], _SIDES[strip % 2], self._texel_m)[: self.columns[strip]]
        for level in range(LEVELS):
            summed = _summed(texels).ravel()
            begin = self.first[strip, level]
            self.texels[begin : begin + summed.size] = summed
            if level + 1 < LEVELS:
                texels = 0.5 * (texels[:, 0::2] + texels[:, 1::2])


@njit(cache=True, nogil=True)
def _bare(
    counts: NDArray[np.int64],
    walls: NDArray[np.int64],
    owner: NDArray[np.int64],
    painted: NDArray[np.bool_],
    out: NDArray[np.int64],
) -> int:
    """Owners of the strips walls[c, :counts[c]] that are not painted, each once, into `out`; they count as painted then."""
    n = 0
    for c in range(counts.size):
        for k in range(counts[c]):
            strip = owner[walls[c, k]]
            if not painted[strip]:
                painted[strip] = True
                out[n] = strip
                n += 1
    return n


def _summed(texels: NDArray[np.float32]) -> NDArray[np.float32]:
    sums = np.zeros((texels.shape[0] + 1, *texels.shape[1:]), np.float64)
    np.cumsum(texels - MIDDLE, axis=0, out=sums[1:])
    return sums.astype(np.float32)
