"""An office to be edited, and edits."""

from __future__ import annotations

from typing import Any

from sim2d import World
from web.messages import EditWorld

from .worlds import room

RADIUS = 0.2


SIDE = 6.0


ITEMS: dict[str, dict[str, Any]] = {
    "walls": {"from": [0.5, 0.5], "to": [1.5, 0.5]},
    "starts": {"name": "s", "x": 1.0, "y": 1.0, "heading_deg": 90.0},
    "places": {"name": "p", "x": 1.0, "y": 2.0},
    "doors": {"name": "d", "hinge": [4.5, 4.5], "angle_deg": 0.0, "width": 0.9},
    "lamps": {"name": "l", "x": 1.0, "y": 1.0},
    "boxes": {"name": "b", "x": 4.0, "y": 1.0, "width": 0.4, "depth": 0.4},
    "people": {"name": "q", "path": [[1.0, 5.0], [5.0, 5.0]]},
    "slow_zones": {"name": "z", "corners": [[1, 1], [2, 1], [2, 2]], "factor": 0.5},
    "script": {"at_s": 4.0, "do": "daylight", "level": 0.5},
    "daylight": {"points": [[0.0, 1.0], [60.0, 0.4]], "repeat_s": 120.0},
}


def office() -> World:
    return room(side=SIDE, start=(3.0, 3.0, 0.0))


def order(*steps: tuple[Any, ...], edition: int | None = None) -> EditWorld:
    """Steps as (do, list, number, item)."""
    keys = ("do", "list", "number", "item")
    return EditWorld.model_validate(
        {"type": "edit_world", "edition": edition, "steps": [dict(zip(keys, s, strict=True)) for s in steps]}
    )


class Taken:
    """Stands in for the session: keeps the world that it was given, or refuses it."""

    def __init__(self) -> None:
        self.world: World | None = None
        self.refuses = False

    def __call__(self, world: World) -> None:
        if self.refuses:
            raise ValueError("walls[4] would cover the robot")
        self.world = world
