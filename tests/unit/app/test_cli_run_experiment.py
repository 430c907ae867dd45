"""`ratslam run --experiment`, and a stored trial that is opened at its moment."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from app.cli import command_line as cli
from app.cli.run import run_with_trial
from app.cli.serving import Serving
from app.engine.engine import Engine
from app.trials.experiment import find_experiment

from .engines import an_engine
from .sessions import OFFICE
from .test_cli_run import Doubles
from .trials_to_watch import table_trial


def begun(doubles: Doubles) -> tuple[Engine, dict[str, Any]]:
    """An engine in which the program's first run has begun, and the options of the program's own."""
    _, _, _, options = doubles.made["engine"]
    engine = an_engine(OFFICE)
    options["first"](engine)
    return engine, options


def test_a_trial_is_what_the_dashboard_begins_with(monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = Doubles(monkeypatch)
    command = ["run", "--no-browser", "--experiment", "table", "--engine", "paper", "--levels", "2 %", "8 x 8"]
    assert cli.main([*command, "--seed", "9", "--speed", "4"]) == 0
    name, seed, config, _ = doubles.made["engine"]
    assert (name, seed, config.pose_cells.n_x) == ("office", 9, 8)
    engine, options = begun(doubles)
    view = engine.snapshot().trial
    assert view is not None
    assert (view.title, view.engine, view.levels, view.seed) == (
        find_experiment("table").title,
        "paper",
        ("2 %", "8 x 8"),
        9,
    )
    assert (engine.running, options["speed"], view.ahead) == (True, 4.0, None)


def test_the_seed_of_the_experiment_is_taken_unless_another_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = Doubles(monkeypatch)
    assert cli.main(["run", "--no-browser", "--experiment", "table", "--paused"]) == 0
    assert doubles.made["engine"][1] == find_experiment("table").seed
    assert not begun(doubles)[0].running


def test_without_an_experiment_the_seed_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = Doubles(monkeypatch)
    assert cli.main(["run", "--no-browser"]) == 0
    assert doubles.made["engine"][1] == 1


def test_a_stored_trial_is_run_ahead_to_its_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = Doubles(monkeypatch)
    trial = table_trial()
    assert run_with_trial(trial, 20.0, title="A title", serving=Serving(port=0, browser=False)) == 0
    engine, _ = begun(doubles)
    assert engine.runs_ahead
    assert engine.run.trial is not None
    assert (engine.run.trial.trial, engine.run.trial.title) == (trial, "A title")
    assert not [event for event in engine.run.event_log.events if event.kind == "warning"]


def test_a_trial_of_another_version_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = Doubles(monkeypatch)
    assert run_with_trial(replace(table_trial(), version="earlier"), None, serving=Serving(browser=False)) == 0
    engine, _ = begun(doubles)
    assert "the program has changed" in engine.run.event_log.events[-1].text


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--experiment", "castle"], "unknown experiment 'castle'; expected a file that ends in .toml, or one of: "),
        (
            ["--experiment", "table", "--levels", "2 %", "9 x 9"],
            "pose cells has no level '9 x 9'; expected one of: 64 x 64",
        ),
        (["--experiment", "table", "--set", "robot.light=0.8"], "--set does not go with --experiment"),
        (["--experiment", "table", "--resume-brain"], "--resume-brain does not go with --experiment"),
        (["--experiment", "table", "--world", "loop"], "--world loop does not go with --experiment"),
        (["--engine", "paper"], "--engine is for a trial; give --experiment NAME with it"),
        (["--situation", "moment.json", "--seed", "0"], "--seed does not go with --situation, which has its own"),
        (["--resume", "last", "--seed", "0"], "--seed does not go with --resume: the run has its own"),
        (["--recording", "drive.mcap", "--world", "loop"], "--world loop does not go with --recording, which is no"),
    ],
)
def test_what_does_not_go_together_is_a_sentence(
    options: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["run", "--no-browser", *options]) == 2
    assert words in capsys.readouterr().err
