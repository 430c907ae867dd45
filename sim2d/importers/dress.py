"""Paint, posters, doors, shelves: bare walls get looks of their own, from a seed, so that a camera can tell them apart."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim2d.world import Panel, Rgb, Wall

HEIGHT_M = 2.6
_PAINTS: tuple[Rgb, ...] = (
    (207, 198, 178), (169, 185, 192), (196, 204, 190), (214, 186, 160), (150, 160, 176), (222, 220, 212),
    (176, 156, 140), (132, 150, 140),
)  # fmt: skip
_COLOURS: tuple[Rgb, ...] = (
    (166, 123, 75), (0, 72, 113), (45, 45, 55), (166, 164, 157), (204, 121, 167), (240, 228, 66), (213, 94, 0),
    (0, 114, 78), (235, 235, 228), (92, 70, 48), (86, 180, 233), (110, 24, 40),
)  # fmt: skip
# texture: chance, width, lower edge, upper edge (m, least and most)
_KINDS = {
    "poster": (0.4, (0.4, 1.1), (0.1, 0.6), (1.1, 1.7)),
    "shelf": (0.14, (0.5, 0.9), (0.05, 0.2), (1.2, 1.9)),
    "cabinet": (0.14, (0.45, 0.7), (0.02, 0.03), (1.0, 1.5)),
    "board": (0.1, (0.8, 1.2), (0.4, 0.7), (1.5, 1.8)),
    "door": (0.1, (0.8, 1.0), (0.0, 0.0), (2.0, 2.1)),
    "window": (0.12, (0.7, 1.2), (0.3, 0.7), (1.7, 2.1)),
}
_SHORT_M = 0.55  # what is shorter has room for paint alone


def dress(
    rings: list[NDArray[np.float64]], sides: list[str], outer: int, rng: np.random.Generator, height: float = HEIGHT_M
) -> tuple[Wall, ...]:
    """Walls along closed rings or open lines of points (k, 2), metres; a ring ends at the point where it began.

    sides: for each ring the side that is seen, "left", "right" or "both". outer: so many of the rings are the outline.
    """
    seeds = iter(range(int(rng.integers(1 << 20)) << 20, 1 << 62))
    walls: list[Wall] = []
    for number, (ring, side) in enumerate(zip(rings, sides, strict=True)):
        paint = _PAINTS[int(rng.integers(len(_PAINTS)))]
        patch, left = paint, 0.0
        for (x1, y1), (x2, y2) in zip(ring[:-1].tolist(), ring[1:].tolist(), strict=True):
            length = math.hypot(x2 - x1, y2 - y1)
            if left <= 0.0:  # along a row of short walls the paint changes now and then
                patch, left = _tone(rng, _COLOURS if rng.random() < 0.5 else _PAINTS), float(rng.uniform(0.3, 1.0))
            left -= length
            bare = length >= _SHORT_M
            panels = tuple(_panels(length, side, height, rng, seeds)) if bare else ()
            colour = paint if bare else patch
            walls.append(Wall(x1, y1, x2, y2, "wall", height, colour, number < outer, 0.0, panels))
    return tuple(walls)


def _panels(length: float, side: str, height: float, rng: np.random.Generator, seeds):
    """About one and a tenth a metre, with gaps between them."""
    names = list(_KINDS)
    chances = np.array([_KINDS[name][0] for name in names])
    at = round(float(rng.uniform(0.05, 0.25)), 3)
    while at + 0.35 < length:
        name = names[int(rng.choice(len(names), p=chances / chances.sum()))]
        _, widths, lows, highs = _KINDS[name]
        width = min(round(float(rng.uniform(*widths)), 2), math.floor((length - at) * 100 + 1e-9) / 100)
        if width >= min(widths[0], 0.5 * length):
            low = round(float(rng.uniform(*lows)), 2)
            high = min(round(float(rng.uniform(*highs)), 2), height)
            yield Panel(at, width, low, high, name, _tone(rng, _COLOURS), next(seeds), side)
        at = round(at + width + float(rng.uniform(0.1, 0.45)), 3)


def _tone(rng: np.random.Generator, colours: tuple[Rgb, ...]) -> Rgb:
    """One of them, lighter or darker: no two alike."""
    base = np.array(colours[int(rng.integers(len(colours)))]) * rng.uniform(0.75, 1.12)
    r, g, b = (int(min(level, 255)) for level in base)
    return r, g, b
