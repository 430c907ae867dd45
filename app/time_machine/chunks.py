"""States that follow one another, kept as chunks: what has not changed costs nothing, and what nobody needs is let go."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any, cast

import numpy as np

from app.time_machine.kept_state import Bytes, Chunk, KeptArray, KeptState, kept_array, pack
from app.time_machine.shelf import Place, Shelf
from disk import State

ENTRY, LINK = 160, 8  # bytes that a chunk takes besides its content, and where an array names it
SHELVED = 256  # bytes; a smaller content stays in memory, where its entry takes as much


class Chunks:
    """Keeps states that follow one another. It holds a copy of the last one, to tell what has changed since.

    What the last one is made of stays in memory, since the next is compared with it; the rest can be put on the shelf.
    """

    def __init__(self, shelf: Shelf | None = None) -> None:
        self.nbytes = 0  # in memory, of all states that are kept, without the copy
        self._shelf = shelf
        self._past: dict[int, Chunk] = {}  # those that the last state no longer has, the oldest first, by id
        self._on_way: dict[Place, Chunk] = {}  # to the shelf
        self._on_way_bytes = 0
        self._held: Counter[int] = Counter()  # how many arrays and other chunks hold a chunk, by its id
        self._based: dict[int, list[tuple[Chunk, np.dtype[Any]]]] = {}  # the other chunks that hold one, by its id
        self._uses: Counter[int] = Counter()  # how many states hold an array, by its id
        self._last: dict[str, tuple[Bytes, KeptArray]] = {}  # by its place in the tree

    @property
    def copy_nbytes(self) -> int:
        return sum(len(copy) for copy, _ in self._last.values())

    @property
    def shelf_nbytes(self) -> int:
        return 0 if self._shelf is None else self._shelf.nbytes

    def keep(self, state: State) -> KeptState:
        """Keep a state. Its arrays may change afterwards."""
        places = dict(_places(state.tree["state"], ""))
        now = {
            places[number]: kept_array(array, self._last.get(places[number]))
            for number, array in enumerate(state.arrays)
        }
        self._note_past(now)
        self._last = now
        tree = pack(json.dumps(state.tree).encode())
        made = KeptState(tree, tuple(now[places[number]][1] for number in range(len(state.arrays))))
        self.nbytes += len(made.tree)
        for array in made.arrays:
            self._uses[id(array)] += 1
            if self._uses[id(array)] == 1:
                self.nbytes += LINK * len(array.chunks)
                for chunk in array.chunks:
                    self._hold(chunk, array.dtype)
        return made

    def make_room(self, most_bytes: int) -> None:
        """Put what only the past needs on the shelf, the oldest first, so that no more than this stays in memory. It may
        take a while until it does."""
        if self._shelf is None:
            return
        self._take_off(self._shelf)
        over = self.nbytes - self._on_way_bytes - most_bytes
        needed, going = self._needed() if over > 0 else set[int](), list[Chunk]()
        for key, chunk in self._past.items():
            if over <= 0:
                break
            if key not in needed:
                going.append(chunk)
                over -= len(chunk.packed)
        for chunk in going:
            chunk.place = self._shelf.put(chunk.packed)
            if chunk.place is None:
                break
            del self._past[id(chunk)]
            self._on_way[chunk.place] = chunk
            self._on_way_bytes += len(chunk.packed)

    def _take_off(self, shelf: Shelf) -> None:
        """What has been written needs no memory any more."""
        for place in shelf.written():
            chunk = self._on_way.pop(place, None)
            if chunk is not None:
                self._on_way_bytes -= len(chunk.packed)
                self.nbytes -= len(chunk.packed)
                chunk.packed = b""

    def _needed(self) -> set[int]:
        """The ids of the chunks in memory that the next state is compared with."""
        chunks = {id(chunk): chunk for _, array in self._last.values() for chunk in array.chunks}
        return {*chunks, *(id(chunk.base) for chunk in chunks.values() if chunk.base is not None)}

    def _note_past(self, now: dict[str, tuple[Bytes, KeptArray]]) -> None:
        """Chunks that the state before this one has, and this one no longer, or not at the same place."""
        for place, (_, before) in self._last.items():
            after = now[place][1] if place in now else None
            if after is not before:
                there = {id(chunk) for chunk in after.chunks} if after is not None else set[int]()
                for chunk in before.chunks:
                    if id(chunk) not in there:
                        self._add_past(chunk)
                        if chunk.base is not None:
                            self._add_past(chunk.base)

    def _add_past(self, chunk: Chunk) -> None:
        if chunk.place is None and len(chunk.packed) >= SHELVED and id(chunk) in self._held:
            self._past.setdefault(id(chunk), chunk)

    def drop(self, state: KeptState) -> None:
        """Forget a state that was kept. What others hold stays."""
        self.nbytes -= len(state.tree)
        for array in state.arrays:
            self._uses[id(array)] -= 1
            if self._uses[id(array)] == 0:
                del self._uses[id(array)]
                self.nbytes -= LINK * len(array.chunks)
                for chunk in array.chunks:
                    self._let_go(chunk)

    def _hold(self, chunk: Chunk, dtype: np.dtype[Any]) -> None:
        self._held[id(chunk)] += 1
        if self._held[id(chunk)] == 1:
            self.nbytes += len(chunk.packed) + ENTRY
            if chunk.base is not None:
                self._based.setdefault(id(chunk.base), []).append((chunk, dtype))
                self._hold(chunk.base, dtype)

    def _let_go(self, chunk: Chunk) -> None:
        self._held[id(chunk)] -= 1
        if self._held[id(chunk)] == 0:
            del self._held[id(chunk)]
            self._based.pop(id(chunk), None)
            self.nbytes -= len(chunk.packed) + ENTRY
            self._past.pop(id(chunk), None)
            if chunk.place is not None:
                self._leave_shelf(chunk, chunk.place)
            if chunk.base is not None:
                others = self._based[id(chunk.base)]
                others[:] = [other for other in others if other[0] is not chunk]
                self._let_go(chunk.base)
        elif self._held[id(chunk)] == 1 and len(others := self._based.get(id(chunk), [])) == 1:
            self._free(chunk, others)

    def _leave_shelf(self, chunk: Chunk, place: Place) -> None:
        assert self._shelf is not None
        if self._on_way.pop(place, None) is not None:
            self._on_way_bytes -= len(chunk.packed)
        self._shelf.give_back(place)

    def _free(self, base: Chunk, others: list[tuple[Chunk, np.dtype[Any]]]) -> None:
        """Only one other chunk needs this base any more: as a whole it takes less than both. What lies on the shelf is not
        read for that."""
        chunk, dtype = others[0]
        if base.place is not None or chunk.place is not None:
            return
        others.clear()
        self.nbytes -= len(chunk.packed)
        chunk.pack_whole(chunk.content(), dtype)
        self.nbytes += len(chunk.packed)
        self._let_go(base)


def _places(tree: Any, place: str) -> Iterator[tuple[int, str]]:
    """The number of each array in a tree, and its place there."""
    items = cast("list[Any]", tree) if isinstance(tree, list) else cast("dict[str, Any]", tree)
    for name, item in enumerate(items) if isinstance(items, list) else items.items():
        if name in ("array", "numbers", "keys", "values") and type(item) is int:
            yield item, f"{place}/{name}"
        elif isinstance(item, list | dict):
            yield from _places(item, f"{place}/{name}")
