"""When to kidnap a robot, by chance."""

from __future__ import annotations

import numpy as np

EARLY_S = 300.0  # a third of the kidnaps come before, when much is still unknown
FIRST_S = 20.0  # a robot that has only just begun has no place to find again
REST_S = 240.0  # at least so long it has to find itself, if the time allows it
_STREAM = 3  # of the run's seed; session.py and deliveries.py use others


def kidnap_times(count: int, minutes: float, seed: int) -> list[float]:
    """`count` times (s) within the first `minutes`, a third of them (rounded up) in the first five. Same seed, same times.

    After each the robot has four minutes until the next, or less where so many do not fit. ValueError: no time at all.
    """
    end_s = minutes * 60
    if count == 0:
        return []
    if end_s <= 2 * FIRST_S:
        raise ValueError(f"{minutes:g} minutes are too short for a kidnap; explore for one minute at least")
    rng = np.random.default_rng([seed, _STREAM])
    early = -(-count // 3)
    split_s = min(EARLY_S, end_s * early / count)
    late, rest_s = count - early, _rest(count - early, end_s - split_s)
    return _apart(early, FIRST_S, split_s, rng) + _apart(late, split_s + rest_s, end_s - rest_s, rng)


def _apart(count: int, begin_s: float, end_s: float, rng: np.random.Generator) -> list[float]:
    """So many times from begin to end with a rest between any two."""
    if count == 0:
        return []
    rest_s = _rest(count, end_s - begin_s)
    drawn = np.sort(rng.uniform(begin_s, end_s - (count - 1) * rest_s, count))
    return [round(float(at), 1) for at in drawn + rest_s * np.arange(count)]


def _rest(count: int, within_s: float) -> float:
    return min(REST_S, within_s / (count + 2))
