"""Brains are kept whole or not at all, each program its own. A full disk is reported once and stops nothing."""

from __future__ import annotations

import os
import re
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.cli import command_line as cli
from app.engine_thread import EngineThread
from app.kept_brains import files as kept_brains
from app.kept_brains import keeper as brain_keeper
from app.kept_brains.files import MOST_KEPT, About, folder, keep, newest
from app.kept_brains.keeper import BrainKeeper
from disk import archive, copy_state, encode, state_codec
from ratslam_core import Odometry, RatSlam, load_brain
from tests.patience import PATIENCE_S
from tests.unit.disk.full import full_after

from .engine_threads import accept, snapshot, step

pytestmark = pytest.mark.slow

NOW = About("office", 5, 90.0, 12, 1e9)


@pytest.fixture(autouse=True)
def brains(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RATSLAM_BRAINS", str(tmp_path / "brains"))
    return folder()


@pytest.fixture(scope="module")
def brain() -> RatSlam:
    brain = RatSlam()
    brain.step(np.random.default_rng(0).integers(0, 256, (48, 64), np.uint8), Odometry(0.0, 0.0, 0.1))
    return brain


def test_what_is_kept_comes_back_with_what_it_is_of(brain: RatSlam, brains: Path) -> None:
    assert newest() is None
    assert keep("a", brain, NOW) is None
    kept = newest()
    assert kept is not None
    assert (kept.path, kept.about) == (brains / "a.npz", NOW)
    assert load_brain(kept.path).digest() == brain.digest()
    assert "a brain of office, seed 5, 2 min, 12 experiences, kept 2001-09-09 " in kept.words
    assert [found.name for found in brains.iterdir()] == ["a.npz"]


def test_what_is_kept_takes_the_place_of_the_one_before_in_one_step(
    brain: RatSlam, brains: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    keep("a", brain, NOW)
    there: list[About] = []

    def syncing(handle: int) -> None:
        if os.fstat(handle).st_size > 10_000:
            there.append(newest().about)  # type: ignore[union-attr]

    monkeypatch.setattr(os, "fsync", syncing)
    keep("a", brain, replace(NOW, time_s=150.0))
    assert there == [NOW]
    assert [found.name for found in brains.iterdir()] == ["a.npz"]
    assert newest().about.time_s == 150.0  # type: ignore[union-attr]


def test_a_write_that_breaks_off_leaves_the_old_one(brain: RatSlam, brains: Path) -> None:
    keep("a", brain, NOW)
    with full_after(10_000), pytest.raises(OSError, match="File too large"):
        keep("a", brain, replace(NOW, time_s=150.0))
    assert [found.name for found in brains.iterdir()] == ["a.npz"]
    assert newest().about == NOW  # type: ignore[union-attr]


def test_without_a_home_nothing_is_kept_and_nobody_is_disturbed(
    brain: RatSlam, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RATSLAM_BRAINS")
    monkeypatch.setenv("HOME", "/")
    assert newest() is None
    with pytest.raises(ValueError, match="there is no home directory"):
        keep("a", brain, NOW)


def test_only_the_newest_stay_and_what_cannot_be_read_is_not_offered(brain: RatSlam, brains: Path) -> None:
    for k in range(MOST_KEPT + 3):
        keep(f"run-{k}", brain, replace(NOW, kept_at=float(k)))
    assert len(list(brains.glob("*.npz"))) == MOST_KEPT
    (brains / "spoilt.npz").write_bytes(b"PK")
    assert newest().about.kept_at == MOST_KEPT + 2  # type: ignore[union-attr]


def test_the_keeper_keeps_what_is_new_and_worth_it(start: Callable[..., EngineThread], brains: Path) -> None:
    engine = start()
    keeper = BrainKeeper(engine.latest, engine.submit)
    keeper.keep_now()
    assert not brains.exists()
    accept(engine, step(600))
    before = engine.session.state_hash()
    for _ in range(2):
        keeper.keep_now()  # the second time there is nothing new
    assert engine.session.state_hash() == before
    (path,) = brains.iterdir()
    assert load_brain(path).digest() == engine.session.brain.digest()
    accept(engine, step())
    other = BrainKeeper(engine.latest, engine.submit)
    other._name = "another-program"
    for each in (keeper, other):
        each.keep_now()
    assert len(list(brains.glob("*.npz"))) == 2


def test_a_session_that_stopped_at_a_fault_does_not_replace_what_was_sound(
    start: Callable[..., EngineThread], brains: Path
) -> None:
    engine = start()
    keeper = BrainKeeper(engine.latest, engine.submit)
    accept(engine, step(600))
    keeper.keep_now()
    (path,) = brains.iterdir()
    written = path.stat().st_mtime_ns
    engine.session.brain.experience_map.poses[0, 0] = np.nan
    assert accept(engine, step()).fault is not None
    keeper.keep_now()
    assert (list(brains.iterdir()), path.stat().st_mtime_ns) == ([path], written)


def test_a_folder_that_cannot_be_written_is_told_of_once(
    start: Callable[..., EngineThread], brains: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    brains.write_text("no folder")
    engine = start()
    keeper = BrainKeeper(engine.latest, engine.submit)
    for ticks in (600, 1):
        accept(engine, step(ticks))
        keeper.keep_now()
    now = accept(engine, step())
    [warning] = [event.text for event in now.events if event.kind == "warning"]
    assert f"the brain cannot be kept in {brains}: " in warning
    assert capsys.readouterr().err.count("cannot be kept") == 1
    assert now.fault is None


def test_a_brain_that_grows_too_large_is_told_of_in_time(
    start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    engine = start()
    keeper = BrainKeeper(engine.latest, engine.submit)
    accept(engine, step(600))
    size = archive.room_of(encode(engine.session.brain).arrays)
    for most in (2 * size - 2, 2 * size - 2, size - 1, size - 1, 4 * size):
        for module in (archive, state_codec):
            monkeypatch.setattr(module, "MOST_BYTES", most)
        accept(engine, step())
        keeper.keep_now()
    texts = [event.text for event in accept(engine, step()).events if event.kind == "warning"]
    assert [text.split(":")[0] for text in texts] == [
        f"the brain fills more than half of the {(2 * size - 2) >> 20} MiB that a file may hold",
        "the brain cannot be kept",
    ]
    too_large = rf"too large for a file: \d+ MiB of arrays, at most {(size - 1) >> 20} can be read again"
    assert re.search(too_large, texts[1])
    assert capsys.readouterr().err.count("ratslam: ") == 2
    assert newest().about.time_s == 60.5  # type: ignore[union-attr]


def test_leaving_keeps_it_once_more_and_does_not_wait_for_ever(
    start: Callable[..., EngineThread],
    brains: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    engine = start()
    accept(engine, step(600))
    monkeypatch.setattr(brain_keeper, "LEAVING_S", 60.0)
    keeper = BrainKeeper(engine.latest, engine.submit)
    keeper.start()
    keeper.stop()
    assert len(list(brains.iterdir())) == 1
    monkeypatch.setattr(brain_keeper, "LEAVING_S", 0.05)
    monkeypatch.setattr(brain_keeper, "keep", lambda *_: time.sleep(0.5))
    keeper = BrainKeeper(engine.latest, engine.submit)
    keeper.start()
    keeper.stop()
    assert "cannot be written in time; the one kept last stays" in capsys.readouterr().err
    keeper._thread.join()
    assert snapshot(engine).fault is None


def test_the_engine_need_not_go_on_until_the_brain_is_written(
    start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Leaving waits until the brain is read. It is written when the engine has ended, which makes it quicker."""
    alive, over = start(running=False), threading.Event()
    accept(alive, step(1))
    kept: list[str] = []

    def slowly(name: str, *_about: object) -> None:
        assert over.wait(PATIENCE_S)
        kept.append(name)

    monkeypatch.setattr(brain_keeper, "keep", slowly)
    monkeypatch.setattr(brain_keeper, "LEAST_S", 0.0)
    monkeypatch.setattr(brain_keeper, "LEAVING_S", PATIENCE_S)
    keeper = BrainKeeper(alive.latest, alive.submit)
    keeper.start()
    keeper.leave()
    alive.stop()
    assert kept == []
    over.set()
    keeper.stop()
    assert len(kept) == 1


def test_what_cannot_be_resumed_is_a_sentence(brain: RatSlam, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["run", "--resume-brain", "--port", "0"]) == 2
    assert f"--resume-brain: no brain is kept in {folder()}" in capsys.readouterr().err
    keep("a", copy_state(brain), NOW)
    assert cli.main(["run", "--resume-brain", "--brain", "x.npz"]) == 2
    assert "do not give --brain x.npz with it" in capsys.readouterr().err
    assert kept_brains.newest() is not None
