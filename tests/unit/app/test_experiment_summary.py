"""What is told and written of many trials: the table of an experiment, on the terminal and to take elsewhere, durations,
and a trial opened."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections import Counter
from pathlib import Path

import pytest

from app.experiments.export import table_of, write_csv
from app.experiments.live import LiveTable
from app.experiments.pool import duration_of, time_words
from app.experiments.store import Outcome, Store, StoredTrial, open_trial
from app.experiments.summary import Estimate, summarise, wilson, words
from app.protocol.experiment import Score
from tests.unit.app.trial_makers import SMALL, make_outcome, make_trial


def stored(engine: str, level: str, seed: int, error: str = "", /, **scores: float) -> StoredTrial:
    return StoredTrial(f"{engine}-{level}-{seed}", engine, (level,), seed, scores, 1.0, "the end", error=error)


TRIALS = [
    stored("ours", "small", 1, reached=2, goals=3, error_m=0.3),
    stored("ours", "small", 2, reached=3, goals=3, error_m=0.1),
    stored("ours", "small", 3, "ValueError: no, never"),
    stored("ours", "small", 4, error_m=0.2),
    stored("paper", "large", 1, reached=0, goals=3, seed=7.0),
    stored("ours", "large", 1, reached=1, goals=3, error_m=0.5),
]


# ------------------------------------------------------------ the table


def test_rows_are_in_the_order_of_the_experiment() -> None:
    rows = summarise(SMALL, TRIALS)
    assert [(row.engine, row.levels, row.n, row.failed) for row in rows] == [
        ("paper", ("large",), 1, 0), ("ours", ("large",), 1, 0), ("ours", ("small",), 3, 1),
    ]  # fmt: skip


def test_a_rate_counts_all_trials_together_and_a_score_is_a_median() -> None:
    small = summarise(SMALL, TRIALS)[-1]
    assert small.values["goals"] == wilson(5, 6)
    error = small.values["error"]
    assert (error.value, error.n) == (0.2, 3)
    assert error.low <= 0.2 <= error.high
    assert summarise(SMALL, TRIALS[::-1])[-1] == small  # in whatever order they came
    missing = summarise(SMALL, TRIALS)[0].values["error"]
    assert (missing.n, math.isnan(missing.value), words(missing, SMALL.scores[1])) == (0, True, "-")


def test_figures_are_told_with_their_intervals_and_durations_in_words() -> None:
    for value, score, expected in (
        (wilson(25, 30), Score(label="a", rate=("r", "g")), "83 % (66-93)"),
        (Estimate(0.123, 0.1, 0.15, 9), Score(label="a", score="error_m", unit="m"), "0.123 m (0.1-0.15)"),
        (Estimate(1234.4, math.nan, math.nan, 1), Score(label="a", score="x"), "1234"),
    ):
        assert words(value, score) == expected
    durations = {0.2: "1 s", 40: "40 s", 89: "89 s", 720: "12 min", 5399: "90 min", 12600: "3.5 h"}
    assert {seconds: time_words(seconds) for seconds in durations} == durations


# ------------------------------------------------------------ to take elsewhere


def test_a_table_has_a_row_for_each_trial_and_a_column_for_each_axis_and_score(tmp_path: Path) -> None:
    write_csv(tmp_path / "small.csv", SMALL, TRIALS)
    with (tmp_path / "small.csv").open() as file:
        rows = list(csv.DictReader(file))
    failed, last = rows[2], rows[-1]
    assert (last["id"], last["size"], last["engine"], last["seed"]) == ("ours-large-1", "large", "ours", "1")
    assert (last["error_m"], last["reached"], last["moment"]) == ("0.5", "1", "the end")
    assert (failed["error_m"], failed["error"]) == ("", "ValueError: no, never")
    columns, rows = table_of(SMALL, TRIALS)
    assert len(set(columns)) == len(columns)
    assert dict(zip(columns, rows[4], strict=True))["seed (score)"] == 7.0


# ------------------------------------------------------------ while they run


def test_how_long_an_experiment_takes_is_measured_where_it_can_be() -> None:
    trials = SMALL.how_many(trials=2)
    assert trials == Counter(trial.engine for trial in SMALL.make_trials(trials=2)) == {"ours": 4, "paper": 4}
    known = duration_of(SMALL, Counter(ours=4), {"ours": 30.0})
    assert (known.seconds, known.measured, known.words(2)) == (120.0, True, "60 s, measured")
    half = duration_of(SMALL, trials, {"ours": 30.0})
    assert not half.measured
    assert half.seconds > 120.0


def test_without_a_terminal_there_is_a_line_now_and_then(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.experiments.live.LINE_EVERY_S", -1.0)
    trials = [make_trial(seed) for seed in range(4)]
    with LiveTable(SMALL, trials, [], 90.0) as live:
        live.add([(trials[0], make_outcome(trials[0]))])
        live.add([(trials[1], Outcome(trials[1].id, error="ValueError: no"))])
        live.add([(trial, make_outcome(trial)) for trial in trials[2:]])
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith("small: 1 of 4 trials; about ")
    assert lines[1].startswith(
        "small: 2 of 4 trials, 1 failed" if len(lines) == 2 else "small: 1 of 4 trials, 1 failed; about "
    )
    assert lines[-1] == "small: 3 of 4 trials, 1 failed; done"


def test_on_a_terminal_the_table_fills_in(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("app.experiments.live.REDRAW_S", -1.0)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "120")
    trials = [make_trial(1, "large"), make_trial(1, "small")]
    with LiveTable(SMALL, trials, [], 90.0) as live:
        for trial in trials:
            outcome = make_outcome(trial)
            assert outcome.result is not None
            scores = {"reached": 25.0, "goals": 30.0, "error_m": 0.125}
            live.add([(trial, Outcome(trial.id, dataclasses.replace(outcome.result, scores=scores)))])
    shown = capsys.readouterr().err
    assert "83 % (66-93)" in shown
    assert "0.125 m" in shown
    assert "2/2" in shown


def test_a_trial_is_opened_with_what_may_make_it_differ(tmp_path: Path) -> None:
    trial, old = SMALL.make_trials(trials=1)[0], make_trial(5)
    with Store(tmp_path / "trials.sqlite") as store:
        store.add((each, make_outcome(each)) for each in (trial, old))
        opened = open_trial(trial.id[:12], store)
        assert (opened.trial, opened.moment_s, opened.moment_words) == (trial, 0.5, "the end")
        assert opened.warnings == ()
        version, world = open_trial(old.id, store).warnings
        assert version.startswith("the trial was run by version v1 of the program, this is ")
        assert world == "the world loop has changed since the trial: the run may differ"
        with pytest.raises(ValueError, match="there is no trial 'nothing'"):
            open_trial("nothing", store)
