"""Editing the office while the robot drives: an edit is some steps on an immutable World, and all worlds before it are kept.

Undo gives back the very World that was there before, redo the very one after.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from sim2d import FreeSpace, Wall, World
from sim2d.importers.dress import HEIGHT_M, Dresser
from sim2d.world_check import Fault, check_world
from sim2d.world_file import fault_words, item_complaint
from sim2d.world_schema import MOST, Thing, thing_of
from web import messages as m

MOST_UNDOS = 200
_ONE = {
    "walls": "wall", "starts": "start", "places": "place", "doors": "door", "lamps": "lamp", "boxes": "box",
    "people": "person", "slow_zones": "slow zone", "script": "line of the script", "daylight": "daylight",
}  # fmt: skip
_DONE = {"add": "drawn", "change": "changed", "delete": "deleted"}


class WorldEditor:
    """One office, what it was before, and what it was before that was taken back. Knows no session.

    `take` of each method puts a world in the place of the running one, or raises ValueError; then nothing has changed.
    """

    def __init__(self, world: World) -> None:
        self.world = world
        self.saved: World | None = world  # as it is in its file, or was opened; None: in no file
        self._lost: World | None = None  # what `saved` was when its file was deleted
        self._unfiled: set[str] = set()
        self._past: list[tuple[str, World]] = []
        self._future: list[tuple[str, World]] = []
        self._number = 1

    def begin(self, world: World) -> None:
        """A session begins: in the world that is edited, or in another, which has no past here."""
        if world is self.world:
            return
        been = [k for k, (_, before) in enumerate(self._past) if before is world]
        self._past, self._future = self._past[: been[-1]] if been else [], []
        self.world = world
        if not been:
            self.saved, self._lost = None if world.name in self._unfiled else world, None
        self._number += 1

    def follow(self, world: World) -> None:
        """Somebody else has changed the office, say, put down a box: that can be undone, too."""
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
        """What was done, in words. radius: of the robot; free_in: where it fits. ValueError says why it cannot be."""
        if order.edition is not None and order.edition != self._number:
            raise ValueError("somebody has changed the office since; look at it again and repeat what you did")
        world = edited(self.world, order.steps)
        try:
            check_world(world, radius, self.world, free_in)
        except Fault as fault:
            raise ValueError(fault_words(fault)) from None
        take(world)
        words = _words(order.steps)
        self._do(words, world)
        return words

    def undo(self, take: Callable[[World], None]) -> str:
        return self._step(self._past, self._future, take, "undo")

    def redo(self, take: Callable[[World], None]) -> str:
        return self._step(self._future, self._past, take, "redo")

    def named(self, was: World, world: World, take: Callable[[World], None]) -> None:
        """`was` has been saved as `world`, which differs in its name at most; it bears that name from now on."""
        if was is not self.world:  # edited while it was written
            return
        if (world.name, world.title) != (was.name, was.title):
            take(world)
            self.world = world
            for steps in (self._past, self._future):  # who takes an edit back keeps the name
                steps[:] = [(words, replace(other, name=world.name, title=world.title)) for words, other in steps]
            self._number += 1
        self.saved = self.world
        self._unfiled.discard(world.name)

    def unfiled(self, name: str) -> None:
        """No file holds the world of this name: it was never saved, or has been deleted."""
        self._unfiled.add(name)
        if name == self.world.name:
            self.saved, self._lost = None, self.saved

    def filed(self, name: str) -> None:
        """A deleted file is there again."""
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


def edited(world: World, steps: Iterable[m.EditStep]) -> World:
    """Another World; what no step touches is the same object. ValueError names step, field and value.

    Not checked as a whole: that is `check_world`'s.
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
    number = step.number
    if step.do == "add":
        if number is not None:
            raise ValueError(f"number: got {number}; what is added takes none, it comes last")
        if len(items) >= MOST[step.list]:
            raise ValueError(f"list: there are {len(items)} {step.list}; at most {MOST[step.list]}")
        number = len(items)
    elif number is None or number >= len(items):
        there = f"must be from 0 to {len(items) - 1}" if items else "there are none"
        raise ValueError(f"number: got {number}; there is no such {_ONE[step.list]}, {there}")
    if step.do == "delete":
        if step.item is not None:
            raise ValueError("item: what is deleted takes none")
        if step.list == "starts" and len(items) == 1:
            raise ValueError("number: this is the only start; the robot needs one")
        new: tuple[Thing, ...] = ()
    elif step.item is None:
        raise ValueError(f"item: is missing; must be a {_ONE[step.list]} as in a world file")
    else:
        new = (_thing(step.list, step.item),)
    items = (*items[:number], *new, *items[number + 1 :])
    return replace(world, **{step.list: items if step.list != "daylight" else items[0] if items else None})


def _thing(kind: str, item: dict[str, Any]) -> Thing:
    """[ours] A wall that says nothing of its looks gets paint and posters of its own: a bland one shows the robot nothing
    (test_world_editing.py::test_a_wall_gets_looks_of_its_own)."""
    plain = kind == "walls" and "colour" not in item
    try:
        thing = thing_of(kind, {"height": HEIGHT_M, **item, "colour": "#000000"} if plain else item)
    except ValidationError as error:
        raise ValueError(item_complaint(error, _ONE[kind])) from None
    if plain and isinstance(thing, Wall) and thing.stands and thing.length > 0:
        ends = (thing.x1, thing.y1), (thing.x2, thing.y2)
        dresser = Dresser(zlib.crc32(repr(ends).encode()))
        dressed = dresser.line(ends, "each", thing.kind, thing.height)[0]
        panels = thing.panels or (() if thing.kind == "glass" else dressed.panels)
        return replace(thing, colour=dressed.colour, panels=panels)
    return thing


def _words(steps: list[m.EditStep]) -> str:
    """`wall drawn`, or `door drawn and 2 more changes`; what is added last is what somebody meant."""
    meant = next((step for step in reversed(steps) if step.do == "add"), steps[-1])
    others = len(steps) - 1
    more = f" and {others} more change{'s' if others > 1 else ''}" if others else ""
    done = "added" if meant.do == "add" and meant.list in ("script", "daylight") else _DONE[meant.do]
    return f"{_ONE[meant.list]} {done}{more}"
