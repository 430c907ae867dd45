"""A world as plain arrays, for drawing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim2d.world.texture import panel_mean_rgb
from sim2d.world.world import Panel, Wall, World

MOST_PANELS = 5000  # in a world with more they are too small to see, and ten thousand take a second of work
_OFF_WALL_M = 0.01  # panels are drawn this far in front of their side of the wall


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """The walls that stand on the floor, and all panels; if there are more than MOST_PANELS, none of them.

    Walls above the floor, the screens on desks, are drawn as panels, always.
    """

    walls: NDArray[np.float32]  # (n, 4): x1 y1 x2 y2
    wall_height_m: NDArray[np.float32]  # (n,)
    wall_kind: tuple[str, ...]
    panels: NDArray[np.float32]  # (m, 6): x1 y1 x2 y2 bottom top
    panel_rgb: NDArray[np.uint8]  # (m, 3) mean colour


def draw_world(world: World) -> Drawing:
    """The drawing of a world, in new read-only arrays."""
    standing = [world.walls[i] for i in world.obstacles]
    crowded = sum(len(wall.panels) for wall in world.walls) > MOST_PANELS
    rows: list[tuple[float, ...]] = []
    colours: list[tuple[int, int, int]] = []
    for wall in world.walls:
        if not wall.stands:
            rows.append((wall.x1, wall.y1, wall.x2, wall.y2, wall.bottom, wall.height))
            colours.append(wall.colour)
            continue
        for panel in () if crowded else wall.panels:
            for side in ("left", "right") if panel.side == "both" else (panel.side,):
                rows.append(_panel_row(wall, panel, side))
                colours.append(panel_mean_rgb(panel))
    return Drawing(
        walls=_frozen(world.segments()[list(world.obstacles)].astype(np.float32)),
        wall_height_m=_frozen(np.array([w.height for w in standing], np.float32)),
        wall_kind=tuple(w.kind for w in standing),
        panels=_frozen(np.array(rows, np.float32).reshape(-1, 6)),
        panel_rgb=_frozen(np.array(colours, np.uint8).reshape(-1, 3)),
    )


def _panel_row(wall: Wall, panel: Panel, side: str) -> tuple[float, ...]:
    ux, uy = (wall.x2 - wall.x1) / wall.length, (wall.y2 - wall.y1) / wall.length
    off = _OFF_WALL_M if side == "left" else -_OFF_WALL_M
    x, y = wall.x1 - off * uy, wall.y1 + off * ux
    end = panel.at + panel.width
    return x + panel.at * ux, y + panel.at * uy, x + end * ux, y + end * uy, panel.bottom, panel.top


def _frozen(array: np.ndarray) -> np.ndarray:
    array.setflags(write=False)
    return array
