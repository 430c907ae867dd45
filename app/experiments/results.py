"""docs/results.md: every result, also the bad ones. It is made of docs/results.json, and that of the stored trials.

A test makes the text again from the numbers, and compares the experiments of then with those of now.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any, cast

from app.code_version import code_version
from app.experiments.store import StoredTrial
from app.experiments.summary import (
    ENGINE_WORDS,
    CellKey,
    CellSummary,
    Estimate,
    found,
    leading,
    summarise,
    words,
    words_of,
)
from app.experiments.verdicts import HEADS, JUDGED, rows, verdicts
from app.protocol.experiment import Experiment

DOCS = Path(__file__).parents[2] / "docs"
_HEADING = """# Results

Every experiment of the papers that is run again here: what the paper has, what its own rules come to in our office, and
what ours do. The numbers are in [results.json](results.json); this file is made from them by `ratslam experiment results`
and must not be edited. Rates have their 95 % intervals after Wilson, medians theirs by the bootstrap. n is the number of
trials of each engine at these levels.
"""
BESIDE = 2  # engines whose scores stand side by side in a row


def definition_digest(experiment: Experiment) -> str:
    """Of all that decides the numbers: what is run, how often, and what is measured. Texts and figures do not count."""
    decides = {
        "name",
        "world",
        "trials",
        "seed",
        "set",
        "engines",
        "axes",
        "protocol",
        "scores",
        "original",
    }
    tree = experiment.model_dump(mode="json", include=decides)
    return hashlib.sha256(json.dumps(tree, sort_keys=True).encode()).hexdigest()[:16]


def gathered(runs: Iterable[tuple[Experiment, Sequence[StoredTrial]]]) -> dict[str, Any]:
    """The numbers of all experiments, as they stand in docs/results.json. Experiments without trials are left out.

    Quick trials do not count.
    """
    full = [(experiment, [trial for trial in trials if not trial.quick]) for experiment, trials in runs]
    return {"experiments": {experiment.name: _run(experiment, trials) for experiment, trials in full if trials}}


def _run(experiment: Experiment, trials: Sequence[StoredTrial]) -> dict[str, Any]:
    each: dict[CellKey, list[StoredTrial]] = {}
    for trial in sorted(trials, key=lambda trial: (trial.seed, trial.id)):
        if not trial.error:
            each.setdefault((trial.engine, trial.levels), []).append(trial)
    score = leading(experiment)
    names = score.rate or (str(score.score),)
    return {
        "definition": definition_digest(experiment),
        "version": next((trial.version for trial in trials if trial.version), code_version()),
        "seeds": _ends(sorted({trial.seed for trial in trials})),
        "cells": [
            {**_row(cell), "trials": [_trial_row(trial, names) for trial in each.get((cell.engine, cell.levels), [])]}
            for cell in summarise(experiment, trials)
        ],
    }


def results_markdown(data: Mapping[str, Any], experiments: Sequence[Experiment]) -> str:
    """The text of docs/results.md: the experiments in this order, those without numbers named at the end."""
    numbers = data["experiments"]
    parts = [*filter(None, (_HEADING, _verdicts(data, experiments)))]
    parts += [
        _section(experiment, numbers[experiment.name]) for experiment in experiments if experiment.name in numbers
    ]
    missing = [experiment.name for experiment in experiments if experiment.name not in numbers]
    if missing:
        parts.append(f"## Not run yet\n\n{', '.join(missing)}\n")
    return "\n".join(parts)


def _verdicts(data: Mapping[str, Any], experiments: Sequence[Experiment]) -> str:
    """Of every claim of the papers, whether it holds: what a reader asks first."""
    found = list(verdicts((experiment, cells_of(data, experiment.name)) for experiment in experiments))
    if not found:
        return ""
    titles = {experiment.name: experiment.title for experiment in experiments}
    linked = [(f"[{name}](#{_anchor(titles[name])})", *rest) for name, *rest in rows(found)]
    held = {engine: [v.agrees for v in found if v.engine == engine and v.agrees is not None] for engine in JUDGED}
    counts = ", ".join(
        f"{sum(held[e])} of {len(held[e])} by {words}" for e, words in (("paper", "their own rules"), ("ours", "ours"))
    )
    return f"""## Does it agree with the papers?

What the papers claim, and whether it holds here: {counts}. `ratslam experiment verdicts` prints this and fails when one
of them has changed.

{_lines([HEADS, ["---"] * len(HEADS), *linked])}
"""


def _anchor(title: str) -> str:
    """Of a heading, as the pages that show Markdown make it."""
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def outdated(data: Mapping[str, Any], experiments: Sequence[Experiment]) -> list[str]:
    """Names of experiments whose numbers are of another definition, or of one that is no more."""
    now = {experiment.name: definition_digest(experiment) for experiment in experiments}
    return [name for name, run in data["experiments"].items() if now.get(name) != run["definition"]]


def write_results(
    runs: Sequence[tuple[Experiment, Sequence[StoredTrial]]], folder: Path, *, keep: bool = True
) -> tuple[Path, Path]:
    """Write results.json and results.md into a folder.

    keep: experiments that have no trials in these runs keep the numbers that the folder has of them.
    """
    experiments = [experiment for experiment, _ in runs]
    data, path = gathered(runs), folder / "results.json"
    if keep and path.exists():
        known = read_results(path)["experiments"]
        names = [experiment.name for experiment in experiments]
        old = {name: known[name] for name in names if name in known and name not in data["experiments"]}
        merged = {**old, **data["experiments"]}
        data = {"experiments": {name: merged[name] for name in names if name in merged}}
    path.write_text(_text_of(data), encoding="utf-8")
    markdown = folder / "results.md"
    markdown.write_text(results_markdown(data, experiments), encoding="utf-8")
    return path, markdown


def _text_of(data: Mapping[str, Any]) -> str:
    """JSON with a line for each cell, so that what has changed can be seen."""

    def text(value: object) -> str:
        return json.dumps(value, ensure_ascii=False, allow_nan=False)

    runs: list[str] = []
    for name, run in data["experiments"].items():
        head = ", ".join(f"{text(key)}: {text(value)}" for key, value in run.items() if key != "cells")
        cells = ",\n".join(map(text, run["cells"]))
        runs.append(f'{text(name)}: {{{head}, "cells": [\n{cells}\n]}}')
    return '{"experiments": {\n' + ",\n".join(runs) + "\n}}\n"


def read_results(path: Path) -> dict[str, Any]:
    """The numbers of docs/results.json. ValueError if it is not such a file."""
    try:
        data: Any = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None
    experiments: Any = cast("dict[str, Any]", data).get("experiments") if isinstance(data, dict) else None
    if not isinstance(experiments, dict):
        raise ValueError(f'{path}: expected {{"experiments": ...}}, as `ratslam experiment results` writes it')
    return {"experiments": experiments}


def published(name: str, path: Path = DOCS / "results.json") -> tuple[list[CellSummary], list[StoredTrial]]:
    """The cells of an experiment as they stand in docs/results.json, and its trials; none if it is not there.

    Each trial has what its leading score is made of, and no id: nobody has run it here.
    """
    data = read_results(path)
    run = data["experiments"].get(name)
    trials = [
        StoredTrial("", row["engine"], tuple(row["levels"]), seed, scores, moment_s, moment, version=run["version"])
        for row in (run["cells"] if run else ())
        for seed, moment_s, moment, scores in row.get("trials", ())
    ]
    return cells_of(data, name), trials


def cells_of(data: Mapping[str, Any], name: str) -> list[CellSummary]:
    """The cells of an experiment in the numbers of docs/results.json; none if it is not there."""
    run = data["experiments"].get(name)
    return [] if run is None else [_cell(row) for row in run["cells"]]


# ------------------------------------------------------------ a section


def _section(experiment: Experiment, run: Mapping[str, Any]) -> str:
    cells = [_cell(row) for row in run["cells"]]
    says = "\n".join(f"- {sentence}" for sentence in found(experiment, cells))
    low, high = run["seeds"]
    seeds = f"seed {low}" if low == high else f"seeds {low} to {high}"
    failed = sum(cell.failed for cell in cells)
    broken = f", {failed} trials ended with an error" if failed else ""
    sources = list(dict.fromkeys(original.source for original in experiment.original))
    source = f"\nThe paper's values: {'; '.join(sources)}.\n" if sources else ""
    return f"""## {experiment.title}

{experiment.paper}. `ratslam experiment {experiment.name}`; {seeds}, code version {run["version"]}{broken}.

Asked: {experiment.asks}

The paper found: {experiment.found}
{_picture(experiment)}{_beside(experiment)}
{says}

{_table(experiment, cells)}
{source}"""


def _picture(experiment: Experiment) -> str:
    """The experiment's first figure, if it is among the documentation's pictures."""
    for suffix in (".svg", ".png"):
        name = f"pictures/experiments/{experiment.name}{suffix}"
        if (DOCS / name).exists():
            title = experiment.figures[0].title if experiment.figures else experiment.title
            return f"\n![{title}]({name})\n"
    return ""


def _beside(experiment: Experiment) -> str:
    """The paper's figures and ours, axis by axis. All but the first of ours are on the experiment's own page."""
    told = [(figure.title, figure.paper) for figure in experiment.figures if figure.paper]
    return f"\n{_lines([('figure', 'beside the paper'), ('---', '---'), *told])}\n" if told else ""


def _table(experiment: Experiment, cells: list[CellSummary]) -> str:
    """A row for each cell; for each score the paper's value, if there is one at all, and each engine's.

    Of more than two engines each has rows of its own.
    """
    engines = [engine for engine in experiment.engines if any(cell.engine == engine for cell in cells)]
    if len(engines) > BESIDE:
        heads = ["rules", *(axis.name for axis in experiment.axes), "n", *(score.label for score in experiment.scores)]
        told = [
            [
                ENGINE_WORDS[cell.engine],
                *cell.levels,
                str(cell.n),
                *(words(cell.values[s.label], s) for s in experiment.scores),
            ]
            for engine in engines
            for cell in cells
            if cell.engine == engine
        ]
        return _lines([heads, ["---"] * len(heads), *told])
    heads = [*(axis.name for axis in experiment.axes), "n"]
    for score in experiment.scores:
        if any(original.score == score.label for original in experiment.original):
            heads.append(f"{score.label}: the paper")
        heads += [f"{score.label}: {ENGINE_WORDS[engine]}" for engine in engines]
    rows = [heads, ["---"] * len(heads)]
    for levels in dict.fromkeys(cell.levels for cell in cells):
        at = {cell.engine: cell for cell in cells if cell.levels == levels}
        row = [*levels, str(max(cell.n for cell in at.values()))]
        for score in experiment.scores:
            of = [original for original in experiment.original if original.score == score.label]
            here = [words_of(score, o.value) for o in of if set(o.levels) <= set(levels)]
            row += [here[0] if here else ""] if of else []
            row += [words(at[engine].values[score.label], score) if engine in at else "-" for engine in engines]
        rows.append(row)
    return _lines(rows)


def _lines(rows: Sequence[Sequence[str]]) -> str:
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)


# ------------------------------------------------------------ numbers as JSON, which knows no NaN


def _row(cell: CellSummary) -> dict[str, Any]:
    values = {label: [_number(part) for part in astuple(each)] for label, each in cell.values.items()}
    return {"engine": cell.engine, "levels": list(cell.levels), "n": cell.n, "failed": cell.failed, "values": values}


def _trial_row(trial: StoredTrial, names: Iterable[str]) -> list[Any]:
    scores = {name: _number(trial.scores[name]) for name in names if name in trial.scores}
    return [trial.seed, round(trial.moment_s, 1), trial.moment_words, scores]


def _cell(row: Mapping[str, Any]) -> CellSummary:
    values = {
        label: Estimate(*(math.nan if part is None else float(part) for part in parts[:3]), n=int(parts[3]))
        for label, parts in row["values"].items()
    }
    return CellSummary(row["engine"], tuple(row["levels"]), row["n"], row["failed"], values)


def _number(value: float) -> float | int | None:
    """Six digits: more would change with the machine's last bit."""
    return value if isinstance(value, int) else float(f"{value:.6g}") if math.isfinite(value) else None


def _ends(seeds: list[int]) -> list[int]:
    return [seeds[0], seeds[-1]]
