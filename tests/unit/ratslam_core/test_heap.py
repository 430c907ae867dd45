"""What is taken from the heap comes in the order of its times, each entry once."""

from __future__ import annotations

import heapq

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core.solvers.dijkstra import pop, push, twice

TIMES = st.lists(st.one_of(st.none(), st.floats(0.0, 100.0)), min_size=1, max_size=200)  # None: take the first


@given(TIMES)
def test_it_gives_what_a_slow_heap_gives(steps: list[float | None]) -> None:
    heap, literal = (np.zeros(4), np.zeros(4, np.uint32)), list[float]()
    entries: dict[int, float] = {}
    for node, time in enumerate(steps):
        size = len(literal)
        if time is not None:
            if size == len(heap[0]):
                heap = twice(heap)
            push(size, heap, time, node)
            heapq.heappush(literal, time)
            entries[node] = time
        elif literal:
            first = heap[0][0], int(heap[1][0])
            assert first[0] == heapq.heappop(literal) == entries.pop(first[1])
            pop(size - 1, heap)
    left = sorted(zip(heap[0][: len(literal)].tolist(), heap[1][: len(literal)].tolist(), strict=True))
    assert left == sorted((time, node) for node, time in entries.items())
