"""States that follow one another, kept as chunks of bytes: one that has not changed is the same object as before, one that
has changed is kept as its difference from an earlier one where that is smaller, and what nobody needs is let go. [ours]
test_chunks.py.

Of ten hours there are hundreds of thousands of them. None can be part of a cycle, so the garbage collector is not to walk
through them: it would hold up everything for half a second.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any, cast

import msgspec
import numpy as np
import zstandard
from numpy.typing import NDArray

from app.run_record.spill_file import Place, SpillFile
from disk import State

CHUNK = 32768  # bytes
LARGE = 1 << 20  # arrays from this size on are cut by their content ...
CUT_BITS, CUT = 13, 77  # ... after a word whose hash has these first bits, ...
LEAST, MOST = 4096, 131072  # ... in chunks of about these sizes, bytes
WORTH = 0.7  # a difference is kept where it takes less than this share of the whole
_PACK, UNPACK = zstandard.ZstdCompressor(level=1), zstandard.ZstdDecompressor()  # fast: the engine waits for them
Bytes = NDArray[np.uint8]


def pack(content: bytes) -> bytes:
    """A copy: what the compressor returns holds the memory that it might have needed, whatever its length says."""
    return bytes(memoryview(_PACK.compress(content)))


class Chunk(msgspec.Struct, eq=False, gc=False):
    """base: what the content was XORed with. itemsize: of the numbers by whose places the bytes were then sorted.

    packed: b"" once it lies at its place in the spill file, no sooner.
    """

    packed: bytes
    base: Chunk | None = None
    itemsize: int = 1
    place: Place | None = None

    def content(self) -> Bytes:
        packed = self.packed or (self.place.read() if self.place else b"")
        raw = np.frombuffer(UNPACK.decompress(packed), np.uint8)
        if self.itemsize > 1:
            raw = _as_it_was(raw, self.itemsize)
        return raw if self.base is None else raw ^ self.base.content()

    def pack_whole(self, whole: Bytes, dtype: np.dtype[Any]) -> None:
        """Keep the content without a base. Whole numbers are mostly small ones: their bytes pack better sorted."""
        self.base, self.itemsize = None, dtype.itemsize if dtype.kind in "iu" else 1
        self.packed = pack(_sorted(whole, self.itemsize))


class KeptArray(msgspec.Struct, frozen=True, eq=False, gc=False):
    """starts: of the chunks, bytes."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    chunks: tuple[Chunk, ...]
    starts: NDArray[np.int64]

    def array(self) -> NDArray[Any]:
        whole = np.empty(self.shape, self.dtype)
        raw = whole.reshape(-1).view(np.uint8)
        for (start, end), chunk in zip(_parts(self.starts, len(raw)), self.chunks, strict=True):
            raw[start:end] = chunk.content()
        return whole


class KeptState(msgspec.Struct, frozen=True, eq=False, gc=False):
    tree: bytes  # packed JSON
    arrays: tuple[KeptArray, ...]

    def state(self) -> State:
        """The state as it was, in arrays of its own."""
        return State(json.loads(UNPACK.decompress(self.tree)), [kept.array() for kept in self.arrays])


def kept_array(array: NDArray[Any], before: tuple[Bytes, KeptArray] | None) -> tuple[Bytes, KeptArray]:
    """A copy of an array's bytes, and the array as it is kept. `before` is the same for the state before; it is used up."""
    raw = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    if before is None or before[1].dtype != array.dtype or len(before[0]) != len(raw):
        return raw.copy(), _kept_anew(array, raw, before)
    copy, old = before
    parts, chunks = [slice(*part) for part in _parts(old.starts, len(raw))], list(old.chunks)
    changed = [number for number, part in enumerate(parts) if copy[part].tobytes() != raw[part].tobytes()]
    if not changed and array.shape == old.shape:
        return before
    for number in changed:
        part = parts[number]
        copy[part] = raw[part]
        chunks[number] = _chunk(raw[part], array.dtype, chunks[number])
    return copy, KeptArray(array.dtype, array.shape, tuple(chunks), old.starts)


def _kept_anew(array: NDArray[Any], raw: Bytes, before: tuple[Bytes, KeptArray] | None) -> KeptArray:
    """An array that has another size than before. What has only moved within it is found again by its content."""
    known: dict[bytes, Chunk] = {}
    if before is not None:
        copy, old = before
        for (start, end), chunk in zip(_parts(old.starts, len(copy)), old.chunks, strict=True):
            known[copy[start:end].tobytes()] = chunk
    starts = _starts(raw, array.itemsize)
    chunks: list[Chunk] = []
    for start, end in _parts(starts, len(raw)):
        content = raw[start:end].tobytes()
        if content not in known:
            known[content] = _whole(raw[start:end], array.dtype)
        chunks.append(known[content])
    return KeptArray(array.dtype, array.shape, tuple(chunks), starts)


def _starts(raw: Bytes, itemsize: int) -> NDArray[np.int64]:
    """Where chunks begin, bytes: of a large array where its content says so, so that what has moved is cut as before."""
    if len(raw) < LARGE or itemsize != 4:
        return np.arange(0, len(raw), CHUNK)
    hashes = (raw.view(np.uint32) * np.uint32(2654435761)) >> np.uint32(32 - CUT_BITS)
    cuts = 4 * np.flatnonzero(hashes[:-1] == CUT) + 4
    cuts = np.concatenate([[0], cuts[np.diff(cuts, prepend=0) >= LEAST]])
    ends = np.append(cuts[1:], len(raw))
    long: list[int] = np.flatnonzero(ends - cuts > MOST).tolist()
    more: list[NDArray[np.int64]] = [np.arange(cuts[number], ends[number], MOST) for number in long]
    return np.unique(np.concatenate((cuts, *more)))


def _parts(starts: NDArray[np.int64], size: int) -> list[tuple[int, int]]:
    """Begin and end of each chunk of an array of this size, bytes."""
    begins: list[int] = starts.tolist()
    return list(zip(begins, [*begins[1:], size], strict=True)) if begins else []


def _chunk(raw: Bytes, dtype: np.dtype[Any], before: Chunk) -> Chunk:
    base = before.base or before
    content = base.content()
    if len(content) == len(raw):
        packed = pack(_sorted(raw ^ content, dtype.itemsize))
        if len(packed) < WORTH * len(base.packed):
            return Chunk(packed, base, dtype.itemsize)
    return _whole(raw, dtype)


def _whole(raw: Bytes, dtype: np.dtype[Any]) -> Chunk:
    chunk = Chunk(b"")
    chunk.pack_whole(raw, dtype)
    return chunk


def _sorted(raw: Bytes, itemsize: int) -> bytes:
    """By the place of each byte in its number."""
    return raw.reshape(-1, itemsize).T.tobytes()


def _as_it_was(raw: Bytes, itemsize: int) -> Bytes:
    """The other way. A byte of all numbers after the other, which takes half the time of numpy's own transposing."""
    numbers, places = np.empty((len(raw) // itemsize, itemsize), np.uint8), raw.reshape(itemsize, -1)
    for place in range(itemsize):
        numbers[:, place] = places[place]
    return numbers.reshape(-1)


ENTRY, LINK = 160, 8  # bytes that a chunk takes besides its content, and where an array names it
SPILLED = 256  # bytes; a smaller content stays in memory, where its entry takes as much


class Chunks:
    """Keeps states that follow one another. It holds a copy of the last one, to tell what has changed since.

    What the last one is made of stays in memory, since the next is compared with it; the rest can be put in the spill file.
    """

    def __init__(self, spill: SpillFile | None = None) -> None:
        self.nbytes = 0  # in memory, of all states that are kept, without the copy
        self._spill = spill
        self._past: dict[int, Chunk] = {}  # those that the last state no longer has, the oldest first, by id
        self._on_way: dict[Place, Chunk] = {}  # to the spill file
        self._on_way_bytes = 0
        self._held: Counter[int] = Counter()  # how many arrays and other chunks hold a chunk, by its id
        self._based: dict[int, list[tuple[Chunk, np.dtype[Any]]]] = {}  # the other chunks that hold one, by its id
        self._uses: Counter[int] = Counter()  # how many states hold an array, by its id
        self._last: dict[str, tuple[Bytes, KeptArray]] = {}  # by its place in the tree

    @property
    def copy_nbytes(self) -> int:
        return sum(len(copy) for copy, _ in self._last.values())

    @property
    def spilled_nbytes(self) -> int:
        return 0 if self._spill is None else self._spill.nbytes

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
        """Put what only the past needs in the spill file, the oldest first, so that no more than this stays in memory. It may
        take a while until it does."""
        if self._spill is None:
            return
        self._take_off(self._spill)
        over = self.nbytes - self._on_way_bytes - most_bytes
        needed, going = self._needed() if over > 0 else set[int](), list[Chunk]()
        for key, chunk in self._past.items():
            if over <= 0:
                break
            if key not in needed:
                going.append(chunk)
                over -= len(chunk.packed)
        for chunk in going:
            chunk.place = self._spill.put(chunk.packed)
            if chunk.place is None:
                break
            del self._past[id(chunk)]
            self._on_way[chunk.place] = chunk
            self._on_way_bytes += len(chunk.packed)

    def _take_off(self, spill: SpillFile) -> None:
        """What has been written needs no memory any more."""
        for place in spill.written():
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
        if chunk.place is None and len(chunk.packed) >= SPILLED and id(chunk) in self._held:
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
                self._give_back(chunk, chunk.place)
            if chunk.base is not None:
                others = self._based[id(chunk.base)]
                others[:] = [other for other in others if other[0] is not chunk]
                self._let_go(chunk.base)
        elif self._held[id(chunk)] == 1 and len(others := self._based.get(id(chunk), [])) == 1:
            self._free(chunk, others)

    def _give_back(self, chunk: Chunk, place: Place) -> None:
        assert self._spill is not None
        if self._on_way.pop(place, None) is not None:
            self._on_way_bytes -= len(chunk.packed)
        self._spill.give_back(place)

    def _free(self, base: Chunk, others: list[tuple[Chunk, np.dtype[Any]]]) -> None:
        """Only one other chunk needs this base any more: as a whole it takes less than both. What lies in the spill file is not
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
