"""The grid of an experiment: its first score in each cell, and the trials behind it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from app.experiments.stored_trial import StoredTrial
from app.experiments.summary import CellSummary, summarise, words
from app.trials.code_version import code_version
from app.trials.experiment import EngineName, Experiment, Score
from web.http.experiments import Cell, Dot, Results

EARLIER = "These trials were run by an earlier version of the program: played today, they may go otherwise."
PUBLISHED = "These are the program's own results, as in docs/results.md; none of these trials was run here yet."
QUICK = "These are short trials, run to see that the experiment works; they say little."


def results_of(experiment: Experiment, stored: Sequence[StoredTrial], published: Sequence[CellSummary] = ()) -> Results:
    """stored: all trials of the experiment, the oldest first. Those shown are of one kind, the best there is.

    published: what stands in docs/results.md, for want of trials.
    """
    trials, note = _chosen([trial for trial in stored if not trial.error])
    cells = summarise(experiment, trials) if trials else published
    if not trials and published:
        note = PUBLISHED
    score = next((score for score in experiment.scores if score.rate is not None), experiment.scores[0])
    found = {(cell.engine, cell.levels): cell for cell in cells if score.label in cell.values}
    values = [cell.values[score.label].value for cell in found.values()]
    finite = [value for value in values if math.isfinite(value)]
    span = (0.0, 1.0) if score.rate is not None else (min(finite, default=0.0), max(finite, default=1.0))
    return Results(
        score=score.label,
        is_rate=score.rate is not None,
        note=note,
        cells=[
            _cell(score, engine, levels, found.get((engine, levels)), span, _of(trials, engine, levels))
            for engine in experiment.engines
            for levels in _cells(experiment)
        ],
    )


def _chosen(trials: list[StoredTrial]) -> tuple[list[StoredTrial], str]:
    whole = [trial for trial in trials if not trial.quick]
    current = [trial for trial in whole if trial.version == code_version()]
    if current or not trials:
        return current, ""
    return _newest(whole or trials), EARLIER if whole else QUICK


def _newest(trials: list[StoredTrial]) -> list[StoredTrial]:
    """One of each cell and seed, the one that was run last."""
    return list({(trial.engine, trial.levels, trial.seed): trial for trial in trials}.values())


def _cells(experiment: Experiment) -> list[tuple[str, ...]]:
    return [tuple(level.label for level in cell) for cell in experiment.cells()]


def _of(trials: list[StoredTrial], engine: str, cell: tuple[str, ...]) -> list[StoredTrial]:
    mine = [trial for trial in trials if trial.engine == engine and trial.levels == cell]
    return sorted(mine, key=lambda trial: (trial.seed, trial.id))


def _share(value: float, low: float, high: float) -> float | None:
    if not math.isfinite(value):
        return None
    return 0.5 if high <= low else (value - low) / (high - low)


def _cell(
    score: Score, engine: EngineName, levels: tuple[str, ...], summary: CellSummary | None, span: tuple[float, float],
    trials: list[StoredTrial],
) -> Cell:  # fmt: skip
    dots = [_dot(score, trial) for trial in trials]
    if summary is None or summary.n == 0:
        return Cell(engine=engine, levels=list(levels), n=0, words="", shade=None, dots=dots)
    value = summary.values[score.label]
    shade = _share(value.value, *span)
    return Cell(engine=engine, levels=list(levels), n=summary.n, words=words(value, score), shade=shade, dots=dots)


def _dot(score: Score, trial: StoredTrial) -> Dot:
    good = of = None
    if score.rate is None:
        value = trial.scores.get(str(score.score))
        said = "not measured" if value is None else f"{value:.3g} {score.unit}".rstrip()
    else:
        good, of = (round(trial.scores.get(name, 0.0)) for name in score.rate)
        said = f"{good} of {of}"
    return Dot(
        id=trial.id, seed=trial.seed, quick=trial.quick, good=good, of=of, words=said, moment_s=trial.moment_s,
        moment=trial.moment_words,
    )  # fmt: skip
