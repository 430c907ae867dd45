"""`ratslam experiment`: what it lists, refuses, runs and leaves behind."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import pytest

from app.cli.command_line import main
from app.cli.options import ENGINES
from app.experiments.figures.canvas import ENGINE_COLOUR
from app.experiments.store import Store
from app.experiments.summary import ENGINE_WORDS
from app.protocol.experiment import catalogue, read_experiment
from tests.unit.app.trial_makers import make_outcome, make_trial
from web.messages.commands import EngineName

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(autouse=True)
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RATSLAM_EXPERIMENTS", str(tmp_path / "kept" / "trials.sqlite"))
    monkeypatch.chdir(tmp_path)
    return tmp_path / "kept" / "trials.sqlite"


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """The experiment of docs/experiments.md."""
    text = re.findall(r"```toml\n(.*?)```", (DOCS / "experiments.md").read_text(encoding="utf-8"), re.DOTALL)[0]
    (tmp_path / "my.toml").write_text(text, encoding="utf-8")
    return tmp_path / "my.toml"


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert main(["experiment", *words]) == 2
    return capsys.readouterr().err


def test_all_experiments_are_listed_with_their_durations(capsys: pytest.CaptureFixture[str], store: Path) -> None:
    assert main(["experiment", "--workers", "2"]) == 0
    said = capsys.readouterr().out
    for experiment in catalogue():
        assert f"{experiment.name}: {experiment.title} ({experiment.paper})" in said
    assert "480 trials, " in said
    assert re.search(r"All together: [\d.]+ (h|min) with 2 workers", said)
    assert not store.exists()  # listing makes no file


def test_no_experiment_has_a_name_that_the_command_uses() -> None:
    assert not {"all", "check", "open", "results"} & {experiment.name for experiment in catalogue()}


def test_what_is_wrong_is_said(capsys: pytest.CaptureFixture[str], subtests: pytest.Subtests) -> None:
    for words, said in (
        ("nonsense", "unknown experiment 'nonsense'; expected a file that ends in .toml, or one of: "),
        ("table trial", "one experiment at a time, got table, trial"),
        ("open", "experiment open takes the id of a trial, and one only"),
        ("check a b", "experiment check takes a file, and one only"),
        ("table --trials 0", "--trials must be from 1 to 100000, got 0"),
        ("table --workers 0", "--workers must be from 1 to 1024, got 0"),
        ("table --workers 2 --scheduler tcp://127.0.0.1:1", "the cluster of --scheduler has its own"),
        ("all --csv all.csv", "--csv takes the trials of one experiment; name it"),
        ("table --csv nowhere/x.csv", "--csv nowhere/x.csv: there is no folder"),
        ("check missing.toml", "missing.toml: No such file or directory"),
    ):
        with subtests.test(msg=words):
            assert said in refused(capsys, *words.split())


def test_a_file_of_ones_own_is_checked(capsys: pytest.CaptureFixture[str], own: Path) -> None:
    assert main(["experiment", "check", str(own)]) == 0
    assert "How wide must the camera see?: 2 cells, 20 trials; all is right" in capsys.readouterr().out
    text = own.read_text(encoding="utf-8")
    own.write_text(text.replace('["kitchen", "printer"]', '["kitchen", "cellar"]'), encoding="utf-8")
    assert "has no place 'cellar'" in refused(capsys, "check", str(own))
    own.write_text(text.replace('name = "narrow-view"', 'name = "all"'), encoding="utf-8")
    assert "'all' is a word of the command; choose another" in refused(capsys, "check", str(own))


def test_a_trial_opens_at_the_moment_that_decided_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, store: Path
) -> None:
    trial, shown = make_trial(1), list[tuple[object, float, int]]()
    monkeypatch.setattr(
        "app.cli.run.run_with_trial",
        lambda trial, moment_s, serving: shown.append((trial, moment_s, serving.port)) or 0,
    )
    with Store(store) as kept:
        kept.add([(trial, make_outcome(trial))])
    assert main(["experiment", "open", trial.id[:8], "--port", "0"]) == 0
    assert shown == [(trial, 0.5, 0)]
    assert "note: the trial was run by version v1" in capsys.readouterr().err
    assert f"expected an id, such as {trial.id}" in refused(capsys, "open", "0000")


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # distributed closes its sockets when it is collected
def test_a_file_of_ones_own_runs_once_and_leaves_table_figures_and_page(
    capsys: pytest.CaptureFixture[str], own: Path, store: Path
) -> None:
    command = ["experiment", str(own), "--quick", "--engine", "ours", "--workers", "2", "--csv", "own.csv"]
    assert main(command) == 0
    first = capsys.readouterr()
    assert "narrow-view: 1 trials to run" in first.err
    folder = own.parent / "experiments" / "narrow-view"
    assert (folder / "narrow-view.html").read_text(encoding="utf-8").startswith("<!doctype html>")
    assert {path.suffix for path in (folder / "figures").iterdir()} == {".svg", ".png"}
    assert (own.parent / "own.csv").is_file()
    (trial,) = read_experiment(own).make_trials(["ours"], quick=True)
    assert (folder / "narrow-view.csv").read_text(encoding="utf-8").splitlines()[1].startswith(trial.id)
    with Store(store) as kept:
        assert kept.stored([trial])[0].scores["goals"] == 2.0
    assert main(command) == 0
    assert "to run" not in capsys.readouterr().err


def test_whose_rules_can_be_asked_for_is_the_same_everywhere() -> None:
    assert set(ENGINES) == set(get_args(EngineName)) == set(ENGINE_WORDS) == set(ENGINE_COLOUR)
