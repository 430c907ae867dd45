"""The files that an experiment leaves behind for people: its page, its figures, and the index of all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from app.experiments.figures import draw, wanted
from app.experiments.figures.canvas import png_of, svg_of
from app.experiments.figures.material import Drawn, Material
from app.experiments.page.page import Entry, index_of, page_of, picture_of
from app.experiments.sentences import found
from app.experiments.stored_trial import StoredTrial
from app.trials.experiment import Experiment
from app.trials.trace import Trace
from app.trials.trial import Trial


@dataclass(frozen=True, slots=True)
class Report:
    """What was written. entry: for the index."""

    page: Path
    figures: list[Path]
    entry: Entry


def write_report_page(
    experiment: Experiment,
    trials: list[StoredTrial],
    out: Path,
    traces: Callable[[list[Trial]], list[Trace]],
    *,
    command: str,
    quick: bool = False,
) -> Report:
    """Write `NAME.html` into `out`, and each figure as SVG and PNG into `out/figures`.

    trials: those of this experiment, in any order; traces: runs some of them again, in the order given; quick: whether
    they are those of the shortened experiment. ValueError names
    an experiment and figure whose options do not fit.
    """
    good = sorted((t for t in trials if not t.error), key=lambda t: (t.seed, t.engine, t.levels))
    material = Material(experiment, good)
    drawn = figures_of(material, traces, quick=quick) if good else []
    folder = out / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for number, each in enumerate(drawn, start=1):
        path = folder / f"{experiment.name}-{number}-{each.spec.kind}"
        path.with_suffix(".svg").write_text(svg_of(each.figure), encoding="utf-8")
        path.with_suffix(".png").write_bytes(png_of(each.figure))
        written += [path.with_suffix(".svg"), path.with_suffix(".png")]
    page = out / f"{experiment.name}.html"
    page.write_text(page_of(material, drawn, command, [t for t in trials if t.error]), encoding="utf-8")
    picture = picture_of(drawn[0], experiment.name) if drawn else ""
    return Report(page, written, Entry(experiment, page.name, found(experiment, material.cells), picture, len(good)))


def write_index(reports: list[Report], out: Path, command: str) -> Path:
    """Write `index.html` into `out`: all experiments, each with its first figure."""
    path = out / "index.html"
    path.write_text(index_of([report.entry for report in reports], command), encoding="utf-8")
    return path


def figures_of(material: Material, traces: Callable[[list[Trial]], list[Trace]], *, quick: bool = False) -> list[Drawn]:
    """All figures of an experiment; the trials that they show are run again, each once."""
    experiment = material.experiment
    ids = list(dict.fromkeys(each for spec in experiment.figures for each in wanted(spec, material)))
    known = trials_by_id(experiment, material.trials, quick=quick)
    missing = [each for each in ids if each not in known]
    if missing:
        raise ValueError(
            f"trial {missing[0]} of {experiment.name} is of another version of the program or the experiment"
        )
    material.traces.update({trace.trial.id: trace for trace in traces([known[each] for each in ids])} if ids else {})
    return [draw(spec, material) for spec in experiment.figures]


def trials_by_id(experiment: Experiment, stored: list[StoredTrial], *, quick: bool = False) -> dict[str, Trial]:
    """The trials as they are run, found by the ids of those that are stored."""
    most = max((trial.seed for trial in stored), default=experiment.seed) - experiment.seed + 1
    return {trial.id: trial for trial in experiment.make_trials(trials=max(most, 1), quick=quick)}
