"""Undo and redo. Worlds are immutable, so the history is a stack of the worlds before each edit.

Undo gives back the same World object as before the edit, redo the one after it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from app.world_editor.edits import edited, words_of
from sim2d import FreeSpace, World
from sim2d.world.world_check import Fault, check_world
from sim2d.world.world_file import fault_words
from web import messages as m

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
