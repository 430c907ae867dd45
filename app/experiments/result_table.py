"""The table of an experiment on a terminal: a row for each cell and engine, its scores with their intervals."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from app.experiments.summary import CellSummary, words
from app.trials.experiment import Experiment


def table_of(experiment: Experiment, rows: Sequence[CellSummary]) -> Table:
    """n: trials; failed ones are told after it. Labels are the user's: as `Text`, rich reads no markup in them."""
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
