"""The order in which places are visited, round after round."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

_STREAM = 2  # of the run's seed; session.py and kidnap_times.py use others


def order(goals: int, visits: int, seed: int) -> Iterator[int]:
    """The goal of each visit: every round visits all goals in a new order, never the same twice in a row."""
    rng = np.random.default_rng([seed, _STREAM])
    last = -1
    for first in range(0, visits, goals):
        round_ = [int(goal) for goal in rng.permutation(goals)]
        if round_[0] == last and goals > 1:
            round_ = [*round_[1:], last]
        last = round_[-1]
        yield from round_[: visits - first]
