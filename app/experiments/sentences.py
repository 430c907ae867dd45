"""What we found, in sentences made from the numbers, so that they cannot say anything else."""

from __future__ import annotations

from app.experiments.summary import CellSummary, words
from app.experiments.words import ENGINE_WORDS, words_of
from app.trials.experiment import Experiment, Original, Score

_MOST_ORIGINALS = 6  # the table has the others


def found(experiment: Experiment, cells: list[CellSummary]) -> list[str]:
    """A sentence for each engine, then one for each value of the paper."""
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
