"""How long an experiment will take."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from app.trials.experiment import Experiment

REAL_TIMES = 100.0  # simulated seconds in one of a core, where nothing has been measured
SET_UP_S = 0.5  # of a session


@dataclass(frozen=True, slots=True)
class Duration:
    """Wall time of trials on one core, in s. measured: each engine's from trials that were run on this store's machine."""

    seconds: float
    trials: int
    measured: bool

    def words(self, workers: int) -> str:
        """Such as `12 min, measured`."""
        return f"{time_words(self.seconds / max(1, workers))}, {'measured' if self.measured else 'estimated'}"


def duration_of(
    experiment: Experiment, trials: Counter[str], measured: dict[str, float], quick: bool = False
) -> Duration:
    """trials: how many, by engine. measured: wall seconds of a trial, by engine, as far as they are known."""
    estimated_s = experiment.seconds(quick) / REAL_TIMES + SET_UP_S
    seconds = sum(measured.get(engine, estimated_s) * count for engine, count in trials.items())
    return Duration(seconds, trials.total(), all(engine in measured for engine in trials))


def time_words(seconds: float) -> str:
    """Such as `40 s`, `12 min` or `3.5 h`."""
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
