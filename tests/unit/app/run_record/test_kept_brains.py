"""The brain of a run is kept in its state, whole or not at all: what a program leaves is offered, and can be gone on with."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import numpy as np
import pytest

from app.cli.command_line import main
from app.run_record import states
from app.run_record.folder import LINES, STATE, all_runs
from app.run_record.reader import open_run
from app.run_record.resume import resumed
from app.run_record.states import About, Copy, KeptBrain, States, newest_brain, newest_state
from app.session import Session
from app.session_snapshot import load_its_brain, save_session, state_of
from disk import archive, state_codec
from ratslam_core.brain_file import save_brain
from sim2d import load_world
from tests.unit.app.engines import run_for, tell
from tests.unit.app.sessions import OFFICE
from tests.unit.disk.full import full_after

from .kept import Keeping, keep_ticks

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path / "runs"))
    monkeypatch.setattr(states, "SAVE_EVERY_S", 1.0)
    return tmp_path / "runs"


@pytest.fixture(scope="module")
def session() -> Session:
    session = Session(OFFICE, 5)
    for _ in range(20):
        session.tick()
    return session


def the_newest() -> KeptBrain:
    kept = newest_brain()
    assert kept is not None
    return kept


def save(session: Session, folder: Path, time_s: float, complaints: list[str] | None = None) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / LINES).touch()
    keeper = States(folder, lambda *_: None, [].append if complaints is None else complaints.append)
    keeper.take(Copy(session.tick_count, time_s, session.source.world_texts, session, "office", last=True))
    assert keeper.finish(60.0)


def test_what_is_left_comes_back_with_what_it_is_of_and_can_be_asked_for(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / ".ratslam" / "brains").mkdir(parents=True)
    assert newest_brain() is None
    assert main(["run", "--resume-brain", "--port", "0"]) == 2
    said = capsys.readouterr().err
    assert (
        f"--resume-brain: no brain is kept in {runs}; those of an earlier version are in {tmp_path}/.ratslam/" in said
    )
    session = Session(load_world("loop"), 7)
    run = keep_ticks(session, 25)
    kept, known = the_newest(), len(session.brain.experience_map)
    assert (kept.about.world, kept.about.seed, kept.about.time_s, kept.about.experiences) == ("loop", 7, 2.5, known)
    assert kept.words.startswith(f"a brain of loop, seed 7, 0 min, {known} experiences, kept ")
    assert load_its_brain(kept.path).digest() == session.brain.digest()
    assert main(["run", "--resume-brain", "--brain", "x.npz"]) == 2
    assert "do not give --brain x.npz with it" in capsys.readouterr().err
    there = newest_state(run)
    assert there is not None, "nothing need be run again"
    assert (there.tick_count, there.state_hash()) == (25, session.state_hash())


def test_an_order_that_no_tick_has_followed_leaves_the_state_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(states, "SAVE_PAUSE_S", 0.0)
    kept = Keeping()
    run_for(kept.engine, 110)
    tell(kept.engine, type="kidnap")
    kept.engine.leave()
    end = kept.stop()
    assert the_newest().about.time_s == 10.0
    assert resumed(open_run("last")).state_hash() == end


def test_another_branch_and_back_leaves_no_state_that_is_none_of_its_log() -> None:
    kept = Keeping()
    run_for(kept.engine, 40)
    tell(kept.engine, type="seek", tick=20)
    tell(kept.engine, type="go_on_from_here")
    run_for(kept.engine, 15)
    tell(kept.engine, type="change_branch", number=1)
    kept.engine.leave()
    kept.stop()
    for folder in all_runs():
        resumed(open_run(folder))


def test_of_a_fault_nothing_is_left(runs: Path) -> None:
    kept = Keeping()
    run_for(kept.engine, 20)
    kept.engine.run.session.brain.experience_map.poses[0, 0] = np.nan
    run_for(kept.engine, 1)
    assert kept.engine.fault is not None
    kept.engine.leave()
    kept.keeper.stop()
    assert (newest_brain(), list(runs.glob(f"*/{STATE}"))) == (None, [])


def test_what_is_kept_takes_the_place_of_the_one_before_in_one_step_or_not_at_all(
    session: Session, runs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(session, runs / "a", 2.0)
    with full_after(10_000):
        save(session, runs / "a", 3.0)
    assert the_newest().about.time_s == 2.0
    there: list[float] = []

    def syncing(handle: int) -> None:
        if os.fstat(handle).st_size > 10_000:
            there.append(the_newest().about.time_s)

    monkeypatch.setattr(os, "fsync", syncing)
    save(session, runs / "a", 3.0)
    assert (there, the_newest().about.time_s) == ([2.0], 3.0)
    assert {found.name for found in (runs / "a").iterdir()} == {LINES, STATE}


def test_what_cannot_be_read_or_is_no_office_is_not_offered(session: Session, runs: Path) -> None:
    for number in range(3):
        save(session, runs / str(number), 2.0 + number)
    (runs / "2" / STATE).write_bytes(b"PK")
    save_session(session, runs / "1" / STATE)  # an earlier program said nothing of it
    assert the_newest().path == runs / "0" / STATE


def test_without_a_home_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RATSLAM_RUNS")
    monkeypatch.setenv("HOME", "/")
    assert newest_brain() is None


def test_a_brain_that_grows_too_large_is_told_of_in_time(
    session: Session, runs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    complaints: list[str] = []
    keeper = States(runs / "a", lambda *_: None, complaints.append)
    (runs / "a").mkdir(parents=True)
    (runs / "a" / LINES).touch()
    texts = session.source.world_texts
    size = archive.room_of(state_of(texts, session).arrays)
    for time_s, most in enumerate((2 * size - 2, 2 * size - 2, size - 1, size - 1, 4 * size), start=2):
        for module in (archive, state_codec):
            monkeypatch.setattr(module, "MOST_BYTES", most)
        keeper.take(Copy(20, time_s, texts, session, "office", last=True))
        assert keeper.finish(60.0)
    growing, too_large = complaints
    assert growing.startswith(f"the brain fills more than half of the {(2 * size - 2) >> 20} MiB that a file may hold:")
    assert re.match(r"the brain cannot be kept: too large for a file: \d+ MiB of arrays, at most \d+ can be", too_large)
    assert the_newest().about.time_s == 6


def test_a_disk_that_is_too_slow_is_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    complaints: list[str] = []
    monkeypatch.setattr("app.run_record.writer.STATES_PATIENCE_S", 0.0)
    keep_ticks(Session(OFFICE, 5), 20, complaints.append)
    assert complaints == ["the brain cannot be written in time; the one kept last stays"]


def test_a_brain_is_read_from_a_file_of_its_own_and_from_one_of_a_session_of_another_version(
    session: Session, tmp_path: Path
) -> None:
    save_brain(session.brain, tmp_path / "brain.npz")
    save_session(session, tmp_path / "state.npz")
    tree, arrays = archive.unpack((tmp_path / "state.npz").open("rb"))
    del tree["digest"]
    text = json.dumps(tree).replace('"kind": "session/', '"kind": "a session that nobody knows/')
    with (tmp_path / "other.npz").open("wb") as file:
        state_codec.write_state(state_codec.State(json.loads(text), arrays), file)
    for name in ("brain", "state", "other"):
        assert load_its_brain(tmp_path / f"{name}.npz").digest() == session.brain.digest()


def test_what_it_says_is_read_as_it_was_written(session: Session, runs: Path) -> None:
    save(session, runs / "a", 2.0)
    about = the_newest().about
    assert about == About("office", 5, 2.0, len(session.brain.experience_map), about.kept_at)
