"""A World as the text of a world file: the inverse of `world_from_json`."""

from __future__ import annotations

import json
import math
from typing import Any

from sim2d.world.elements import Box, Door, Person, Rgb
from sim2d.world.world import Wall, World


def world_to_json(world: World) -> str:
    """The text of a world file, one line for each item. Read again, it gives an equal world."""
    return WorldText().of(world)


class WorldText:
    """Writes one world after another. Walls that are the same objects as in the last one are not converted again, which
    would take half a second for ten thousand walls."""

    def __init__(self) -> None:
        self._lines: dict[int, tuple[Wall, str]] = {}  # by id; the wall is kept, so that its id stays its own

    def of(self, world: World) -> str:
        """The same text as `world_to_json`."""
        known, lines = self._lines, {}
        for wall in world.walls:
            lines[id(wall)] = known.get(id(wall)) or (wall, json.dumps(_wall(wall)))
        self._lines = lines
        return _text(world, [lines[id(wall)][1] for wall in world.walls])


def _text(world: World, walls: list[str]) -> str:
    head = {"format": 1, "name": world.name, "title": world.title, "source": world.source}
    head |= {key: text for key, text in (("paper", world.paper), ("about", world.about)) if text}
    head |= {"floor_colour": _hex(world.floor_colour), "ceiling_colour": _hex(world.ceiling_colour)}
    lists: dict[str, list[dict[str, Any]]] = {
        "starts": [{"name": s.name, "x": s.x, "y": s.y, "heading_deg": _degrees(s.heading_rad)} for s in world.starts],
        "places": [{"name": p.name, "x": p.x, "y": p.y} for p in world.places],
        "doors": [_door(door) for door in world.doors],
        "lamps": [
            {"name": k.name, "x": k.x, "y": k.y, "reach": k.reach, "brightness": k.brightness, "on": k.on}
            for k in world.lamps
        ],
        "boxes": [_box(box) for box in world.boxes],
        "people": [_person(person) for person in world.people],
        "slow_zones": [
            {"name": z.name, "corners": [*map(list, z.corners)], "factor": z.factor} for z in world.slow_zones
        ],
        "script": [{"at_s": e.at_s, "do": e.do, "name": e.name, "level": e.level} for e in world.script],
    }
    lines = [f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in head.items()]
    if world.daylight is not None:
        day = world.daylight
        course = {"points": [*map(list, zip(day.at_s, day.level, strict=True))], "repeat_s": day.repeat_s}
        lines.append(f'  "daylight": {json.dumps(course)}')
    for key, texts in {"walls": walls, **{key: [*map(json.dumps, items)] for key, items in lists.items()}}.items():
        if texts:
            rows = ",\n".join(f"    {text}" for text in texts)
            lines.append(f'  "{key}": [\n{rows}]')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _wall(wall: Wall) -> dict[str, Any]:
    item: dict[str, Any] = {"from": [wall.x1, wall.y1], "to": [wall.x2, wall.y2], "kind": wall.kind}
    item |= {"height": wall.height, "colour": _hex(wall.colour)}
    item |= {"name": wall.name} if wall.name else {}
    item |= {"outer": True} if wall.outer else {}
    item |= {"bottom": wall.bottom} if wall.bottom else {}
    item |= {"reflection": wall.reflection} if wall.kind == "glass" else {}
    panels = [
        {
            "at": p.at, "width": p.width, "bottom": p.bottom, "top": p.top, "texture": p.texture,
            "colour": _hex(p.colour), "seed": p.seed, "side": p.side,
        }
        for p in wall.panels
    ]  # fmt: skip
    return item | ({"panels": panels} if panels else {})


def _door(door: Door) -> dict[str, Any]:
    return {
        "name": door.name, "hinge": [door.x, door.y], "angle_deg": _degrees(door.angle_rad), "width": door.width,
        "height": door.height, "colour": _hex(door.colour), "swing_deg": _degrees(door.swing_rad), "slides": door.slides,
        "open": door.open, "period_s": door.period_s, "open_s": door.open_s, "phase_s": door.phase_s,
    }  # fmt: skip


def _box(box: Box) -> dict[str, Any]:
    return {
        "name": box.name, "x": box.x, "y": box.y, "width": box.width, "depth": box.depth, "height": box.height,
        "angle_deg": _degrees(box.angle_rad), "colour": _hex(box.colour), "present": box.present,
    }  # fmt: skip


def _person(person: Person) -> dict[str, Any]:
    return {
        "name": person.name, "path": [*map(list, person.path)], "speed": person.speed, "wait_s": list(person.wait_s),
        "loop": person.loop, "radius": person.radius, "height": person.height, "colour": _hex(person.colour),
    }  # fmt: skip


def _hex(rgb: Rgb) -> str:
    return "#{:02X}{:02X}{:02X}".format(*rgb)


def _degrees(angle: float) -> float:
    """Degrees that convert back to exactly this angle, if there are any; a short number where that is enough."""
    near = math.degrees(angle)
    beside = (math.nextafter(near, side) for side in (-math.inf, math.inf))
    return next((d for d in (round(near, 9), near, *beside) if math.radians(d) == angle), near)
