"""The table of an experiment: each of its scores by cell and engine, with 95 % intervals, also in words and sentences.

How sure a figure is: Wilson's interval for a rate, the bootstrap for the rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table
from rich.text import Text

from app.experiments.store import StoredTrial
from app.protocol.experiment import Experiment, Original, Score

ENGINE_WORDS = {
    "paper": "the paper's rules", "paper-2005": "the rules of 2005", "paper-2006": "the rules of 2006", "ours": "our rules",
}  # fmt: skip

_Z_95 = 1.959963984540054  # 95 % of a normal distribution lie within so many standard deviations of its mean
_PER_CENT = 2.5, 97.5
_RESAMPLES = 2000
_LEAST_RESAMPLES = 200
_DRAWS = 2_000_000  # at most, in all resamples: ten thousand values need fewer of them
_SEED = 2006
_MOST_ORIGINALS = 6  # the table has the others

CellKey = tuple[str, tuple[str, ...]]  # engine, and levels by label


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value, the ends of its 95 % interval, and what n values it is from. NaN: cannot be told from so few."""

    value: float
    low: float
    high: float
    n: int


@dataclass(frozen=True, slots=True)
class CellSummary:
    """What the trials of one cell came to, by one engine. values: for each of the experiment's scores, by its label."""

    engine: str
    levels: tuple[str, ...]
    n: int  # trials that did not fail
    failed: int
    values: dict[str, Estimate]


def summarise(experiment: Experiment, trials: Iterable[StoredTrial]) -> list[CellSummary]:
    """A row for every cell and engine that has a trial, in the experiment's order. It does not depend on the trials' order."""
    groups: dict[CellKey, list[StoredTrial]] = {}
    for trial in sorted(trials, key=lambda trial: (trial.seed, trial.id)):
        groups.setdefault((trial.engine, trial.levels), []).append(trial)
    return [_summary(experiment, *key, groups[key]) for key in sorted(groups, key=place_in(experiment))]


def leading(experiment: Experiment) -> Score:
    """By what a trial is told to have gone well: the first rate, or the first score where none is a rate."""
    return next((score for score in experiment.scores if score.rate is not None), experiment.scores[0])


def place_in(experiment: Experiment) -> Callable[[CellKey], tuple[tuple[int, int], CellKey]]:
    """By what to sort engines and levels, so that they are in the order of the experiment's cells."""
    engines = list(experiment.engines)
    cells = [tuple(level.label for level in cell) for cell in experiment.cells()]
    order = {(engine, cell): (at, engines.index(engine)) for at, cell in enumerate(cells) for engine in engines}
    last = len(cells), len(engines)
    return lambda key: (order.get(key, last), key)


def _summary(experiment: Experiment, engine: str, levels: tuple[str, ...], trials: list[StoredTrial]) -> CellSummary:
    good = [trial for trial in trials if not trial.error]
    values = {score.label: _estimate(score, good) for score in experiment.scores}
    return CellSummary(engine, levels, len(good), len(trials) - len(good), values)


def _estimate(score: Score, trials: Iterable[StoredTrial]) -> Estimate:
    """A rate is counted over all trials together; any other score is given by its median. Trials without it do not count."""
    if score.rate is None:
        name = str(score.score)
        return bootstrap_median([trial.scores[name] for trial in trials if name in trial.scores])
    good, of = score.rate
    counted = [trial.scores for trial in trials if of in trial.scores]
    return wilson(round(sum(each.get(good, 0.0) for each in counted)), round(sum(each[of] for each in counted)))


def wilson(successes: int, of: int) -> Estimate:
    """A rate from 0 to 1 and its interval, after Wilson (1927). ValueError if there are more successes than trials."""
    if not 0 <= successes <= of:
        raise ValueError(f"successes must be from 0 to of = {of}, got {successes}")
    if of == 0:
        return Estimate(math.nan, 0.0, 1.0, 0)
    rate, z2 = successes / of, _Z_95**2
    middle = (rate + z2 / (2 * of)) / (1 + z2 / of)
    half = _Z_95 / (1 + z2 / of) * math.sqrt(rate * (1 - rate) / of + z2 / (4 * of * of))
    low = 0.0 if successes == 0 else middle - half  # exactly, where the sum would leave a rounding error
    return Estimate(rate, low, 1.0 if successes == of else middle + half, of)


def bootstrap_median(values: Sequence[float]) -> Estimate:
    """The median and its interval. The same values in the same order give the same interval."""
    return _bootstrap(values, np.median)


def bootstrap_mean(values: Sequence[float]) -> Estimate:
    """The mean and its interval. The same values in the same order give the same interval."""
    return _bootstrap(values, np.mean)


def _bootstrap(values: Sequence[float], statistic: Callable[..., Any]) -> Estimate:
    """Percentiles of the statistic over samples drawn from the values with replacement (Efron 1979)."""
    sample: NDArray[np.float64] = np.asarray(values, np.float64)
    n = len(sample)
    if n == 0:
        return Estimate(math.nan, math.nan, math.nan, 0)
    if n == 1:
        return Estimate(float(sample[0]), math.nan, math.nan, 1)
    resamples = max(_LEAST_RESAMPLES, min(_RESAMPLES, _DRAWS // n))
    drawn = sample[np.random.default_rng(_SEED).integers(0, n, (resamples, n))]
    low, high = np.percentile(statistic(drawn, axis=1), _PER_CENT)
    return Estimate(float(statistic(sample)), float(low), float(high), n)


def value_of(score: Score, trial: StoredTrial) -> float | None:
    """The score of one trial; None where it has none."""
    if score.rate is None:
        return trial.scores.get(str(score.score))
    good, of = (trial.scores.get(name) for name in score.rate)
    return (good or 0.0) / of if of else None


def words_of(score: Score, value: float) -> str:
    """A value of a score with its unit."""
    if score.rate is not None:
        return f"{100 * value:.0f} %"
    text = f"{value:.0f}" if abs(value) >= 100 or value == int(value) else f"{value:.3g}"
    return f"{text} {score.unit}".rstrip()


def words(value: Estimate, score: Score) -> str:
    """Such as `83 % (66-93)` or `0.12 m (0.10-0.15)`."""
    if value.n == 0:
        return "-"
    if score.rate is not None:
        return f"{value.value:.0%} ({100 * value.low:.0f}-{100 * value.high:.0f})".replace("%", " %")
    unit = f" {score.unit}" if score.unit else ""
    if value.low != value.low:  # NaN: one trial has no interval
        return f"{_digits(value.value)}{unit}"
    return f"{_digits(value.value)}{unit} ({_digits(value.low)}-{_digits(value.high)})"


def _digits(value: float) -> str:
    """Three digits, or all those before the point."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def found(experiment: Experiment, cells: list[CellSummary]) -> list[str]:
    """What we found, in sentences made from the numbers, so that they cannot say anything else: one for each engine, then one
    for each value of the paper."""
    engines = [engine for engine in experiment.engines if any(cell.engine == engine for cell in cells)]
    says = [_engine(experiment, engine, [c for c in cells if c.engine == engine]) for engine in engines]
    originals = experiment.original[:_MOST_ORIGINALS] if cells else []
    return says + [_original(experiment, cells, each, engines) for each in originals]


def _engine(experiment: Experiment, engine: str, cells: list[CellSummary]) -> str:
    parts = [_score(score, cells) for score in experiment.scores]
    return f"By {ENGINE_WORDS[engine]}: {'; '.join(filter(None, parts)) or 'no scores'}."


def _score(score: Score, cells: list[CellSummary]) -> str:
    known = sorted((c for c in cells if c.values[score.label].n), key=lambda cell: cell.values[score.label].value)
    if not known:
        return ""
    least, most = known[0], known[-1]
    if least.values[score.label].value == most.values[score.label].value:
        where = " at all levels" if len(known) > 1 else ""
        return f"{score.label} {words(most.values[score.label], score)}{where}"
    low, high = (f"{words(c.values[score.label], score)} at {', '.join(c.levels)}" for c in (least, most))
    return f"{score.label} {low}, to {high}"


def _original(experiment: Experiment, cells: list[CellSummary], original: Original, engines: list[str]) -> str:
    score = next(each for each in experiment.scores if each.label == original.score)
    where = f" at {', '.join(original.levels)}" if original.levels else ""
    ours: list[str] = []
    for engine in engines:
        same = [c for c in cells if c.engine == engine and set(original.levels) <= set(c.levels)]
        if len(same) == 1 and same[0].values[score.label].n:
            ours.append(f"{words(same[0].values[score.label], score)} by {ENGINE_WORDS[engine]}")
    beside = " and ".join(ours) or "nothing that stands at the same levels"
    return f"The paper has {score.label} {words_of(score, original.value)}{where}; here it is {beside}."


def table_of(experiment: Experiment, rows: Sequence[CellSummary]) -> Table:
    """A row for each cell and engine, for a terminal. n: trials; failed ones are told after it.

    Labels are the user's: as `Text`, rich reads no markup in them.
    """
    table = Table(box=None, header_style="bold", pad_edge=False)
    for name in (*(axis.name for axis in experiment.axes), "engine"):
        table.add_column(Text(name), no_wrap=True)
    for name in ("n", *(score.label for score in experiment.scores)):
        table.add_column(Text(name), justify="right")
    for row in rows:
        levels = [*map(Text, row.levels), *[""] * (len(experiment.axes) - len(row.levels))]
        n = f"{row.n} + {row.failed} failed" if row.failed else str(row.n)
        values = [words(row.values[score.label], score) for score in experiment.scores]
        table.add_row(*levels, row.engine, n, *map(Text, values))
    return table
