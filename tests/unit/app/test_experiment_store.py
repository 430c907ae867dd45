"""The file of trials: nothing is lost or counted twice, and a trial can be made again from it."""

from __future__ import annotations

import dataclasses
import sqlite3
from pathlib import Path

import pytest

from app.experiments.outcome import Outcome
from app.experiments.store import Store, default_path
from app.gallery.gallery import StoredGallery
from app.trials.experiment import catalogue, names
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


def test_no_trial_counts_twice(path: Path) -> None:
    trial = make_trial(1)
    other = make_outcome(trial)
    assert other.result is not None
    other = Outcome(trial.id, dataclasses.replace(other.result, scores={"mark": -1.0}))
    with Store(path) as store:
        assert store.add([(trial, make_outcome(trial)), (trial, other)]) == 1
        assert store.add([(trial, other)]) == 0
        assert [each.scores for each in store.of_experiment("small")] == [{"mark": score_of(trial)}]


def test_a_failed_trial_is_not_done_and_a_later_success_replaces_it(path: Path) -> None:
    trial = make_trial(1)
    with Store(path) as store:
        store.add([(trial, Outcome(trial.id, error="ValueError: no such door"))])
        assert store.done([trial.id]) == set()
        assert store.stored([trial])[0].error == "ValueError: no such door"
        assert store.stored([trial])[0].scores == {}
        assert store.add([(trial, make_outcome(trial))]) == 1
        assert store.done([trial.id]) == {trial.id}
        assert store.add([(trial, Outcome(trial.id, error="too late"))]) == 0
        assert store.stored([trial])[0].error == ""


def test_a_batch_is_kept_wholly_or_not_at_all(path: Path) -> None:
    first, second = make_trial(1), make_trial(2)
    bad = make_outcome(second)
    assert bad.result is not None
    bad = Outcome(second.id, dataclasses.replace(bad.result, simulated_s=None))  # type: ignore[arg-type]
    with Store(path) as store:
        with pytest.raises(sqlite3.IntegrityError):
            store.add([(first, make_outcome(first)), (second, bad)])
        assert store.done([first.id, second.id]) == set()
        assert store.add([(first, make_outcome(first))]) == 1


def test_scores_that_are_no_numbers_are_left_out(path: Path) -> None:
    trial = make_trial(1)
    outcome = make_outcome(trial)
    assert outcome.result is not None
    scores = {"mark": 1.0, "nan": float("nan"), "inf": float("inf")}
    with Store(path) as store:
        store.add([(trial, Outcome(trial.id, dataclasses.replace(outcome.result, scores=scores)))])
        assert store.stored([trial])[0].scores == {"mark": 1.0}


def test_a_trial_is_made_again_by_the_beginning_of_its_id(path: Path) -> None:
    trials = [
        make_trial(seed, level, engine) for seed in (1, 2) for level in ("large", "small") for engine in ("ours",)
    ]
    with Store(path) as store:
        store.add((trial, make_outcome(trial)) for trial in trials)
        for trial in trials:
            again = store.trial(trial.id[:10])
            assert again == trial
            assert again.id == trial.id
            assert store.moment(trial.id) == (0.5, "the end")


def test_an_unknown_id_is_refused_with_those_that_are_close(path: Path) -> None:
    trial = make_trial(1)
    with Store(path) as store:
        with pytest.raises(ValueError, match="is empty; run an experiment first"):
            store.trial("ab")
        store.add([(trial, make_outcome(trial))])
        with pytest.raises(
            ValueError, match=f"there is no trial '{trial.id[:4]}zz' in .*; expected an id, such as {trial.id}"
        ):
            store.trial(trial.id[:4] + "zz")
        with pytest.raises(ValueError, match="there is no trial"):
            store.moment("zz")


def test_a_beginning_that_several_share_is_refused(path: Path) -> None:
    trials = [make_trial(seed) for seed in range(17)]  # sixteen digits: two of them begin alike
    with Store(path) as store:
        store.add((trial, make_outcome(trial)) for trial in trials)
        firsts = [trial.id[0] for trial in trials]
        twice = next(first for first in firsts if firsts.count(first) > 1)
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
    other = tmp_path / "other.sqlite"
    with sqlite3.connect(other) as db:
        db.execute("CREATE TABLE plants (name)")
    db.close()
    with pytest.raises(ValueError, match="another program's database"):
        Store(other)
    newer = tmp_path / "newer.sqlite"
    with sqlite3.connect(newer) as db:
        db.execute("PRAGMA user_version = 99")
    db.close()
    with pytest.raises(ValueError, match="its tables have version 99, this program knows 1"):
        Store(newer)
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
        store._db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
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
        store._db.execute("BEGIN IMMEDIATE")
        with Store(path, reading=True) as reading:
            assert reading.counts() == {"small": 1}
            with pytest.raises(ValueError, match="readonly"):
                reading.add([(make_trial(2), make_outcome(make_trial(2)))])
        store._db.execute("ROLLBACK")
