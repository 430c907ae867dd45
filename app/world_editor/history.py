"""Editing the office while the robot drives: an edit is some steps on an immutable World, and all worlds before it are kept.

Undo gives back the very World that was there before, redo the very one after.
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
        words = words_of(order.steps)
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
