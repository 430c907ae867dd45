"""An edit: steps that turn one immutable World into another."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from sim2d import Wall, World
from sim2d.importers.dress import HEIGHT_M, Dresser
from sim2d.world.world_file import item_complaint
from sim2d.world.world_schema import MOST, Element, element_of
from web import messages as m

_ONE = {
    "walls": "wall", "starts": "start", "places": "place", "doors": "door", "lamps": "lamp", "boxes": "box",
    "people": "person", "slow_zones": "slow zone", "script": "line of the script", "daylight": "daylight",
}  # fmt: skip
_DONE = {"add": "drawn", "change": "changed", "delete": "deleted"}


def edited(world: World, steps: Iterable[m.EditStep]) -> World:
    """The edited World. What no step touches is the same object as before. ValueError names step, field and value.

    The result is not checked as a whole; `check_world` does that.
    """
    for i, step in enumerate(steps):
        try:
            world = _after(world, step)
        except ValueError as error:
            raise ValueError(f"steps[{i}]: {error}") from None
    return world


def _after(world: World, step: m.EditStep) -> World:
    items: tuple[Any, ...] = getattr(world, step.list) or ()
    if step.list == "daylight" and items:
        items = (items,)
    number = _place_of(step, items)
    new = _put_there(step, items)
    items = (*items[:number], *new, *items[number + 1 :])
    return replace(world, **{step.list: items if step.list != "daylight" else items[0] if items else None})


def _place_of(step: m.EditStep, items: tuple[Any, ...]) -> int:
    """The index of the item that the step is about. An added item comes last."""
    number = step.number
    if step.do == "add":
        if number is not None:
            raise ValueError(f"number: got {number}; what is added takes none, it comes last")
        if len(items) >= MOST[step.list]:
            raise ValueError(f"list: there are {len(items)} {step.list}; at most {MOST[step.list]}")
        return len(items)
    if number is None or number >= len(items):
        there = f"must be from 0 to {len(items) - 1}" if items else "there are none"
        raise ValueError(f"number: got {number}; there is no such {_ONE[step.list]}, {there}")
    return number


def _put_there(step: m.EditStep, items: tuple[Any, ...]) -> tuple[Element, ...]:
    """What takes the item's place: one item, or none if it is deleted."""
    if step.do == "delete":
        if step.item is not None:
            raise ValueError("item: what is deleted takes none")
        if step.list == "starts" and len(items) == 1:
            raise ValueError("number: this is the only start; the robot needs one")
        return ()
    if step.item is None:
        raise ValueError(f"item: is missing; must be a {_ONE[step.list]} as in a world file")
    return (_element(step.list, step.item),)


def _element(kind: str, item: dict[str, Any]) -> Element:
    """[ours] A wall without a colour gets paint and posters of its own, since on a bland one the robot recognises
    nothing (test_edits.py::test_a_wall_gets_looks_of_its_own)."""
    plain = kind == "walls" and "colour" not in item
    try:
        element = element_of(kind, {"height": HEIGHT_M, **item, "colour": "#000000"} if plain else item)
    except ValidationError as error:
        raise ValueError(item_complaint(error, _ONE[kind])) from None
    if plain and isinstance(element, Wall) and element.stands and element.length > 0:
        return _dressed(element)
    return element


def _dressed(wall: Wall) -> Wall:
    ends = (wall.x1, wall.y1), (wall.x2, wall.y2)
    dresser = Dresser(zlib.crc32(repr(ends).encode()))
    dressed = dresser.line(ends, "each", wall.kind, wall.height)[0]
    panels = wall.panels or (() if wall.kind == "glass" else dressed.panels)
    return replace(wall, colour=dressed.colour, panels=panels)


def words_of(steps: list[m.EditStep]) -> str:
    """`wall drawn`, or `door drawn and 2 more changes`. The edit is named after the last step that adds something."""
    meant = next((step for step in reversed(steps) if step.do == "add"), steps[-1])
    others = len(steps) - 1
    more = f" and {others} more change{'s' if others > 1 else ''}" if others else ""
    done = "added" if meant.do == "add" and meant.list in ("script", "daylight") else _DONE[meant.do]
    return f"{_ONE[meant.list]} {done}{more}"
