"""The file of trials: nothing is lost or counted twice, and a trial can be made again from it."""

from __future__ import annotations

import dataclasses
import math
import sqlite3
from pathlib import Path
from typing import Any

import pytest

from app.experiments.store import Outcome, Store, default_path
from app.gallery import StoredGallery
from app.protocol.experiment import catalogue, names
from app.protocol.trial import Trial
from tests.unit.app.trial_makers import make_outcome, make_trial, score_of


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "deep" / "trials.sqlite"


def test_what_was_added_is_read_again_by_another(path: Path) -> None:
    trials = [make_trial(seed) for seed in range(3)]
    with Store(path) as store:
        assert store.add((trial, make_outcome(trial)) for trial in trials[:2]) == 2
    with Store(path) as store:
        assert store.done(trial.id for trial in trials) == {trials[0].id, trials[1].id}
        first, second = store.stored(trials)
    assert (first.id, first.engine, first.levels, first.seed) == (trials[0].id, "ours", ("large",), 0)
    assert first.scores == {"mark": score_of(trials[0])}
    assert second.scores == {"mark": score_of(trials[1])}
    assert (first.moment_s, first.moment_words, first.wall_s, first.error) == (0.5, "the end", 0.25, "")


def scored(trial: Trial, scores: dict[str, float], **changes: Any) -> Outcome:
    result = make_outcome(trial).result
    assert result is not None
    return Outcome(trial.id, dataclasses.replace(result, scores=scores, **changes))


def test_no_trial_counts_twice_and_scores_that_are_no_numbers_are_left_out(path: Path) -> None:
    trial, second = make_trial(1), make_trial(2)
    other = scored(trial, {"mark": -1.0})
    with Store(path) as store:
        assert store.add([(trial, make_outcome(trial)), (trial, other)]) == 1
        assert store.add([(trial, other)]) == 0
        assert [each.scores for each in store.of_experiment("small")] == [{"mark": score_of(trial)}]
        store.add([(second, scored(second, {"mark": 1.0, "nan": math.nan, "inf": math.inf}))])
        assert store.stored([second])[0].scores == {"mark": 1.0}


def test_a_failed_trial_is_not_done_and_a_later_success_replaces_it(path: Path) -> None:
    trial = make_trial(1)
    with Store(path) as store:
        store.add([(trial, Outcome(trial.id, error="ValueError: no such door"))])
        assert store.done([trial.id]) == set()
        (failed,) = store.stored([trial])
        assert (failed.error, failed.scores) == ("ValueError: no such door", {})
        assert store.add([(trial, make_outcome(trial))]) == 1
        assert store.done([trial.id]) == {trial.id}
        assert store.add([(trial, Outcome(trial.id, error="too late"))]) == 0
        assert store.stored([trial])[0].error == ""


def test_a_batch_is_kept_wholly_or_not_at_all(path: Path) -> None:
    first, second = make_trial(1), make_trial(2)
    with Store(path) as store:
        with pytest.raises(sqlite3.IntegrityError):
            store.add([(first, make_outcome(first)), (second, scored(second, {}, simulated_s=None))])
        assert store.done([first.id, second.id]) == set()
        assert store.add([(first, make_outcome(first))]) == 1


def test_a_trial_is_made_again_by_the_beginning_of_its_id(path: Path) -> None:
    trials = [make_trial(seed) for seed in range(17)]  # sixteen digits: two of them begin alike
    trials += [make_trial(seed, "small", "ours") for seed in (1, 2)]
    known, firsts = trials[0].id, [trial.id[0] for trial in trials]
    twice = next(first for first in firsts if firsts.count(first) > 1)
    with Store(path) as store:
        with pytest.raises(ValueError, match="is empty; run an experiment first"):
            store.trial("ab")
        store.add((trial, make_outcome(trial)) for trial in trials)
        for trial in trials:
            again = store.trial(trial.id[:10])
            assert (again, again.id, store.moment(trial.id)) == (trial, trial.id, (0.5, "the end"))
        with pytest.raises(
            ValueError, match=f"there is no trial '{known[:4]}zz' in .*; expected an id, such as {known}"
        ):
            store.trial(known[:4] + "zz")
        with pytest.raises(ValueError, match="there is no trial"):
            store.moment("zz")
        with pytest.raises(ValueError, match=f"several trials begin with '{twice}'"):
            store.trial(twice)


def test_a_trial_that_two_cells_share_counts_in_both(path: Path) -> None:
    trial = make_trial(1)
    twin = dataclasses.replace(trial, experiment="other", levels=("as before",), engine="paper")
    assert twin.id == trial.id
    with Store(path) as store:
        store.add([(trial, make_outcome(trial))])
        assert [(each.engine, each.levels) for each in store.stored([trial, twin])] == [
            ("ours", ("large",)), ("paper", ("as before",)),
        ]  # fmt: skip


def test_wall_seconds_are_averaged_by_engine(path: Path) -> None:
    with Store(path) as store:
        assert store.seconds("small", False) == {}
        store.add((trial, make_outcome(trial)) for trial in (make_trial(1), make_trial(2)))
        assert store.seconds("small", False) == {"ours": 0.25}
        assert store.seconds("small", True) == {}


def test_a_file_that_is_something_else_is_refused_and_left_alone(tmp_path: Path) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("a shopping list, long enough to be none of these tables\n" * 20)
    with pytest.raises(ValueError, match=r"notes\.txt: .*; name a file that"):
        Store(text)
    assert text.read_text().startswith("a shopping list")
    for name, made_by, words in (
        ("other.sqlite", "CREATE TABLE plants (name)", "another program's database"),
        ("newer.sqlite", "PRAGMA user_version = 99", "its tables have version 99, this program knows 1"),
    ):
        with sqlite3.connect(tmp_path / name) as db:
            db.execute(made_by)
        db.close()
        with pytest.raises(ValueError, match=words):
            Store(tmp_path / name)
    with pytest.raises(ValueError, match="--store"):
        Store(tmp_path)


def test_where_trials_are_kept_by_default(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("RATSLAM_EXPERIMENTS", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert default_path() == tmp_path / ".ratslam" / "experiments.sqlite"
    monkeypatch.setenv("RATSLAM_EXPERIMENTS", str(tmp_path / "x.sqlite"))
    assert default_path() == tmp_path / "x.sqlite"


def test_a_store_that_is_spoilt_or_locked_says_so_at_once_with_the_way_out(path: Path) -> None:
    """It was a traceback in the command, 500 on the page, and a minute of waiting."""
    experiment = next(catalogue())
    with Store(path) as store:
        store.add((trial, make_outcome(trial)) for trial in map(make_trial, range(200)))
    with sqlite3.connect(path) as db:
        db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    db.close()
    whole = path.read_bytes()
    asked = [
        lambda store: store.counts(),
        lambda store: store.of_experiment("small"),
        lambda store: store.seconds("small", False),
        lambda store: store.trial("ff"),
        lambda store: store.done(["ff"]),
    ]
    for spoilt in (b"x" * 5000, whole[:100] + b"\xff" * (len(whole) - 100), whole[:5000]):
        path.write_bytes(spoilt)
        for question in asked:
            with (
                pytest.raises(ValueError, match=r"--store .*trials.sqlite: .* or move this one away"),
                Store(path, reading=True) as store,
            ):
                question(store)
        detail = StoredGallery(path).detail(experiment.name)
        assert detail is not None
        assert "cannot be shown: --store" in detail.results.note
        assert len(StoredGallery(path).cards()) == len(names())
    path.write_bytes(whole)
    locking = sqlite3.connect(path, isolation_level=None)
    locking.execute("PRAGMA journal_mode = DELETE")
    locking.execute("BEGIN EXCLUSIVE")
    with pytest.raises(ValueError, match="another program has locked it"), Store(path, reading=True) as store:
        store.counts()
    locking.close()


def test_whoever_reads_waits_for_nobody_who_writes(path: Path) -> None:
    with Store(path) as store:
        store.add([(make_trial(1), make_outcome(make_trial(1)))])
        writing = sqlite3.connect(path, isolation_level=None)
        writing.execute("BEGIN IMMEDIATE")
        with Store(path, reading=True) as reading:
            assert reading.counts() == {"small": 1}
            with pytest.raises(ValueError, match="readonly"):
                reading.add([(make_trial(2), make_outcome(make_trial(2)))])
        writing.close()
