"""However a command ends, it ends with a sentence and an exit code: full disks, closed pipes, signals at any moment."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from app.cli import command_line as cli
from app.startup.ending import ended
from sim2d.world.world_file import WORLDS
from tests.unit.disk.full import full_after

OFFICE = str(WORLDS / "office.json")


def ratslam(*arguments: str, before: str = "", **options) -> subprocess.CompletedProcess[str]:
    """The program in a process of its own, in which `before` is run first."""
    start = f"{before}\nimport sys\nfrom app.__main__ import main\nsys.exit(main())"
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    return subprocess.run([sys.executable, "-c", start, *arguments], text=True, timeout=300, check=False, **options)


# A signal that comes while a library is loaded: where its import may be caught, or where its code is in C.
ON_IMPORT = """
import signal, sys
class Finder:
    def find_spec(self, name, path, target=None):
        if name == {module!r}:
            signal.raise_signal(signal.{signal})
sys.meta_path.insert(0, Finder())
"""


@pytest.mark.parametrize(
    ("command", "module", "number"),
    [
        ("headless", "argparse", "SIGTERM"),
        ("headless", "numpy.linalg._umath_linalg", "SIGINT"),
        ("headless", "numba.core.caching", "SIGTERM"),
        ("headless", "app.headless", "SIGINT"),
        ("run", "viser", "SIGTERM"),
        ("run", "uvicorn", "SIGINT"),
    ],
)
@pytest.mark.slow
def test_a_signal_while_starting_ends_it(command: str, module: str, number: str, tmp_path: Path) -> None:
    file = str(tmp_path / "report.json")
    arguments = ["headless", "--report", file] if command == "headless" else ["run", "--no-browser", "--port", "0"]
    done = ratslam(*arguments, before=ON_IMPORT.format(module=module, signal=number))
    assert (done.returncode, done.stderr) == (128 + signal.Signals[number], "ratslam: stopped\n")
    assert os.listdir(tmp_path) == []


# Like a library that takes the exception for its own, and like one that is in a destructor when it comes.
SWALLOWS = """
import signal, time, app.cli.command_line
class Deaf:
    def __del__(self):
        signal.raise_signal(signal.SIGTERM)
def deaf():
    Deaf()
    while True:
        time.sleep(0.01)
def cross():
    try:
        signal.raise_signal(signal.SIGTERM)
    except BaseException:
        raise ImportError("numpy failed to load") from None
app.cli.command_line.main = {what}
"""


@pytest.mark.parametrize("what", ["deaf", "cross"])
@pytest.mark.slow
def test_a_signal_that_a_library_holds_back_ends_it_all_the_same(what: str) -> None:
    done = ratslam(before=SWALLOWS.format(what=what))
    assert (done.returncode, done.stderr) == (143, "ratslam: stopped\n")


@pytest.mark.slow
def test_output_that_nobody_can_take() -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = ratslam("config", stdout=full)
        assert done.returncode == 2
        assert done.stderr == "ratslam: standard output: No space left on device; make room, or choose another place\n"
        assert ratslam("headless", "--world", "castle", stderr=full).returncode == 2
    reader, writer = os.pipe()
    os.close(reader)
    done = ratslam("config", stdout=writer)
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")


COMMANDS = {
    "report": "headless --minutes 0.02 --report",
    "brain": "headless --minutes 0.02 --save-brain",
    "bench": "bench --json",
    "imported": f"worlds import {OFFICE} -o",
}


@pytest.fixture
def quick_bench(monkeypatch: pytest.MonkeyPatch) -> None:
    row = {"work": "sweep " * 20, "ms": 0.1, "holds": True}
    monkeypatch.setattr("benchmarks.engine.rows", lambda _quick: iter([row]))
    monkeypatch.setattr("benchmarks.office.rows", lambda _quick: iter([]))
    monkeypatch.setattr("benchmarks.engine.line", lambda row: row["work"])


@pytest.mark.usefixtures("quick_bench")
@pytest.mark.parametrize("what", COMMANDS)
@pytest.mark.slow
def test_a_full_disk_leaves_no_half_file(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "file"
    file.write_text("old")
    with full_after(64):
        assert cli.main([*COMMANDS[what].split(), str(file)]) == 2
    captured = capsys.readouterr()
    assert captured.err == f"ratslam: {file}: File too large; make room, or choose another place\n"
    assert (os.listdir(tmp_path), file.read_text()) == (["file"], "old")
    if what in ("report", "brain"):
        assert '"state_hash"' in captured.out  # the run is over: its report is not lost


def test_where_nothing_can_be_written_is_said_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, subtests: pytest.Subtests
) -> None:
    monkeypatch.setattr("app.headless.run_headless", lambda *_, **__: pytest.fail("the work was begun"))
    monkeypatch.setattr("benchmarks.engine.rows", lambda _quick: pytest.fail("the work was begun"))
    for may_write in (True, False):
        if not may_write:
            monkeypatch.setattr(os, "access", lambda *_: False)  # root may write anywhere
        for what in ("report", "brain", "bench"):
            places = {
                tmp_path / "no" / "file": f"there is no folder {tmp_path / 'no'}",
                tmp_path: "this is a folder; name a file in it",
            } if may_write else {tmp_path / "file": "choose another place"}  # fmt: skip
            for place, words in places.items():
                with subtests.test(msg=f"{what} {words}"):
                    assert cli.main([*COMMANDS[what].split(), str(place)]) == 2
                    assert words in capsys.readouterr().err
    assert os.listdir(tmp_path) == []


def test_what_it_was_is_told_but_our_own_mistakes_are_not_hidden(
    capsys: pytest.CaptureFixture[str], subtests: pytest.Subtests
) -> None:
    def ends(error: BaseException) -> int:
        def work() -> int:
            raise error

        return ended(work)

    denied = PermissionError(13, "Permission denied", "/etc/x")
    for error, code, words in (
        (denied, 2, "ratslam: /etc/x: Permission denied; choose a place where you may write\n"),
        (ConnectionResetError(104, "Connection reset by peer"), 2, "ratslam: Connection reset by peer\n"),
        (ValueError("no"), 2, "ratslam: no\n"),
        (KeyboardInterrupt(), 130, "ratslam: stopped\n"),
        (BrokenPipeError(32, "Broken pipe"), 141, ""),
    ):
        with subtests.test(msg=repr(error)):
            assert (ends(error), capsys.readouterr().err) == (code, words)
    with pytest.raises(ZeroDivisionError):
        ends(ZeroDivisionError())
