"""Trials to take elsewhere: a row for each, with its levels, its scores, and the id by which it can be opened."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path

from app.experiments.store import StoredTrial
from app.protocol.experiment import Experiment
from disk import write_whole

_FIRST = ["id", "engine"]
_LAST = ["seed", "version", "quick", "simulated_s", "wall_s", "moment_s", "moment", "error"]

_FORMULA = ("=", "+", "-", "@")
_NUMBER = re.compile(r"[+-]?[0-9.]+( [^ =@+-]*)?")  # with a unit
Cell = str | int | float | bool | None


def write_csv(path: Path, experiment: Experiment, trials: Sequence[StoredTrial]) -> None:
    """OSError names the file."""
    columns, rows = table_of(experiment, trials)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([_no_formula(column) for column in columns])
    writer.writerows([_no_formula(cell) for cell in row] for row in rows)
    write_whole(path, text.getvalue())


def _no_formula(cell: Cell) -> Cell:
    """A spreadsheet would calculate a text that begins like a formula. Numbers, also as text, stay as they are."""
    if not isinstance(cell, str) or not cell.startswith(_FORMULA) or _NUMBER.fullmatch(cell):
        return cell
    return f"'{cell}"


def table_of(experiment: Experiment, trials: Sequence[StoredTrial]) -> tuple[list[str], list[list[Cell]]]:
    """Column names and rows. An axis has the column of its name."""
    scores = _scores(trials)
    axes = [axis.name for axis in experiment.axes]
    columns = [*_FIRST, *(_free(axis, _FIRST + _LAST, "axis") for axis in axes), *_LAST]
    columns += [_free(score, columns, "score") for score in scores]
    rows: list[list[Cell]] = [
        [
            trial.id, trial.engine, *_levels(trial, len(axes)), trial.seed, trial.version, trial.quick, trial.simulated_s,
            trial.wall_s, trial.moment_s, trial.moment_words, trial.error, *(trial.scores.get(name) for name in scores),
        ]
        for trial in trials
    ]  # fmt: skip
    return columns, rows


def _free(name: str, taken: Sequence[str], kind: str) -> str:
    """A name for a column: no two have the same."""
    return f"{name} ({kind})" if name in taken else name


def _levels(trial: StoredTrial, axes: int) -> list[str | None]:
    """One for each axis. Older trials may be from a file with other axes."""
    return [*trial.levels[:axes], *[None] * (axes - len(trial.levels))]


def _scores(trials: Sequence[StoredTrial]) -> list[str]:
    return sorted({name for trial in trials for name in trial.scores})
