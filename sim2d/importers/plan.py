"""The last step of every importer: walls and starts become a checked World."""

from __future__ import annotations

import math
import re
from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

from disk.words import plain
from sim2d.world.world import Start, Wall, World
from sim2d.world.world_check import Fault, check_world
from sim2d.world.world_file import WorldError


def plan_world(name: str, walls: tuple[Wall, ...], starts: NDArray[np.float64], what: str, radius_m: float) -> World:
    """A checked World. name: of the file; what: its kind, in words; starts: (k, 3) x, y (m), heading (rad).

    Raises WorldError if the walls do not make a valid world.
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
