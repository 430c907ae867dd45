"""Arrays and states kept as chunks of bytes: one that has not changed since the state before is the same object; one that has
changed is kept as its difference from an earlier one where that is smaller.

Of ten hours there are hundreds of thousands of them. None can be part of a cycle, so the garbage collector is not to walk
through them: it would hold up everything for half a second. test_chunks.py.
"""

from __future__ import annotations

import json
from typing import Any

import msgspec
import numpy as np
import zstandard
from numpy.typing import NDArray

from app.time_machine.shelf import Place
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

    packed: b"" once it lies at its place on the shelf, no sooner.
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
