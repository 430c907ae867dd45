"""What an experiment leaves behind: its trials as CSV, and the page with its figures."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from app.experiments.export import write_csv
from app.experiments.stored_trial import StoredTrial
from app.trials.experiment import Experiment
from app.trials.trial import Trial


def write_outputs(experiment: Experiment, plan: Sequence[Trial], stored: Sequence[StoredTrial], folder: Path) -> list[Path]:
    """Write everything into a folder and return the files. plan: the trials asked for; stored: those that were run.

    OSError, ValueError: the folder cannot be made or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"--out {folder}: {error.strerror or error}") from None
    table = folder / f"{experiment.name}.csv"
    write_csv(table, experiment, stored)
    return [*_page(experiment, plan, stored, folder), table]


def _page(experiment: Experiment, plan: Sequence[Trial], stored: Sequence[StoredTrial], folder: Path) -> list[Path]:
    if find_spec("app.experiments.report") is None:
        return []
    from app.experiments.report import write_report_page  # pyright: ignore

    return write_report_page(experiment, plan, stored, folder)
