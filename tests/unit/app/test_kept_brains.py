"""Brains are kept whole or not at all, each program its own. A full disk is reported once and stops nothing."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app import kept_brains
from app.cli import command_line as cli
from app.engine_thread import EngineThread
from app.kept_brains import MOST_KEPT, About, BrainKeeper, folder, keep, newest
from disk import archive, encode, state_codec
from ratslam_core import Odometry, RatSlam, load_brain
from tests.patience import PATIENCE_S
from tests.unit.disk.full import full_after

from .engine_threads import accept, snapshot, step

pytestmark = pytest.mark.slow

NOW = About("office", 5, 90.0, 12, 1e9)
Start = Callable[..., EngineThread]


@pytest.fixture(autouse=True)
def brains(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RATSLAM_BRAINS", str(tmp_path / "brains"))
    monkeypatch.setattr(kept_brains, "LEAST_S", 1.0)
    return folder()


@pytest.fixture(scope="module")
def brain() -> RatSlam:
    brain = RatSlam()
    brain.step(np.random.default_rng(0).integers(0, 256, (48, 64), np.uint8), Odometry(0.0, 0.0, 0.1))
    return brain


def kept_now() -> About:
    kept = newest()
    assert kept is not None
    return kept.about


def a_keeper(start: Start, ticks: int = 10) -> tuple[EngineThread, BrainKeeper]:
    """Of a session that is old enough to be kept."""
    engine = start()
    if ticks:
        accept(engine, step(ticks))
    return engine, BrainKeeper(engine.latest, engine.submit)


def warnings(engine: EngineThread) -> list[str]:
    return [event.text for event in accept(engine, step()).events if event.kind == "warning"]


def test_what_is_kept_comes_back_with_what_it_is_of_and_can_be_asked_for(
    brain: RatSlam, brains: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert newest() is None
    assert cli.main(["run", "--resume-brain", "--port", "0"]) == 2
    assert f"--resume-brain: no brain is kept in {brains}" in capsys.readouterr().err
    assert keep("a", brain, NOW) is None
    kept = newest()
    assert kept is not None
    assert (kept.path, kept.about) == (brains / "a.npz", NOW)
    assert load_brain(kept.path).digest() == brain.digest()
    assert "a brain of office, seed 5, 2 min, 12 experiences, kept 2001-09-09 " in kept.words
    assert cli.main(["run", "--resume-brain", "--brain", "x.npz"]) == 2
    assert "do not give --brain x.npz with it" in capsys.readouterr().err


def test_what_is_kept_takes_the_place_of_the_one_before_in_one_step_or_not_at_all(
    brain: RatSlam, brains: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    keep("a", brain, NOW)
    with full_after(10_000), pytest.raises(OSError, match="File too large"):
        keep("a", brain, replace(NOW, time_s=150.0))
    assert ([found.name for found in brains.iterdir()], kept_now()) == (["a.npz"], NOW)
    there: list[About] = []

    def syncing(handle: int) -> None:
        if os.fstat(handle).st_size > 10_000:
            there.append(kept_now())

    monkeypatch.setattr(os, "fsync", syncing)
    keep("a", brain, replace(NOW, time_s=150.0))
    assert (there, kept_now().time_s) == ([NOW], 150.0)
    assert [found.name for found in brains.iterdir()] == ["a.npz"]


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
    assert kept_now().kept_at == MOST_KEPT + 2


def test_the_keeper_keeps_what_is_new_sound_and_worth_it(
    start: Start, brains: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine, keeper = a_keeper(start, 0)
    keeper.keep_now()
    assert not brains.exists()
    accept(engine, step(10))
    before = engine.session.state_hash()
    keeper.keep_now()
    (path,) = brains.iterdir()
    written = path.stat().st_mtime_ns
    keeper.keep_now()  # there is nothing new
    assert ([*brains.iterdir()], path.stat().st_mtime_ns) == ([path], written)
    assert engine.session.state_hash() == before
    assert load_brain(path).digest() == engine.session.brain.digest()
    accept(engine, step())
    monkeypatch.setattr(os, "getpid", lambda: 0)  # another program
    BrainKeeper(engine.latest, engine.submit).keep_now()
    assert len(list(brains.iterdir())) == 2
    engine.session.brain.experience_map.poses[0, 0] = np.nan
    assert accept(engine, step()).fault is not None
    keeper.keep_now()
    assert path.stat().st_mtime_ns == written, "a fault does not replace what was sound"


def test_a_folder_that_cannot_be_written_is_told_of_once(
    start: Start, brains: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    brains.write_text("no folder")
    engine, keeper = a_keeper(start)
    for _ in range(2):
        keeper.keep_now()
        accept(engine, step())
    (warning,) = warnings(engine)
    assert f"the brain cannot be kept in {brains}: " in warning
    assert capsys.readouterr().err.count("cannot be kept") == 1
    assert snapshot(engine).fault is None


def test_a_brain_that_grows_too_large_is_told_of_in_time(
    start: Start, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    engine, keeper = a_keeper(start)
    size = archive.room_of(encode(engine.session.brain).arrays)
    for most in (2 * size - 2, 2 * size - 2, size - 1, size - 1, 4 * size):
        for module in (archive, state_codec):
            monkeypatch.setattr(module, "MOST_BYTES", most)
        accept(engine, step())
        keeper.keep_now()
    growing, too_large = warnings(engine)
    most = (2 * size - 2) >> 20
    assert growing.startswith(f"the brain fills more than half of the {most} MiB that a file may hold:")
    assert too_large.startswith("the brain cannot be kept:")
    assert re.search(rf"file: \d+ MiB of arrays, at most {(size - 1) >> 20} can be read again", too_large)
    assert capsys.readouterr().err.count("ratslam: ") == 2
    assert kept_now().time_s == 1.5


def test_leaving_keeps_it_once_more_and_waits_neither_for_ever_nor_with_the_engine(
    start: Start, brains: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Until the brain is read the engine goes on. It is written when the engine has ended, which makes it quicker."""
    engine, keeper = a_keeper(start)
    monkeypatch.setattr(kept_brains, "LEAVING_S", PATIENCE_S)
    keeper.start()
    keeper.stop()
    assert len(list(brains.iterdir())) == 1

    over, kept = threading.Event(), threading.Semaphore(0)

    def slowly(*_about: object) -> None:
        assert over.wait(PATIENCE_S)
        kept.release()

    monkeypatch.setattr(kept_brains, "keep", slowly)
    keepers = [BrainKeeper(engine.latest, engine.submit) for _ in range(2)]
    for keeper in keepers:
        keeper.start()
        keeper.leave()
    monkeypatch.setattr(kept_brains, "LEAVING_S", 0.05)
    keepers[0].stop()
    assert "cannot be written in time; the one kept last stays" in capsys.readouterr().err
    engine.stop()
    assert not kept.acquire(blocking=False)
    over.set()
    monkeypatch.setattr(kept_brains, "LEAVING_S", PATIENCE_S)
    for keeper in keepers:
        keeper.stop()
        assert kept.acquire(blocking=False)
