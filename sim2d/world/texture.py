"""The looks of walls: paint, skirting, and the patterns of panels. Each side of a wall is painted once."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from sim2d.world.world import Panel, Rgb, Wall

TEXEL_M = 0.03
ROW_MULTIPLE = 16  # the number of rows is a multiple of 16, so that it can be halved four times
Texture = Literal["paint", "poster", "board", "door", "window", "shelf", "cabinet", "screen"]
TEXTURES = get_args(Texture)

_SKIRTING_M = 0.1
_Texels = NDArray[np.float32]


def strip_shape(wall: Wall, texel_m: float = TEXEL_M) -> tuple[int, int]:
    """The number of texel columns along the wall and of rows from its top to its bottom."""
    columns = max(1, round(wall.length / texel_m))
    rows = ROW_MULTIPLE * max(1, round((wall.height - wall.bottom) / texel_m / ROW_MULTIPLE))
    return columns, rows


def paint_strip(wall: Wall, side: str, texel_m: float = TEXEL_M) -> _Texels:
    """One side of a wall as texels: (columns, rows, 3), 0 to 255, top row first."""
    columns, rows = strip_shape(wall, texel_m)
    height = wall.height - wall.bottom
    up = wall.height - (np.arange(rows) + 0.5) * height / rows  # height of each row's middle, m
    tone = 0.94 + 0.06 * up / wall.height  # brighter towards the lamps on the ceiling
    strip = np.empty((columns, rows, 3), np.float32)
    strip[:] = np.asarray(wall.colour, np.float32) * tone[:, None]
    if wall.kind in ("wall", "partition"):
        strip[:, up < _SKIRTING_M] *= 0.55
    if wall.kind == "partition":
        strip[:, up > wall.height - 0.05] *= 0.6  # its rail
    for panel in wall.panels:
        if panel.side in (side, "both"):
            _hang(strip, wall, panel)
    return strip


@lru_cache(maxsize=16_384)
def panel_mean_rgb(panel: Panel) -> Rgb:
    """The panel's mean colour, for drawing it in one flat colour."""
    mean = _pattern(panel, max(1, round(panel.width / TEXEL_M)), 32).mean(axis=(0, 1))
    return int(mean[0]), int(mean[1]), int(mean[2])


def _hang(strip: _Texels, wall: Wall, panel: Panel) -> None:
    columns, rows = strip.shape[:2]
    scale = rows / (wall.height - wall.bottom)
    left = min(round(panel.at / wall.length * columns), columns - 1)
    right = max(left + 1, round((panel.at + panel.width) / wall.length * columns))
    high = min(round((wall.height - panel.top) * scale), rows - 1)
    low = max(high + 1, round((wall.height - panel.bottom) * scale))
    strip[left:right, high:low] = _pattern(panel, right - left, low - high)


def _pattern(panel: Panel, columns: int, rows: int) -> _Texels:
    """(columns, rows, 3), 0 to 255. The panel's seed decides the details, so its picture is always the same."""
    rng = np.random.default_rng(panel.seed)
    out = np.empty((columns, rows, 3), np.float32)
    out[:] = panel.colour
    _PATTERNS[panel.texture](out, rng)
    return np.clip(out, 0.0, 255.0)


def _box(out: _Texels, left: float, right: float, high: float, low: float) -> _Texels:
    """The part of a picture between fractions of its width and of its height (0 = top), at least one texel in size."""
    columns, rows = out.shape[:2]
    i, k = int(left * columns), int(high * rows)
    return out[i : max(i + 1, round(right * columns)), k : max(k + 1, round(low * rows))]


def _paint(out: _Texels, rng: np.random.Generator) -> None:
    """A stretch of wall in another tone."""


def _poster(out: _Texels, rng: np.random.Generator) -> None:
    """A pale or dark frame, two to four blocks and a line of title."""
    own = out[0, 0].copy()
    ink = _rgb(20, 22, 30) if own.mean() > 110 else _rgb(238, 236, 226)
    for _ in range(int(rng.integers(2, 5))):
        left, high = rng.uniform(0.05, 0.6, 2)
        mix = rng.uniform(0.35, 1.0)
        block = _box(out, left, left + rng.uniform(0.25, 0.4), high, high + rng.uniform(0.15, 0.35))
        block[:] = own * (1 - mix) + ink * mix
    _box(out, 0.12, 0.88, 0.06, 0.12)[:] = ink
    out[[0, -1]] = ink


def _board(out: _Texels, rng: np.random.Generator) -> None:
    """A whiteboard with a frame, lines of writing and a sketch."""
    ink = _rgb(40, 60, 120)
    for high in np.arange(0.12, 0.6, 0.11):
        _box(out, 0.08, rng.uniform(0.25, 0.6), high, high + 0.04)[:] = ink
    _box(out, 0.68, 0.9, 0.2, 0.55)[:] = rng.uniform(60, 170, 3)
    _frame(out, _rgb(90, 92, 96))


def _door(out: _Texels, rng: np.random.Generator) -> None:
    """A leaf in a dark frame, two sunken fields, a handle."""
    shade = rng.uniform(0.72, 0.86)
    _box(out, 0.18, 0.82, 0.08, 0.45)[:] *= shade
    _box(out, 0.18, 0.82, 0.55, 0.92)[:] *= shade
    _box(out, 0.8, 0.9, 0.48, 0.52)[:] = (225, 222, 205)
    _frame(out, out[0, 0] * 0.45)


def _window(out: _Texels, rng: np.random.Generator) -> None:
    """Bright sky over a skyline, a white frame with a cross."""
    rows = out.shape[1]
    sky = np.linspace(1.0, 1.18, rows, dtype=np.float32)
    out *= sky[:, None]
    left = 0.0
    while left < 1.0:
        right = left + rng.uniform(0.12, 0.35)
        _box(out, left, min(right, 1.0), rng.uniform(0.5, 0.85), 1.0)[:] = _rgb(96, 108, 104) * rng.uniform(0.6, 1.3)
        left = right
    white = _rgb(246, 246, 240)
    middle = rng.uniform(0.35, 0.65)
    _box(out, middle, middle + 0.03, 0.0, 1.0)[:] = white
    _frame(out, white)


def _shelf(out: _Texels, rng: np.random.Generator) -> None:
    """Boards with backs of books in runs of one colour."""
    floors = max(2, out.shape[1] // 14)
    back = out[0, 0] * 0.35
    for k in range(floors):
        high, low = k / floors, (k + 1) / floors
        _box(out, 0.04, 0.96, high + 0.02, low - 0.02)[:] = back
        left = 0.05
        while left < 0.9:
            right = left + rng.uniform(0.1, 0.3)
            books = _box(out, left, min(right, 0.95), low - rng.uniform(0.55, 0.85) / floors, low - 0.02)
            books[:] = _rgb(*_BOOKS[int(rng.integers(len(_BOOKS)))]) * rng.uniform(0.7, 1.1)
            left = right + (rng.uniform(0.05, 0.2) if rng.random() < 0.3 else 0.0)


def _cabinet(out: _Texels, rng: np.random.Generator) -> None:
    """Drawers with dark gaps and handles."""
    drawers = int(rng.integers(2, 5))
    for k in range(drawers):
        _box(out, 0.0, 1.0, k / drawers, k / drawers + 0.02)[:] *= 0.4
        _box(out, 0.35, 0.65, (k + 0.35) / drawers, (k + 0.5) / drawers)[:] = (40, 40, 44)
    out[[0, -1]] *= 0.5


def _screen(out: _Texels, rng: np.random.Generator) -> None:
    """A lit screen in a black frame with two windows on it."""
    _box(out, 0.1, rng.uniform(0.45, 0.6), 0.15, rng.uniform(0.5, 0.8))[:] = rng.uniform(120, 250, 3)
    _box(out, 0.6, 0.92, 0.3, 0.85)[:] = rng.uniform(30, 160, 3)
    _frame(out, _rgb(18, 18, 22))


def _rgb(*levels: float) -> _Texels:
    return np.array(levels, np.float32)


def _frame(out: _Texels, colour: _Texels) -> None:
    out[[0, -1]] = colour
    out[:, [0, -1]] = colour


_BOOKS = ((213, 94, 0), (0, 114, 178), (240, 228, 66), (0, 158, 115), (235, 232, 220), (60, 60, 70), (204, 121, 167))
_PATTERNS = {
    "paint": _paint, "poster": _poster, "board": _board, "door": _door,
    "window": _window, "shelf": _shelf, "cabinet": _cabinet, "screen": _screen,
}  # fmt: skip
