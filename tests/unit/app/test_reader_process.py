"""Recordings that another process reads are the same, and what they cost ends with it."""

import gc
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import threading
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import psutil
import pytest

from app.recordings.opening import open_recording
from app.recordings.reader_process import Most, ReaderProcess
from app.recordings.recording import Moment
from tests.patience import PATIENCE_S
from tests.recordings import FORMATS

pytestmark = pytest.mark.slow


def made(folder: Path, name: str) -> Path:
    file, write, _ = FORMATS[name]
    return write(folder / file)


def told_by(moment: Moment, picture: bool) -> list[object]:
    """All that a moment holds, so that it can be compared. picture: or all but its picture."""
    whole = moment if picture else replace(moment, image=None)
    return [value.tolist() if isinstance(value, np.ndarray) else value for value in astuple(whole)]


@pytest.mark.parametrize("name", ["mp4", "carmen", "mcap"])
def test_moments_are_the_same_as_here_whoever_else_reads(tmp_path: Path, name: str) -> None:
    path = made(tmp_path, name)
    here, apart = open_recording(path), ReaderProcess(path)
    assert apart.about == here.about
    some = zip(here.moments(lambda n: n >= 3), apart.moments(lambda n: n >= 3), strict=True)
    for k, (one, other) in enumerate(zip(here.moments(), apart.moments(), strict=True)):
        assert told_by(one, True) == told_by(other, True)
        one, other = next(some)
        assert told_by(one, k >= 3) == told_by(other, k >= 3)
    assert next(some, None) is None
    assert apart.about == here.about


def endless(path: Path) -> Path:
    """A bag whose table of messages is a view without an end."""
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE topics (id INTEGER, name TEXT, type TEXT)")
        again = "WITH RECURSIVE more(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM more) SELECT n AS id, 1, n, x'00' FROM more"
        base.execute(f"CREATE VIEW messages (id, topic_id, timestamp, data) AS {again}")
    base.close()
    return path


def test_reading_without_an_end_is_ended_and_can_be_called_off(tmp_path: Path) -> None:
    bag, off = endless(tmp_path / "bag.db3"), threading.Event()
    with pytest.raises(ValueError, match=r"bag\.db3: more than 1 s of computing"):
        ReaderProcess(bag, most=Most(cpu_s=1.0, cpu_s_a_byte=0.0))
    threading.Timer(0.2, off.set).start()
    with pytest.raises(ValueError, match="called off"):
        ReaderProcess(bag, called_off=off)


def test_too_much_memory_is_the_readers_fault_alone(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"MemoryError|memory"):
        ReaderProcess(made(tmp_path, "mcap"), most=Most(memory=1 << 20))


def test_more_moments_than_a_run_has_ticks_are_refused_where_they_begin(tmp_path: Path) -> None:
    playing = ReaderProcess(made(tmp_path, "carmen"), most=Most(moments=3)).moments(lambda _: False)
    told = list[Moment]()
    with pytest.raises(ValueError, match="has more than 3 moments; play a part of it"):
        told.extend(playing)
    assert len(told) <= 3


def test_a_reader_that_is_killed_is_said_and_the_next_reading_has_another(tmp_path: Path) -> None:
    others = psutil.Process().children()
    recording = ReaderProcess(made(tmp_path, "mcap"))
    (reader,) = [child for child in psutil.Process().children() if child not in others]
    moments = recording.moments(lambda _number: True)
    next(moments)
    reader.kill()
    with pytest.raises(ValueError, match=r"has ended \(code -9\)"):
        list(moments)
    assert len(list(recording.moments())) == recording.about.moments


def test_what_was_unpacked_goes_with_the_reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    made(tmp_path, "tub")
    packed = shutil.make_archive(str(tmp_path / "packed"), "gztar", tmp_path / FORMATS["tub"][0])
    recording = ReaderProcess(Path(packed))
    assert len(list(recording.moments())) == recording.about.moments
    assert [*(tmp_path / "temporary").glob("*/*")]
    del recording
    gc.collect()
    assert not [*(tmp_path / "temporary").iterdir()]


def test_the_reader_ends_with_whoever_asked(tmp_path: Path) -> None:
    """Also with one that is killed, and while it reads without an end. Its temporary folder goes, too."""
    bag, temporary = endless(tmp_path / "bag.db3"), tmp_path / "temporary"
    temporary.mkdir()
    code = f"from pathlib import *; from app.recordings.reader_process import ReaderProcess; ReaderProcess(Path({str(bag)!r}))"
    environment = {**os.environ, "TMPDIR": str(temporary)}
    asker = subprocess.Popen([sys.executable, "-c", code], cwd=Path(__file__).parents[3], env=environment)
    try:
        while not (readers := psutil.Process(asker.pid).children()):
            assert asker.poll() is None
            os.sched_yield()
    finally:
        asker.kill()
        asker.wait()
    assert psutil.wait_procs(readers, timeout=PATIENCE_S)[1] == []
    assert not [*temporary.iterdir()]
