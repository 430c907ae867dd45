"""Links of many views grow in one arena and never get into each other's way."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import LocalViewParams, ViewLinks

N = 6000

sights = st.lists(
    st.tuples(
        st.one_of(st.integers(0, 4), st.sampled_from([1023, 1024, 3000])),
        st.integers(0, N - 1),  # first active cell
        st.one_of(st.integers(1, 300), st.integers(4000, 5000)),  # how many
        st.integers(0, 2**32 - 1),
    ),
    min_size=1,
    max_size=30,
)


@settings(max_examples=60)
@given(sights, st.sampled_from([0.0, 0.25]))
def test_growing_keeps_what_was_learnt(sights: list[tuple[int, int, int, int]], decay: float) -> None:
    links = ViewLinks(LocalViewParams(learning_rate=0.5, decay=decay, most_links=0))
    beta: dict[int, np.ndarray] = {}
    for view, first, count, seed in sights:
        flats = (first + np.arange(count)) % N
        activity = np.random.default_rng(seed).random(count).astype(np.float32)
        slot = np.zeros(N, np.int32)
        slot[flats] = np.arange(count) + 1
        cells = np.zeros((count, 4), np.int32)
        cells[:, 3] = flats
        links.learn(view, cells, activity, slot)
        old = beta.setdefault(view, np.zeros(N))
        old *= 1 - decay
        old[flats] += 0.5 * activity
    for view, expected in beta.items():
        cells, strength = links.of(view)
        assert len(np.unique(cells)) == len(cells)
        got = np.zeros(N)
        got[cells] = strength
        assert np.abs(got - expected).max() < 1e-5
