"""An edit: steps that turn one immutable World into another. So the history is a stack of the worlds before each edit: undo
gives back the same object as before it, redo the one after it."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from sim2d import FreeSpace, Wall, World
from sim2d.importers.plan import HEIGHT_M, Dresser
from sim2d.world.world_check import Fault, check_world
from sim2d.world.world_file import fault_words, item_complaint
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


MOST_UNDOS = 200


class WorldEditor:
    """The world that is edited, the worlds before it (undo) and those that were taken back (redo). Knows no session.

    take: replaces the running world by another one, or raises ValueError; then nothing has changed.
    """

    def __init__(self, world: World) -> None:
        self.world = world
        self.saved: World | None = world  # as in its file, or as it was opened; None: it has no file
        self._lost: World | None = None  # `saved` as it was when the file was deleted
        self._unfiled: set[str] = set()
        self._past: list[tuple[str, World]] = []
        self._future: list[tuple[str, World]] = []
        self._number = 1

    def begin(self, world: World) -> None:
        """A session begins. Undo goes back only to edits before its world; for a foreign world there is none."""
        if world is self.world:
            return
        been = [k for k, (_, before) in enumerate(self._past) if before is world]
        self._past, self._future = self._past[: been[-1]] if been else [], []
        self.world = world
        if not been:
            self.saved, self._lost = None if world.name in self._unfiled else world, None
        self._number += 1

    def follow(self, world: World) -> None:
        """The office was changed otherwise, for instance by a box put down. That can be undone, too."""
        if world is not self.world:
            self._do("box put down or taken away", world)

    @property
    def edition(self) -> m.OfficeEdition:
        undo, redo = (steps[-1][0] if steps else "" for steps in (self._past, self._future))
        return m.OfficeEdition(self._number, undo, redo, self.world is self.saved)

    def edit(
        self, order: m.EditWorld, radius: float, take: Callable[[World], None],
        free_in: Callable[[World], FreeSpace] | None = None,
    ) -> str:  # fmt: skip
        """Make an edit and return what was done, in words. ValueError says why it cannot be made.

        radius: of the robot (m). free_in: gives the free space of a world for that robot.
        """
        if order.edition is not None and order.edition != self._number:
            raise ValueError("somebody has changed the office since; look at it again and repeat what you did")
        world = edited(self.world, order.steps)
        try:
            check_world(world, radius, self.world, free_in)
        except Fault as fault:
            raise ValueError(fault_words(fault)) from None
        take(world)
        words = words_of(order.steps)
        self._do(words, world)
        return words

    def undo(self, take: Callable[[World], None]) -> str:
        return self._step(self._past, self._future, take, "undo")

    def redo(self, take: Callable[[World], None]) -> str:
        return self._step(self._future, self._past, take, "redo")

    def named(self, was: World, world: World, take: Callable[[World], None]) -> None:
        """`was` has been saved as `world`, which differs at most in name and title. It has these from now on."""
        if was is not self.world:  # it was edited while the file was being written
            return
        if (world.name, world.title) != (was.name, was.title):
            take(world)
            self.world = world
            for steps in (self._past, self._future):  # undo keeps the new name
                steps[:] = [(words, replace(other, name=world.name, title=world.title)) for words, other in steps]
            self._number += 1
        self.saved = self.world
        self._unfiled.discard(world.name)

    def unfiled(self, name: str) -> None:
        """The world of this name has no file: it was never saved, or its file was deleted."""
        self._unfiled.add(name)
        if name == self.world.name:
            self.saved, self._lost = None, self.saved

    def filed(self, name: str) -> None:
        """The deleted file of the world of this name has been restored."""
        self._unfiled.discard(name)
        if name == self.world.name and self.saved is None:
            self.saved = self._lost

    def _do(self, words: str, world: World) -> None:
        self._past = [*self._past, (words, self.world)][-MOST_UNDOS:]
        self._future = []
        self.world = world
        self._number += 1

    def _step(
        self, back: list[tuple[str, World]], forth: list[tuple[str, World]], take: Callable[[World], None], verb: str
    ) -> str:
        if not back:
            raise ValueError(f"there is nothing to {verb}")
        words, world = back[-1]
        take(world)
        back.pop()
        forth.append((words, self.world))
        self.world = world
        self._number += 1
        return f"{verb}: {words}"
