"""When to kidnap a robot, by chance."""

from __future__ import annotations

import numpy as np

EARLY_S = 300.0  # a third of the kidnaps come before, when much is still unknown
FIRST_S = 20.0  # a robot that has only just begun has no place to find again
REST_S = 120.0  # at least so long it has to find itself, if the time allows it
_STREAM = 3  # of the run's seed; session.py and deliveries.py use others


def kidnap_times(count: int, minutes: float, seed: int) -> list[float]:
    """`count` times (s) within the first `minutes`, a third of them (rounded up) in the first five. Same seed, same times.

    After each the robot has two minutes until the next, or less where so many do not fit. ValueError: no time at all.
    """
    end_s = minutes * 60
    if count == 0:
        return []
    if end_s <= 2 * FIRST_S:
        raise ValueError(f"{minutes:g} minutes are too short for a kidnap; explore for one minute at least")
    rng = np.random.default_rng([seed, _STREAM])
    early = -(-count // 3)
    split_s = min(EARLY_S, end_s * early / count)
    return _apart(early, FIRST_S, split_s, rng) + _apart(count - early, split_s, end_s, rng)


def _apart(count: int, begin_s: float, end_s: float, rng: np.random.Generator) -> list[float]:
    """So many times from begin to end, each followed by a rest, the last one, too."""
    rest_s = min(REST_S, (end_s - begin_s) / (count + 1)) if count else 0.0
    drawn = np.sort(rng.uniform(begin_s, end_s - count * rest_s, count))
    return [round(float(at), 1) for at in drawn + rest_s * np.arange(count)]
