"""The looks of doors, boxes and people: each of their sides as a wall with panels, for the camera's textures."""

from __future__ import annotations

import math
import zlib
from functools import lru_cache

from sim2d.actors.walkers import PERSON_SIDES
from sim2d.world.elements import Box, Door, Person, Rgb
from sim2d.world.world import Panel, Wall, World

_SKIN: tuple[Rgb, ...] = ((236, 200, 172), (198, 146, 108), (134, 92, 66))
_HAIR: tuple[Rgb, ...] = ((40, 32, 28), (96, 64, 40), (170, 140, 90), (150, 150, 152))


def element_walls(world: World) -> tuple[Wall, ...]:
    """A wall of the right size for each row of `Actors.segments`, in the same order. Its position has no meaning."""
    return _walls(world.doors, world.boxes, world.people)


@lru_cache(maxsize=8)
def _walls(doors: tuple[Door, ...], boxes: tuple[Box, ...], people: tuple[Person, ...]) -> tuple[Wall, ...]:
    """The same elements give the same objects, so that an edit of something else does not change them."""
    walls = [_leaf(door) for door in doors]
    for box in boxes:
        walls += _sides(box)
    for person in people:
        walls += _figure(person)
    return tuple(walls)


def _seed(name: str) -> int:
    return zlib.crc32(name.encode())


def _upright(width: float, height: float, kind: str, colour: Rgb, panels: tuple[Panel, ...]) -> Wall:
    return Wall(0.0, 0.0, width, 0.0, kind, height, colour, panels=panels)


def _leaf(door: Door) -> Wall:
    panel = Panel(0.0, door.width, 0.0, door.height, "door", door.colour, _seed(door.name), "both")
    return _upright(door.width, door.height, "door", door.colour, (panel,))


def _sides(box: Box) -> list[Wall]:
    walls: list[Wall] = []
    for k, width in enumerate((box.width, box.depth, box.width, box.depth)):
        label = Panel(
            0.15 * width,
            0.7 * width,
            0.2 * box.height,
            0.8 * box.height,
            "poster",
            box.colour,
            _seed(box.name) + k,
            "both",
        )
        walls.append(_upright(width, box.height, "box", box.colour, (label,)))
    return walls


def _figure(person: Person) -> list[Wall]:
    """A person's sides, with shoes, trousers, shirt, head and hair; those in front have a face."""
    seed, h = _seed(person.name), person.height
    skin, hair = _SKIN[seed % len(_SKIN)], _HAIR[seed // 7 % len(_HAIR)]
    trousers = (38 + seed % 60, 40 + seed % 50, 52 + seed % 70)
    width = 2 * person.radius * math.sin(math.pi / PERSON_SIDES)
    walls: list[Wall] = []
    for k in range(PERSON_SIDES):
        face = min(k, PERSON_SIDES - k) <= 1
        bands = (
            (0.0, 0.05, (20, 20, 22)),
            (0.05, 0.47, trousers),
            (0.84, 0.95, skin if face else hair),
            (0.95, 1.0, hair),
        )
        panels = tuple(Panel(0.0, width, a * h, b * h, "paint", c, 0, "both") for a, b, c in bands)
        stripe = Panel(0.3 * width, 0.4 * width, 0.5 * h, 0.8 * h, "poster", person.colour, seed + k, "both")
        walls.append(_upright(width, h, "person", person.colour, (*panels, stripe)))
    return walls
