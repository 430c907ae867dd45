"""An empty room with a lamp and a start, as a beginning for drawing one's own office."""

from __future__ import annotations

import zlib

from sim2d.importers.dress import Dresser
from sim2d.world.elements import Lamp
from sim2d.world.world import Start, World

SMALLEST_M, LARGEST_M = 2.0, 200.0


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
