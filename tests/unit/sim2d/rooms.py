"""Small worlds with known distances, in which things can live; a robot without noise; and a world file to spoil."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from sim2d import Door, Drive, Panel, Place, SensorFrame, SimParams, Simulator, Start, Wall, World

GREY = (160, 160, 160)
EXACT = SimParams(
    odometry_noise=0.0, odometry_scale_error=0.0, gyro_bias=0.0, image_noise=0.0, sonar_noise_m=0.0, laser_noise_m=0.0,
    laser_beams=181,
)  # fmt: skip
FORWARD, STAY = Drive(0.5, 0.0), Drive(0.0, 0.0)
DOOR = Door("lab", 3.0, 1.5, math.pi / 2, 1.0, swing_rad=-math.pi / 2, open=False)


def wall(
    x1: float, y1: float, x2: float, y2: float, kind: str = "wall", height: float = 2.6,
    colour: tuple[int, int, int] = GREY, **more: Any,
) -> Wall:  # fmt: skip
    return Wall(x1, y1, x2, y2, kind, height, colour, **more)


def room(*inner: Wall, side: float = 4.0, panels: tuple[Panel, ...] = (), **things: Any) -> World:
    """A square room from (0, 0), its start in the middle looking along +x; panels hang on its east wall."""
    corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
    outer = [
        wall(*a, *b, outer=True, panels=panels if i == 1 else ())
        for i, (a, b) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True))
    ]
    home = Start("home", side / 2, side / 2, 0.0)
    return replace(World("room", "A room", "test", (*outer, *inner), (home,), (Place("p", 1, 1),)), **things)


def living(**things: Any) -> World:
    """The 4 m room, divided at x = 3 except for a gap of 1 m. The robot stands before the gap and faces it."""
    return room(wall(3.0, 0.0, 3.0, 1.5), wall(3.0, 2.5, 3.0, 4.0), **things)


def run(simulator: Simulator, drive: Drive, ticks: int) -> SensorFrame:
    return [simulator.step(drive) for _ in range(ticks)][-1]


def living_file() -> dict[str, Any]:
    """The room as a world file, with a partition that carries a poster, and one of everything that can live in it."""
    poster = {
        "at": 0.1, "width": 0.5, "bottom": 0.3, "top": 1.2, "texture": "poster", "colour": "#E69F00", "seed": 3,
    }  # fmt: skip
    walls: list[dict[str, Any]] = [
        {"from": a, "to": b, "height": 2.6, "colour": "#C0C0C0", "outer": True}
        for a, b in (([0, 0], [4, 0]), ([4, 0], [4, 4]), ([4, 4], [0, 4]), ([0, 4], [0, 0]))
    ]
    walls += [
        {"from": [3, 1], "to": [3, 2], "kind": "partition", "height": 1.4, "colour": "#708090", "panels": [poster]}
    ]
    return {
        "format": 1, "name": "small", "title": "Small", "source": "test",
        "floor_colour": "#606060", "ceiling_colour": "#E0E0E0", "walls": walls,
        "starts": [{"name": "home", "x": 1.0, "y": 1.0, "heading_deg": 90}],
        "places": [{"name": "corner", "x": 3.5, "y": 3.5}],
        "doors": [{"name": "lab", "hinge": [2.0, 2.0], "angle_deg": 90, "width": 0.9, "period_s": 20.0, "open_s": 5.0}],
        "lamps": [{"name": "ceiling", "x": 2.0, "y": 3.0}],
        "daylight": {"points": [[0, 0.4], [60, 1.0]], "repeat_s": 120.0},
        "boxes": [{"name": "crate", "x": 2.5, "y": 0.5, "width": 0.4, "depth": 0.3, "angle_deg": 30, "present": False}],
        "people": [{"name": "Ada", "path": [[0.5, 3.5], [3.5, 3.0]], "wait_s": [1.0, 2.0], "loop": False}],
        "slow_zones": [{"name": "carpet", "corners": [[0, 0], [1, 0], [1, 1]], "factor": 0.5}],
        "script": [{"at_s": 3, "do": "close_door", "name": "lab"}, {"at_s": 4, "do": "people_off"}],
    }  # fmt: skip
