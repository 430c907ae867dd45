"""States kept as chunks: each comes back as it was, whatever was dropped before, and all that is counted is there."""

from __future__ import annotations

import gc
import random
import tracemalloc
from typing import Any

import numpy as np
import pytest

from app.run_record.chunks import ENTRY, LINK, Chunk, Chunks, KeptArray, KeptState
from disk import State


def states(seed: int, count: int) -> list[State]:
    """They follow one another: little changes, some arrays grow, one is put together anew."""
    rng = np.random.default_rng(seed)
    places = rng.normal(size=(3000, 3))
    counts = rng.integers(0, 50, 9000).astype(np.int32)
    large, small, flags = rng.random(300_000, np.float32), np.arange(70), rng.random(20_000) < 0.5
    made: list[State] = []
    for number in range(count):
        places[rng.integers(0, 3000, 40)] += 1e-6
        counts[rng.integers(0, 9000, 30)] += 1
        at = rng.integers(0, 300_000 - 500)
        large[at : at + 500] *= np.float32(1.01)
        if number % 4 == 3:
            large = np.concatenate([large[: at // 2], rng.random(200, np.float32), large[at // 2 :]])
            counts = np.append(counts, counts[:100])
            flags = flags ^ (rng.random(20_000) < 0.001)
        arrays: list[np.ndarray[Any, Any]] = [places.copy(), counts.copy(), large.copy(), small, flags]
        made.append(State({"state": {"list": [{"array": k} for k in range(len(arrays))], "number": number}}, arrays))
    return made


def same(kept: KeptState, state: State) -> bool:
    again = kept.state()
    equal = all(a.dtype == b.dtype and np.array_equal(a, b) for a, b in zip(again.arrays, state.arrays, strict=True))
    return again.tree == state.tree and equal


def bytes_of(kept: list[KeptState]) -> int:
    """What these states take, each array and chunk once, with those that others are differences from."""
    chunks: dict[int, Chunk] = {}
    arrays: dict[int, KeptArray] = {}
    for state in kept:
        for array in state.arrays:
            arrays[id(array)] = array
            for chunk in array.chunks:
                chunks[id(chunk)] = chunk
                if chunk.base is not None:
                    chunks[id(chunk.base)] = chunk.base
    trees, links = sum(len(state.tree) for state in kept), sum(len(array.chunks) for array in arrays.values())
    return trees + LINK * links + sum(len(chunk.packed) + ENTRY for chunk in chunks.values())


@pytest.mark.parametrize("seed", range(3))
def test_each_state_is_as_it_was_whatever_is_dropped(seed: int) -> None:
    chunks, rng, kept = Chunks(), random.Random(seed), list[tuple[State, KeptState]]()
    for state in states(seed, 24):
        kept.append((state, chunks.keep(state)))
        if len(kept) > 6:
            chunks.drop(kept.pop(rng.randrange(1, len(kept) - 1))[1])
        assert chunks.nbytes == bytes_of([each for _, each in kept])
    for state, each in kept:
        assert same(each, state)


def test_a_difference_whose_base_nobody_else_needs_takes_no_more_than_the_whole() -> None:
    first, second, third = states(4, 3)
    alone, chunks = Chunks(), Chunks()
    whole = alone.keep(third)
    kept = [chunks.keep(state) for state in (first, second, third)]
    assert any(chunk.base is not None for array in kept[2].arrays for chunk in array.chunks)
    for state in kept[:2]:
        chunks.drop(state)
    assert all(chunk.base is None for array in kept[2].arrays for chunk in array.chunks)
    assert chunks.nbytes == pytest.approx(bytes_of([whole]), rel=0.01)
    assert same(kept[2], third)


def test_what_is_counted_is_what_is_held() -> None:
    """A budget of 200 MB once held 1.1 GB: what the compressor returned was short and kept the memory of its worst case."""
    given, chunks = states(1, 40), Chunks()
    tracemalloc.start()
    kept = [chunks.keep(state) for state in given]
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(kept) == 40
    assert held < 1.2 * (chunks.nbytes + chunks.copy_nbytes)


def test_the_garbage_collector_does_not_walk_through_what_is_kept() -> None:
    chunks = Chunks()
    kept = [chunks.keep(state) for state in states(5, 8)]
    gc.collect()
    arrays = [array for state in kept for array in state.arrays]
    held = [*kept, *arrays, *(state.arrays for state in kept), *(array.chunks for array in arrays)]
    held += [chunk for array in arrays for chunk in array.chunks]
    assert not any(map(gc.is_tracked, held))
