"""What an experiment leaves behind: its trials as CSV, its figures, and the page that shows them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from app.experiments.export import write_csv
from app.experiments.report import Report, write_report_page
from app.experiments.stored_trial import StoredTrial
from app.experiments.workers import Workers
from app.trials.experiment import Experiment


def make_folder(folder: Path) -> Path:
    """The folder, made if it does not exist. ValueError says why it cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--out {folder}: {error.strerror or error}") from None
    return folder


def write_outputs(
    experiment: Experiment, stored: Sequence[StoredTrial], folder: Path, workers: Workers, *, command: str, quick: bool
) -> tuple[Path, Report]:
    """The table and the report. stored: the trials that were run; workers: run those again that the figures show."""
    table = folder / f"{experiment.name}.csv"
    write_csv(table, experiment, stored)
    return table, write_report_page(experiment, list(stored), folder, workers.traces, command=command, quick=quick)
