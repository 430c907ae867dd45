"""What lies within some metres of driving from given cells."""

from __future__ import annotations

import heapq
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sim2d.geometry.spreading import spread

KNIGHTS = [(1, 2), (2, 1), (-1, 2), (-2, 1)]
MOVES = [(0, 1), (1, 0), (1, 1), (-1, 1), *KNIGHTS]
BOTH_WAYS = np.array(MOVES + [(-y, -x) for y, x in MOVES])


def slowly(free: np.ndarray, seeds: list[tuple[int, int]], reach: float) -> np.ndarray:
    """Dijkstra over the whole grid."""
    away, heap = np.full(free.shape, np.inf), [(0.0, seed) for seed in seeds if free[seed]]
    for _, seed in heap:
        away[seed] = 0.0
    while heap:
        so_far, (y, x) = heapq.heappop(heap)
        for dy, dx in BOTH_WAYS:
            j, i = y + int(dy), x + int(dx)
            if 0 <= j < free.shape[0] and 0 <= i < free.shape[1] and free[j, i]:
                there = so_far + math.hypot(dy, dx)
                if there < away[j, i] - 1e-9:
                    away[j, i] = there
                    heapq.heappush(heap, (there, (j, i)))
    return away <= reach


@given(st.integers(0, 10**6), st.integers(1, 25), st.integers(1, 25), st.integers(1, 4), st.floats(0.5, 12.0))
def test_it_is_what_dijkstra_says_on_the_whole_grid(seed: int, n_y: int, n_x: int, starts: int, reach: float) -> None:
    rng = np.random.default_rng(seed)
    free = rng.random((n_y, n_x)) < 0.75
    seeds = [(int(rng.integers(n_y)), int(rng.integers(n_x))) for _ in range(starts)]
    marked = rng.random((n_y, n_x)) < 0.1
    before = marked.copy()
    reach = round(reach, 3) + 0.0003  # no sum of moves is as long as that
    new = spread(free, marked, np.array(seeds), reach, BOTH_WAYS)
    assert np.array_equal(marked, before | slowly(free, seeds, reach))
    assert new == np.count_nonzero(marked) - np.count_nonzero(before)
