"""The table of an experiment: each of its scores by cell and engine, with intervals."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from app.experiments.intervals import Estimate, bootstrap_median, wilson
from app.experiments.stored_trial import StoredTrial
from app.trials.experiment import Experiment, Score

CellKey = tuple[str, tuple[str, ...]]  # engine, and levels by label


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


def place_in(experiment: Experiment) -> Callable[[CellKey], tuple[tuple[int, int], CellKey]]:
    """By what to sort engines and levels, so that they are in the order of the experiment's cells."""
    engines = list(experiment.engines)
    cells = [tuple(level.label for level in cell) for cell in experiment.cells()]
    order = {(engine, cell): (at, engines.index(engine)) for at, cell in enumerate(cells) for engine in engines}
    last = len(cells), len(engines)
    return lambda key: (order.get(key, last), key)


def estimate(score: Score, trials: Iterable[StoredTrial]) -> Estimate:
    """A rate is counted over all trials together; any other score is given by its median. Trials without it do not count."""
    if score.rate is None:
        name = str(score.score)
        return bootstrap_median([trial.scores[name] for trial in trials if name in trial.scores])
    good, of = score.rate
    counted = [trial.scores for trial in trials if of in trial.scores]
    return wilson(round(sum(each.get(good, 0.0) for each in counted)), round(sum(each[of] for each in counted)))


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


def _summary(experiment: Experiment, engine: str, levels: tuple[str, ...], trials: list[StoredTrial]) -> CellSummary:
    good = [trial for trial in trials if not trial.error]
    values = {score.label: estimate(score, good) for score in experiment.scores}
    return CellSummary(engine, levels, len(good), len(trials) - len(good), values)
