"""What we found, in sentences made from the numbers, so that they cannot say anything else."""

from __future__ import annotations

from app.experiments.figures.material import Material, words_of
from app.experiments.figures.palette import ENGINE_WORDS
from app.experiments.summary import CellSummary, words
from app.trials.experiment import Experiment, Original, Score


def found(material: Material) -> list[str]:
    """A sentence for each engine, then one for each value of the paper."""
    experiment = material.experiment
    engines = [engine for engine in experiment.engines if any(cell.engine == engine for cell in material.cells)]
    says = [_engine(experiment, engine, [c for c in material.cells if c.engine == engine]) for engine in engines]
    return [*says, *(_original(material, each, engines) for each in experiment.original)]


def _engine(experiment: Experiment, engine: str, cells: list[CellSummary]) -> str:
    parts = [_score(experiment, score, cells) for score in experiment.scores]
    return f"By {ENGINE_WORDS[engine]}: {'; '.join(filter(None, parts))}."


def _score(experiment: Experiment, score: Score, cells: list[CellSummary]) -> str:
    known = sorted((c for c in cells if c.values[score.label].n), key=lambda cell: cell.values[score.label].value)
    if not known:
        return ""
    least, most = known[0], known[-1]
    if least.values[score.label].value == most.values[score.label].value:
        where = " everywhere" if len(known) > 1 else ""
        return f"{score.label} {words(most.values[score.label], score)}{where}"
    low, high = (f"{words(c.values[score.label], score)} at {place(experiment, c)}" for c in (least, most))
    return f"{score.label} from {low} to {high}"


def _original(material: Material, original: Original, engines: list[str]) -> str:
    score = material.score(original.score)
    where = f" ({', '.join(original.levels)})" if original.levels else ""
    ours: list[str] = []
    for engine in engines:
        cells = [c for c in material.cells if c.engine == engine and set(original.levels) <= set(c.levels)]
        if len(cells) == 1 and cells[0].values[score.label].n:
            ours.append(f"{words(cells[0].values[score.label], score)} by {ENGINE_WORDS[engine]}")
    beside = " and ".join(ours) or "nothing that stands at the same levels"
    return f"Where the paper has {score.label} {words_of(score, original.value)}{where}, we have {beside}."


def place(experiment: Experiment, cell: CellSummary) -> str:
    """The levels of a cell in words."""
    return ", ".join(f"{axis.name} {label}" for axis, label in zip(experiment.axes, cell.levels, strict=True))
