"""Worlds from walls: the last step of every importer, and an empty room as a beginning for drawing one's own office."""

from __future__ import annotations

import math
import re
import zlib
from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

from disk.words import plain
from sim2d.importers.dress import Dresser
from sim2d.world.elements import Lamp
from sim2d.world.world import Start, Wall, World
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
