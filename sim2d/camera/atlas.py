"""All textures of a world in one array, prepared for the camera: summed along the wall, and halved in height, level by
level.

A side of a wall is painted when the camera first sees it. To paint a world of 10,000 walls at once would take five
seconds.

When a wall is seen at a slant, the footprint of a pixel is long in the direction of the wall. With sums along the wall
the mean over any stretch costs two look-ups (Crow 1984, in one dimension). With halved rows the mean over the height
costs one.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.world.texture import ROW_MULTIPLE, TEXEL_M, paint_strip
from sim2d.world.world import Wall

LEVELS = 5
MOST_FINE_M2 = 1500.0  # with more wall area than this, texels become larger to limit the memory
_SIDES = ("left", "right")
MIDDLE = 128.0  # subtracted before summing: the sums stay small, so that float32 is exact enough


class Atlas:
    """Strip 2 i is the left side of wall i, strip 2 i + 1 its right side. Sides that look the same share texels.

    texels: float32, flat; a strip at a level is (columns + 1, rows >> level, 3), summed along the columns.
    first: (2 n, LEVELS) where each level of a strip begins. columns, rows: (2 n,) size of a strip at level 0.
    """

    def __init__(self, walls: tuple[Wall, ...], before: Atlas | None = None) -> None:
        """before: another atlas; for walls that are the same objects, what is known of their looks is taken over, and of
        those that all look the same the texels are shared. Use both from one thread.
        """
        self._walls = walls
        was = {} if before is None else {id(wall): i for i, wall in enumerate(before._walls)}
        old = np.array([was.get(id(wall), -1) for wall in walls], np.int64)
        self._sizes = np.zeros((len(walls), 2))  # length and height, metres
        if before is not None:
            self._sizes = before._sizes[old]
        for i in np.flatnonzero(old < 0).tolist():
            self._sizes[i] = walls[i].length, walls[i].height - walls[i].bottom
        area = sum((self._sizes[:, 0] * self._sizes[:, 1]).tolist())
        self._large = area > MOST_FINE_M2
        self._texel_m = TEXEL_M * math.sqrt(area / MOST_FINE_M2) if self._large else TEXEL_M
        if before is None or before._large != self._large:
            self._known: dict[object, int] = {}  # a look's number
            self._looks, self._plain = np.zeros((len(walls), 2), np.int64), np.zeros((len(walls), 2), np.bool_)
            old[:] = -1
        else:
            self._known, self._looks, self._plain = before._known, before._looks[old], before._plain[old]
        for i in np.flatnonzero(old < 0).tolist():
            for k, side in enumerate(_SIDES):
                self._looks[i, k], self._plain[i, k] = self._look(walls[i], side)
        self._lay_out()
        self._painted, self._bare = np.zeros(2 * len(walls), np.bool_), np.zeros(2 * len(walls), np.int64)
        if before is not None and self._known is before._known and self._looks_like(before):
            self.texels, self._painted = before.texels, before._painted

    def _looks_like(self, other: Atlas) -> bool:
        mine = (self._looks, self.columns, self.rows)
        return all(map(np.array_equal, mine, (other._looks, other.columns, other.rows))) and (
            self._texel_m == other._texel_m
        )

    def _look(self, wall: Wall, side: str) -> tuple[int, bool]:
        """The number of the side's look, and whether it is the same all along, so that one column is enough."""
        panels = tuple(panel for panel in wall.panels if panel.side in (side, "both"))
        plain = self._large and not panels
        look = (0.0 if plain else wall.length, wall.kind, wall.height, wall.bottom, wall.colour, panels)
        return self._known.setdefault(look, len(self._known)), plain

    def _lay_out(self) -> None:
        """Lay out the texels: first, columns, rows, and each strip's owner, the first strip of the same look."""
        _, owners, number = np.unique(self._looks.ravel(), return_index=True, return_inverse=True)
        self._owner = owner = owners[number.ravel()]
        columns = np.maximum(1, np.rint(self._sizes[:, 0] / self._texel_m).astype(np.int64))  # as `strip_shape`
        rows = ROW_MULTIPLE * np.maximum(1, np.rint(self._sizes[:, 1] / self._texel_m / ROW_MULTIPLE).astype(np.int64))
        self.columns = np.where(self._plain, 1, columns[:, None]).ravel()[owner]
        self.rows = np.repeat(rows, 2)[owner]
        own = np.flatnonzero(owner == np.arange(owner.size))
        sizes = 3 * (self.columns[own] + 1)[:, None] * (self.rows[own][:, None] >> np.arange(LEVELS))
        ends = np.cumsum(sizes.ravel())
        first = np.zeros((owner.size, LEVELS), np.int64)
        first[own] = (ends - sizes.ravel()).reshape(sizes.shape)
        self.first = first[owner]
        self.texels = np.empty(ends[-1], np.float32)  # the system gives no memory to pages that are not painted yet

    def paint_seen(
        self, counts: NDArray[np.int64], walls: NDArray[np.int64], mirrored: NDArray[np.int64] | None = None
    ) -> None:
        """Paint the strips that an image needs and that are not painted yet.

        counts, walls: as `column_hits` fills them. mirrored: the strips seen in glass, as `painting.mirrored` fills them.
        """
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
    """Collect in `out` the unpainted owners of strips walls[c, :counts[c]], each once, and mark them painted."""
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
