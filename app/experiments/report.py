"""What an experiment leaves behind for people: its trials as CSV, its figures, its page, and the index of all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from app.experiments.export import write_csv
from app.experiments.figures import NEED_TRACES, draw, wanted
from app.experiments.figures.canvas import png_of, svg_of
from app.experiments.figures.material import Drawn, Material
from app.experiments.page import Entry, index_of, page_of, picture_of
from app.experiments.pool import Workers
from app.experiments.store import StoredTrial
from app.experiments.summary import found, table_of
from app.protocol.experiment import Experiment
from app.protocol.trace import Trace
from app.protocol.trial import Trial
from disk.state_reading import words_of


@dataclass(frozen=True, slots=True)
class Report:
    """What was written. entry: for the index."""

    page: Path
    figures: list[Path]
    entry: Entry


def write_outputs(
    experiment: Experiment, trials: Sequence[Trial], stored: Sequence[StoredTrial], folder: Path, workers: Workers, *,
    command: str,
) -> tuple[Path, Report]:  # fmt: skip
    """The table and the report. stored: what came of the trials; workers: run those again that the figures show."""
    table = folder / f"{experiment.name}.csv"
    write_csv(table, experiment, stored)
    known = {trial.id: trial for trial in trials}
    return table, write_report_page(
        experiment, list(stored), folder, lambda ids: workers.traces([known[each] for each in ids]), command=command
    )


def write_report_page(
    experiment: Experiment,
    trials: list[StoredTrial],
    out: Path,
    traces: Callable[[list[str]], list[Trace]],
    *,
    command: str,
) -> Report:
    """Write `NAME.html` into `out`, and each figure as SVG and PNG into `out/figures`.

    trials: those of this experiment, in any order; traces: runs some of them again, by their ids, in the order given.
    ValueError names an experiment and figure whose options do not fit.
    """
    good = sorted((t for t in trials if not t.error), key=lambda t: (t.seed, t.engine, t.levels))
    material = Material(experiment, good)
    drawn = _figures_of(material, traces) if good else []
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


def _figures_of(material: Material, traces: Callable[[list[str]], list[Trace]]) -> list[Drawn]:
    """All figures of an experiment; the trials that they show are run again, each once."""
    experiment = material.experiment
    ids = list(dict.fromkeys(each for spec in experiment.figures for each in wanted(spec, material)))
    material.traces.update({trace.trial.id: trace for trace in traces(ids)} if ids else {})
    return [draw(spec, material) for spec in experiment.figures]


def write_index(reports: list[Report], out: Path, command: str) -> Path:
    """Write `index.html` into `out`: all experiments, each with its first figure."""
    path = out / "index.html"
    path.write_text(index_of([report.entry for report in reports], command), encoding="utf-8")
    return path


def make_folder(folder: Path) -> Path:
    """The folder, made if it does not exist. ValueError says why it cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--out {folder}: {error.strerror or error}") from None
    return folder


def check_drawing(experiment: Experiment) -> None:
    """Draw what it will draw, of scores that are made up. ValueError: a figure or the page cannot be drawn.

    Figures of single trials are left out: they need runs.
    """
    material = Material(experiment, _made_up(experiment))
    table_of(experiment, material.cells)
    drawn: list[Drawn] = []
    for spec in (spec for spec in experiment.figures if spec.kind not in NEED_TRACES):
        try:
            drawn.append(draw(spec, material))
            png_of(drawn[-1].figure)
        except Exception as error:  # whatever matplotlib raises
            raise ValueError(f"figure {spec.title or spec.kind!r} cannot be drawn: {words_of(error)}") from None
    page_of(material, drawn, "", [])


def _made_up(experiment: Experiment) -> list[StoredTrial]:
    """Two trials in each cell, which have all scores."""
    cells = [tuple(level.label for level in cell) for cell in experiment.cells()]
    keys = [(engine, levels, seed) for seed in (1, 2) for engine in experiment.engines for levels in cells]
    return [
        StoredTrial(
            f"{number:016x}", engine, levels, seed, dict.fromkeys(experiment.readings, float(seed)), 1.0, "made up"
        )
        for number, (engine, levels, seed) in enumerate(keys)
    ]
