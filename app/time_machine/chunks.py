"""States kept as chunks of bytes: a chunk that has not changed since the state before is the same object and costs nothing;
one that has changed is kept as its difference from an earlier one where that is smaller."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import zstandard
from numpy.typing import NDArray

from disk import State

CHUNK = 8192  # bytes
ENTRY = 160  # bytes that a chunk takes besides its content
WORTH = 0.7  # a difference is kept where it takes less than this share of the whole
_PACK, _UNPACK = zstandard.ZstdCompressor(level=1), zstandard.ZstdDecompressor()  # fast: the engine waits for them
Bytes = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Chunk:
    """base: what the content was XORed with, its bytes then sorted by their place in a number."""

    packed: bytes
    base: Chunk | None = None
    itemsize: int = 1

    def content(self) -> Bytes:
        raw = np.frombuffer(_UNPACK.decompress(self.packed), np.uint8)
        if self.base is None:
            return raw
        return raw.reshape(self.itemsize, -1).T.reshape(-1) ^ self.base.content()


@dataclass(frozen=True, slots=True, eq=False)
class KeptArray:
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    chunks: tuple[Chunk, ...]

    def array(self) -> NDArray[Any]:
        whole = np.empty(self.shape, self.dtype)
        raw = whole.reshape(-1).view(np.uint8)
        for number, chunk in enumerate(self.chunks):
            raw[number * CHUNK : (number + 1) * CHUNK] = chunk.content()
        return whole


@dataclass(frozen=True, slots=True, eq=False)
class KeptState:
    tree: bytes  # packed JSON
    arrays: tuple[KeptArray, ...]

    def state(self) -> State:
        """The state as it was, in arrays of its own."""
        return State(json.loads(_UNPACK.decompress(self.tree)), [kept.array() for kept in self.arrays])


class Chunks:
    """Keeps states that follow one another. It holds a copy of the last one, to tell what has changed since."""

    def __init__(self) -> None:
        self.nbytes = 0  # of all states that are kept, without the copy
        self._held: Counter[int] = Counter()  # how many arrays and other chunks hold a chunk, by its id
        self._uses: Counter[int] = Counter()  # how many states hold an array, by its id
        self._last: dict[str, tuple[Bytes, KeptArray]] = {}  # by its place in the tree

    @property
    def copy_nbytes(self) -> int:
        return sum(len(copy) for copy, _ in self._last.values())

    def keep(self, state: State) -> KeptState:
        """Keep a state. Its arrays may change afterwards."""
        places = dict(_places(state.tree["state"], ""))
        now = {
            places[number]: _kept(array, self._last.get(places[number])) for number, array in enumerate(state.arrays)
        }
        self._last = now
        tree = _PACK.compress(json.dumps(state.tree).encode())
        made = KeptState(tree, tuple(now[places[number]][1] for number in range(len(state.arrays))))
        self.nbytes += len(made.tree)
        for array in made.arrays:
            self._uses[id(array)] += 1
            if self._uses[id(array)] == 1:
                for chunk in array.chunks:
                    self._hold(chunk)
        return made

    def drop(self, state: KeptState) -> None:
        """Forget a state that was kept. What others hold stays."""
        self.nbytes -= len(state.tree)
        for array in state.arrays:
            self._uses[id(array)] -= 1
            if self._uses[id(array)] == 0:
                del self._uses[id(array)]
                for chunk in array.chunks:
                    self._let_go(chunk)

    def _hold(self, chunk: Chunk) -> None:
        self._held[id(chunk)] += 1
        if self._held[id(chunk)] == 1:
            self.nbytes += len(chunk.packed) + ENTRY
            if chunk.base is not None:
                self._hold(chunk.base)

    def _let_go(self, chunk: Chunk) -> None:
        self._held[id(chunk)] -= 1
        if self._held[id(chunk)] == 0:
            del self._held[id(chunk)]
            self.nbytes -= len(chunk.packed) + ENTRY
            if chunk.base is not None:
                self._let_go(chunk.base)


def _kept(array: NDArray[Any], before: tuple[Bytes, KeptArray] | None) -> tuple[Bytes, KeptArray]:
    """A copy of an array's bytes, and the array as it is kept. `before` is the same for the state before; it is used up."""
    raw = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    if before is None or before[1].dtype != array.dtype:
        before = np.zeros(0, np.uint8), KeptArray(array.dtype, (0,), ())
    copy, old = before
    changed = _changed(copy, raw)
    if not changed and array.shape == old.shape:
        return before
    if len(copy) != len(raw):
        copy = np.concatenate([copy[: len(raw)], raw[len(copy) :]])
    chunks: list[Chunk | None] = list(old.chunks[: _count(len(raw))])
    chunks += [None] * (_count(len(raw)) - len(chunks))
    for number in changed:
        part = slice(number * CHUNK, (number + 1) * CHUNK)
        copy[part] = raw[part]
        chunks[number] = _chunk(raw[part], array.itemsize, chunks[number])
    return copy, KeptArray(array.dtype, array.shape, tuple(chunk for chunk in chunks if chunk is not None))


def _chunk(raw: Bytes, itemsize: int, before: Chunk | None) -> Chunk:
    base = before if before is None or before.base is None else before.base
    if base is not None:
        content = base.content()
        if len(content) == len(raw):
            packed = _PACK.compress((raw ^ content).reshape(-1, itemsize).T.tobytes())
            if len(packed) < WORTH * len(base.packed):
                return Chunk(packed, base, itemsize)
    return Chunk(_PACK.compress(raw.data))


def _changed(before: Bytes, now: Bytes) -> list[int]:
    """The numbers of the chunks that differ, among them those that are new."""
    whole = min(len(before), len(now)) // CHUNK
    a, b = (side[: whole * CHUNK].view(np.uint64) for side in (before, now))
    differ = np.flatnonzero((a != b).reshape(whole, CHUNK // 8).any(1)).tolist() if whole else []
    same_end = len(before) == len(now) and np.array_equal(before[whole * CHUNK :], now[whole * CHUNK :])
    return differ if same_end else [*differ, *range(whole, _count(len(now)))]


def _count(nbytes: int) -> int:
    return -(-nbytes // CHUNK)


def _places(tree: Any, place: str) -> Iterator[tuple[int, str]]:
    """The number of each array in a tree, and its place there."""
    items = cast("list[Any]", tree) if isinstance(tree, list) else cast("dict[str, Any]", tree)
    for name, item in enumerate(items) if isinstance(items, list) else items.items():
        if name in ("array", "numbers", "keys", "values") and type(item) is int:
            yield item, f"{place}/{name}"
        elif isinstance(item, list | dict):
            yield from _places(item, f"{place}/{name}")
