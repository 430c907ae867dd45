"""Small worlds with known distances, and world files to spoil."""

from __future__ import annotations

import copy
from typing import Any

from sim2d import Panel, Place, Start, Wall, World

GREY = (160, 160, 160)


def room(*inner: Wall, side: float = 4.0, panels: tuple[Panel, ...] = ()) -> World:
    """A square room from (0, 0), its start in the middle looking along +x; panels hang on its east wall."""
    corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
    walls = []
    for i, (x, y) in enumerate(corners):
        ends = corners[(i + 1) % 4]
        walls.append(Wall(x, y, *ends, "wall", 2.6, GREY, outer=True, panels=panels if i == 1 else ()))
    middle = side / 2
    return World("room", "A room", "test", (*walls, *inner), (Start("home", middle, middle, 0.0),), (Place("p", 1, 1),))


def room_file() -> dict[str, Any]:
    """The same room, 4 m, as a world file with one partition that carries a poster."""
    poster = {
        "at": 0.1, "width": 0.5, "bottom": 0.3, "top": 1.2, "texture": "poster", "colour": "#E69F00", "seed": 3,
    }  # fmt: skip
    walls: list[dict[str, Any]] = [
        {"from": a, "to": b, "height": 2.6, "colour": "#C0C0C0", "outer": True}
        for a, b in (([0, 0], [4, 0]), ([4, 0], [4, 4]), ([4, 4], [0, 4]), ([0, 4], [0, 0]))
    ]
    walls.append(
        {"from": [3, 1], "to": [3, 2], "kind": "partition", "height": 1.4, "colour": "#708090", "panels": [poster]}
    )
    return copy.deepcopy(
        {
            "format": 1,
            "name": "small",
            "title": "Small",
            "source": "test",
            "floor_colour": "#606060",
            "ceiling_colour": "#E0E0E0",
            "walls": walls,
            "starts": [{"name": "home", "x": 1.0, "y": 1.0, "heading_deg": 90}],
            "places": [{"name": "corner", "x": 3.5, "y": 3.5}],
        }
    )
