"""States kept as chunks of bytes: a chunk that has not changed since the state before is the same object and costs
nothing."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import zstandard
from numpy.typing import NDArray

from disk import State

CHUNK = 8192  # bytes
ENTRY = 120  # bytes that a chunk takes besides its content
_PACK, _UNPACK = zstandard.ZstdCompressor(level=1), zstandard.ZstdDecompressor()  # fast: the engine waits for them


@dataclass(frozen=True, slots=True, eq=False)
class KeptArray:
    dtype: str
    shape: tuple[int, ...]
    chunks: tuple[bytes, ...]  # packed


@dataclass(frozen=True, slots=True, eq=False)
class KeptState:
    tree: bytes  # packed JSON
    arrays: tuple[KeptArray, ...]

    def state(self) -> State:
        """The state as it was, in arrays of its own."""
        return State(json.loads(_UNPACK.decompress(self.tree)), [_array(kept) for kept in self.arrays])


class Chunks:
    """Keeps states that follow one another. It holds a copy of the last one, to tell what has changed since."""

    def __init__(self) -> None:
        self.nbytes = 0  # of all states that are kept, without the copy
        self._held: Counter[int] = Counter()  # how many arrays hold a chunk, by its id
        self._uses: Counter[int] = Counter()  # how many states hold an array, by its id
        self._last: dict[str, tuple[NDArray[np.uint8], KeptArray]] = {}  # by its place in the tree

    @property
    def copy_nbytes(self) -> int:
        return sum(len(copy) for copy, _ in self._last.values())

    def keep(self, state: State) -> KeptState:
        """Keep a state. Its arrays may change afterwards."""
        now: dict[str, tuple[NDArray[np.uint8], KeptArray]] = {}
        places = dict(_places(state.tree["state"], ""))
        kept: list[KeptArray] = []
        for number, array in enumerate(state.arrays):
            place = places[number]
            now[place] = self._keep(array, self._last.get(place))
            kept.append(now[place][1])
        self._last = now
        made = KeptState(_PACK.compress(json.dumps(state.tree).encode()), tuple(kept))
        self.nbytes += len(made.tree)
        for array in made.arrays:
            self._count(array)
        return made

    def drop(self, state: KeptState) -> None:
        """Forget a state that was kept. What others hold stays."""
        self.nbytes -= len(state.tree)
        for array in state.arrays:
            self._uses[id(array)] -= 1
            if self._uses[id(array)] > 0:
                continue
            del self._uses[id(array)]
            for chunk in array.chunks:
                self._held[id(chunk)] -= 1
                if self._held[id(chunk)] == 0:
                    del self._held[id(chunk)]
                    self.nbytes -= len(chunk) + ENTRY

    def _count(self, array: KeptArray) -> None:
        self._uses[id(array)] += 1
        if self._uses[id(array)] > 1:
            return
        for chunk in array.chunks:
            self._held[id(chunk)] += 1
            if self._held[id(chunk)] == 1:
                self.nbytes += len(chunk) + ENTRY

    def _keep(
        self, array: NDArray[Any], before: tuple[NDArray[np.uint8], KeptArray] | None
    ) -> tuple[NDArray[np.uint8], KeptArray]:
        """A copy of the array's bytes, and the array as it is kept."""
        raw = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
        copy, chunks = (np.zeros(0, np.uint8), ()) if before is None else (before[0], before[1].chunks)
        changed = _changed(copy, raw)
        if before is not None and not changed and (array.dtype.str, array.shape) == (before[1].dtype, before[1].shape):
            return before
        if len(copy) != len(raw):
            copy = np.concatenate([copy[: len(raw)], raw[len(copy) :]])
        packed = list(chunks[: _chunks(len(raw))]) + [b""] * (_chunks(len(raw)) - len(chunks))
        for number in changed:
            part = slice(number * CHUNK, (number + 1) * CHUNK)
            copy[part] = raw[part]
            packed[number] = _PACK.compress(raw[part].data)
        return copy, KeptArray(array.dtype.str, array.shape, tuple(packed))


def _changed(before: NDArray[np.uint8], now: NDArray[np.uint8]) -> list[int]:
    """The numbers of the chunks that differ, among them those that are new."""
    whole = min(len(before), len(now)) // CHUNK
    a, b = (side[: whole * CHUNK].view(np.uint64) for side in (before, now))
    differ = np.flatnonzero((a != b).reshape(whole, CHUNK // 8).any(1)).tolist() if whole else []
    rest = range(whole, _chunks(len(now)))
    same_end = len(before) == len(now) and np.array_equal(before[whole * CHUNK :], now[whole * CHUNK :])
    return differ if same_end else [*differ, *rest]


def _chunks(nbytes: int) -> int:
    return -(-nbytes // CHUNK)


def _array(kept: KeptArray) -> NDArray[Any]:
    whole = bytearray(b"".join(map(_UNPACK.decompress, kept.chunks)))
    return np.frombuffer(whole, kept.dtype).reshape(kept.shape)


def _places(tree: Any, place: str) -> Iterator[tuple[int, str]]:
    """The number of each array in a tree, and its place there."""
    if isinstance(tree, list):
        for number, item in enumerate(tree):
            yield from _places(item, f"{place}/{number}")
    elif isinstance(tree, dict):
        for name, item in tree.items():
            if name in ("array", "numbers", "keys", "values") and type(item) is int:
                yield item, f"{place}/{name}"
            elif isinstance(item, list | dict):
                yield from _places(item, f"{place}/{name}")
