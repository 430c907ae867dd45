"""Worlds from walls: the last step of every importer, and an empty room as a beginning for drawing one's own office.

Bare walls are decorated with paint, posters, doors and shelves, from a seed, so that a camera can tell them apart.
"""

from __future__ import annotations

import math
import re
import zlib
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import PurePath
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from disk.words import plain
from sim2d.world.world import Lamp, Panel, Rgb, Start, Wall, World
from sim2d.world.world_check import Fault, check_world
from sim2d.world.world_file import WorldError

SMALLEST_M, LARGEST_M = 2.0, 200.0  # sides of an empty room


def plan_world(name: str, walls: tuple[Wall, ...], starts: NDArray[np.float64], what: str, radius_m: float) -> World:
    """Walls and starts become a checked World. starts: (k, 3) x, y (m), heading (rad).

    name: of the file; what: its kind, in words. Raises WorldError if the walls do not make a valid world.
    """
    stem = re.sub(r"[^A-Za-z0-9_-]+", "-", PurePath(name).name.split(".")[0]).strip("-")[:40] or "plan"
    xy = np.array([(w.x1, w.y1) for w in walls])
    size = np.ptp(xy, axis=0)
    world = World(
        name=stem,
        title=f"{stem}, {size[0]:.0f} x {size[1]:.0f} m",
        source=plain(f"imported from {what}, {PurePath(name).name}", 200),
        walls=walls,
        starts=tuple(
            Start(
                "home" if k == 0 else f"start {k + 1}",
                round(x, 3),
                round(y, 3),
                math.radians(round(math.degrees(a), 3)),
            )
            for k, (x, y, a) in enumerate(starts.tolist())
        ),
        places=(),
        floor_colour=(110, 106, 102),
        ceiling_colour=(222, 222, 216),
    )
    try:
        check_world(world, radius_m)
    except Fault as fault:
        where = "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in fault.where).lstrip(".")
        raise WorldError(f"{name}: the walls traced from it make no world: {where}: {fault.message}") from None
    return world


def empty_room(name: str, title: str, width: float, depth: float) -> World:
    """Outer walls from (0, 0) to (width, depth) metres, a lamp in the middle, the start west of it.

    The name is the seed of the walls' looks. ValueError if the room is too small or too large.
    """
    for what, size in (("width", width), ("depth", depth)):
        if not SMALLEST_M <= size <= LARGEST_M:
            raise ValueError(f"{what}: got {size:g} m; must be from {SMALLEST_M:g} to {LARGEST_M:g} m")
    ring = [(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth), (0.0, 0.0)]
    walls = Dresser(zlib.crc32(name.encode())).line(ring, "left", outer=True)
    x, y = 0.5 * width, 0.5 * depth
    lamp = Lamp("lamp 1", x, y, reach=min(max(4.0, x, y), 12.0), brightness=0.5)
    return World(
        name, title, "drawn in the editor", tuple(walls), (Start("start 1", 0.5 * x, y, 0.0),), (), lamps=(lamp,)
    )


Point = tuple[float, float]
Side = Literal["left", "right", "both", "each"]  # both: the same looks on both sides; each: different ones
HEIGHT_M = 2.6
_PAINTS: tuple[Rgb, ...] = (
    (207, 198, 178), (169, 185, 192), (196, 204, 190), (214, 186, 160), (150, 160, 176), (222, 220, 212),
    (176, 156, 140), (132, 150, 140),
)  # fmt: skip
_COLOURS: tuple[Rgb, ...] = (
    (166, 123, 75), (0, 72, 113), (45, 45, 55), (166, 164, 157), (204, 121, 167), (240, 228, 66), (213, 94, 0),
    (0, 114, 78), (235, 235, 228), (92, 70, 48), (86, 180, 233), (110, 24, 40),
)  # fmt: skip
# texture: probability, then width, lower edge and upper edge (m, least and most)
_KINDS = {
    "poster": (0.4, (0.4, 1.1), (0.1, 0.6), (1.1, 1.7)),
    "shelf": (0.14, (0.5, 0.9), (0.05, 0.2), (1.2, 1.9)),
    "cabinet": (0.14, (0.45, 0.7), (0.02, 0.03), (1.0, 1.5)),
    "board": (0.1, (0.8, 1.2), (0.4, 0.7), (1.5, 1.8)),
    "door": (0.1, (0.8, 1.0), (0.0, 0.0), (2.0, 2.1)),
    "window": (0.12, (0.7, 1.2), (0.3, 0.7), (1.7, 2.1)),
}
_NAMES = tuple(_KINDS)
_CHANCES = np.array([kind[0] for kind in _KINDS.values()])
_SHORT_M = 0.55  # shorter walls get paint only


class Dresser:
    """Gives walls their looks, line by line. The same seed and the same lines give the same looks."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._seed = int(self._rng.integers(1 << 20)) << 20  # of the last panel

    def line(
        self,
        points: Sequence[Point] | NDArray[np.floating],
        side: Side,
        kind: str = "wall",
        height: float = HEIGHT_M,
        outer: bool = False,
    ) -> list[Wall]:
        """Walls from point to point, (k, 2), to the millimetre; a ring repeats its first. side: which is seen."""
        rng = self._rng
        paint = _tone(rng, _PAINTS)
        patch, left = paint, 0.0
        walls: list[Wall] = []
        for (x1, y1), (x2, y2) in pairwise(np.round(points, 3).tolist()):
            length = math.hypot(x2 - x1, y2 - y1)
            if left <= 0.0:  # along a row of short walls the paint changes every 0.3 to 1 m
                patch, left = _tone(rng, _COLOURS if rng.random() < 0.5 else _PAINTS), float(rng.uniform(0.3, 1.0))
            left -= length
            long = length >= _SHORT_M
            panels = tuple(self._panels(length, side, height)) if long else ()
            walls.append(Wall(x1, y1, x2, y2, kind, height, paint if long else patch, outer, 0.0, panels))
        return walls

    def next_seed(self) -> int:
        """The seed of another panel, never the same twice."""
        self._seed += 1
        return self._seed

    def _panels(self, length: float, side: Side, height: float) -> Iterator[Panel]:
        """The panels of one wall, about one per metre, with gaps between them."""
        if side == "each":
            yield from self._panels(length, "left", height)
            yield from self._panels(length, "right", height)
            return
        rng = self._rng
        at = round(float(rng.uniform(0.05, 0.25)), 3)
        while at + 0.35 < length:
            name = _NAMES[int(rng.choice(len(_NAMES), p=_CHANCES))]
            _, widths, lows, highs = _KINDS[name]
            width = min(round(float(rng.uniform(*widths)), 2), math.floor((length - at) * 100 + 1e-9) / 100)
            low, high = round(float(rng.uniform(*lows)), 2), round(float(rng.uniform(*highs)), 2)
            if width >= min(widths[0], 0.5 * length) and low < height - 0.3:
                yield Panel(at, width, low, min(high, height), name, _tone(rng, _COLOURS), self.next_seed(), side)
            at = round(at + width + float(rng.uniform(0.1, 0.45)), 3)


def _tone(rng: np.random.Generator, colours: tuple[Rgb, ...]) -> Rgb:
    """One of the colours, made lighter or darker at random."""
    base = np.array(colours[int(rng.integers(len(colours)))]) * rng.uniform(0.75, 1.12)
    r, g, b = (int(min(level, 255)) for level in base)
    return r, g, b
