"""Every experiment of the catalogue, made short: `ratslam experiment all --quick`, from its trials to its page."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from app.cli.command_line import main
from app.experiments.store import Store
from app.protocol.experiment import catalogue


@pytest.mark.long
def test_every_experiment_runs_from_its_trials_to_its_page(tmp_path: Path) -> None:
    store, out = tmp_path / "trials.sqlite", tmp_path / "out"
    command = ["experiment", "all", "--quick", "--workers", "2", "--store", str(store), "--out", str(out)]
    assert main(command) == 0
    with Store(store) as kept:
        for experiment in catalogue():
            stored = kept.stored(experiment.make_trials(quick=True))
            assert len(stored) == len(experiment.make_trials(quick=True))
            assert [trial.error for trial in stored if trial.error] == [], experiment.name
            page = (out / f"{experiment.name}.html").read_text(encoding="utf-8")
            assert all(trial.id in page for trial in stored), experiment.name
            with (out / f"{experiment.name}.csv").open(encoding="utf-8") as table:
                assert {row["id"] for row in csv.DictReader(table)} == {trial.id for trial in stored}
            figures = list((out / "figures").glob(f"{experiment.name}*.svg"))
            assert len(figures) == len(experiment.figures), experiment.name
