"""A run that kept itself comes out the same, wherever its file was cut off; a full disk ends no run."""

from __future__ import annotations

import errno
import json
import os
import shutil
import time
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli.command_line import main
from app.run_record.folder import LINES, STATE, all_runs, delete, is_open, tidy
from app.run_record.header import beginning_of
from app.run_record.reader import KeptRun, open_run
from app.run_record.resume import ReplayError, replayed, resumed
from app.run_record.run_log import Lines, LogFile, line_of
from app.run_record.states import newest_state
from app.run_record.writer import RunKeeper
from app.session import Session
from sim2d import Box, load_world
from tests.unit.disk.full import full_after

from .kept import TICKS, keep_one

pytestmark = pytest.mark.slow

LIVING = load_world("living")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A folder of runs with a short one, and how that ended."""
    folder = tmp_path_factory.mktemp("runs")
    with pytest.MonkeyPatch.context() as patch:
        return folder, keep_one(folder, patch)[1]


@pytest.fixture(autouse=True)
def runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path / "runs"))
    return tmp_path / "runs"


@pytest.fixture
def run(whole: tuple[Path, str], runs: Path) -> KeptRun:
    """That run, in a copy that a test may change."""
    shutil.copytree(whole[0], runs)
    return open_run("last")


def test_it_comes_out_the_same(run: KeptRun, whole: tuple[Path, str]) -> None:
    assert (run.tick, run.end, run.damage) == (TICKS, "the program ended", "")
    assert [(order.tick, order.name) for order in run.orders] == [(50, "kidnap"), (75, "drive"), (TICKS, "set_mode")]
    assert 100 in run.hashes
    assert replayed(run).state_hash() == whole[1]
    assert (run.folder / STATE).exists() is False, "nothing is saved before a simulated minute"
    assert [session.tick_count for session in run.replay(until=7)] == list(range(8))


def test_it_goes_on_from_its_newest_state(runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.run_record.states.SAVE_EVERY_S", 1.0)
    monkeypatch.setattr("app.run_record.states.SAVE_PAUSE_S", 0.0)
    run, end = keep_one(runs, monkeypatch)
    state = newest_state(run)
    assert state is not None
    assert state.tick_count == 100
    assert resumed(run).state_hash() == end
    (run.folder / STATE).write_bytes(b"PK")
    assert newest_state(run) is None
    assert resumed(run).state_hash() == end


def test_cut_off_anywhere_it_opens_up_to_its_last_whole_line(run: KeptRun) -> None:
    data = (run.folder / LINES).read_bytes()
    header = data.index(b"\n") + 1
    for at in [0, 1, header - 1, *range(header, len(data) + 1, 3)]:
        (run.folder / LINES).write_bytes(data[:at])
        if at < header:
            with pytest.raises(ValueError, match="it does not begin with a whole line"):
                open_run(run.folder)
            continue
        cut = open_run(run.folder)
        assert cut.size == data.rfind(b"\n", 0, at) + 1
        assert bool(cut.damage) == (cut.size < at)
        assert cut.orders == run.orders[: len(cut.orders)]
        assert cut.checksums == run.checksums[: len(cut.checksums)]
        assert all(order.tick <= cut.tick for order in cut.orders)


def test_it_goes_on_in_the_same_file(run: KeptRun) -> None:
    path = run.folder / LINES
    path.write_bytes(path.read_bytes()[:-30])
    cut = open_run(run.folder)
    assert (cut.end, bool(cut.damage)) == ("", True)
    file = LogFile(cut.folder, cut.size, cut.check)
    assert is_open(cut.folder)
    with pytest.raises(ValueError, match="is going on in another program"):
        LogFile(cut.folder, cut.size, cut.check)
    with pytest.raises(ValueError, match="is going on in another program; end its program first"):
        delete(cut.folder)
    file.add({"tick": cut.tick, "again": "other"})
    file.close()
    assert not is_open(cut.folder)
    again = open_run(cut.folder)
    assert (again.again, again.damage, again.end) == ([(cut.tick, "other")], "", "")


def test_what_another_version_drove_differs_and_says_so_or_is_no_order(
    run: KeptRun, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """By the same laws as in a link."""
    lines = list(Lines(run.folder / LINES))

    def drives_at(speed: float) -> KeptRun:
        """Another version writes this speed into its order, and signs it."""
        lines[0]["run"]["version"] = "000000000000"
        next(line for line in lines if line.get("order") == "drive")["values"]["speed"] = speed
        data, check = b"", 0
        for value in lines:
            line, check = line_of(value, check)
            data += line
        (run.folder / LINES).write_bytes(data)
        return open_run(run.folder)

    with pytest.raises(
        ValueError, match=r"the order drive of tick 75 cannot be carried out: drive: speed: input should be less"
    ):
        replayed(drives_at(50.0))
    words = r"comes out differently from tick 7[6-9] on .* another version \(000000000000\)"
    with pytest.raises(ReplayError, match=words) as error:
        replayed(drives_at(0.9))
    monkeypatch.setattr("app.cli.runs.compile_first", lambda: None)
    assert main(["replay", run.name]) == 1
    assert f"from tick {error.value.tick} on" in capsys.readouterr().out


def test_a_line_that_no_run_writes_is_refused(run: KeptRun, subtests: pytest.Subtests) -> None:
    data = (run.folder / LINES).read_bytes()
    for line, words in [
        ({"tick": 3, "pulses": "AAAA"}, "bytes for the ticks from"),
        ({"tick": 10**18, "pulses": "AAAAAA=="}, "bytes for the ticks from"),
        ({"tick": -1, "order": "kidnap", "values": {}}, "it is of tick -1"),
        ({"tick": TICKS, "order": "kidnap", "values": 3}, "line"),
        ({"tick": TICKS, "order": "edit_world", "values": {}, "edit": {"from": -1}}, "cannot be made again"),
        ({"tick": "x", "end": ""}, "a tick must be a whole number"),
        ({"end": ""}, "tick"),
    ]:
        with subtests.test(line=line):
            (run.folder / LINES).write_bytes(data + line_of(line, run.check)[0])
            with pytest.raises(ValueError, match=words):
                open_run(run.folder)


@pytest.mark.parametrize("room", [0, 10, 1000, None])
def test_a_full_disk_is_told_of_once_and_the_file_opens(
    room: int | None, run: KeptRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """None: room for the header and half of the rest."""
    data, complaints = (run.folder / LINES).read_bytes(), list[str]()
    half = (data.index(b"\n") + len(data)) // 2
    with full_after(half if room is None else room):
        if room is None:
            kept, _ = keep_one(tmp_path / "full", monkeypatch, complaints=complaints)
            assert kept.tick < TICKS
        else:
            with pytest.raises(ValueError, match="does not begin with a whole line"):
                keep_one(tmp_path / "full", monkeypatch, complaints=complaints)
    (complaint,) = complaints
    assert "File too large" in complaint


def test_what_a_full_disk_did_not_take_is_written_when_there_is_room(tmp_path: Path) -> None:
    file = LogFile(tmp_path / "run")
    with full_after(12):
        for number in range(3):
            with pytest.raises(OSError, match="File too large"):
                file.add({"n": number})
    assert list(Lines(tmp_path / "run" / LINES)) == []
    file.add({"n": 3})
    assert [value["n"] for value in Lines(tmp_path / "run" / LINES)] == [0, 1, 2, 3]


def test_a_folder_that_cannot_be_made_is_told_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    complaints: list[str] = []
    with pytest.raises(ValueError, match="no run is kept"):
        keep_one(tmp_path / "file", monkeypatch, ticks=3, complaints=complaints)
    assert len(complaints) == 1


def test_the_oldest_runs_go_first_and_one_that_goes_on_stays(runs: Path) -> None:
    for number in range(6):
        folder = runs / str(number)
        folder.mkdir(parents=True)
        for name in (LINES, STATE):
            (folder / name).write_bytes(b"x" * 1000)
        os.utime(folder / LINES, (1000 + number, 1000 + number))
    file = LogFile(runs / "0", 1000)
    os.utime(runs / "0" / LINES, (1000, 1000))
    assert [folder.name for folder in all_runs()] == ["5", "4", "3", "2", "1", "0"]
    tidy(0.0071)
    assert [folder.name for folder in all_runs()] == ["5", "4", "3", "2", "0"]
    assert not (runs / "2" / STATE).exists()
    tidy(most=2)
    assert [folder.name for folder in all_runs()] == ["5", "4", "0"]
    file.close()


def test_the_newest_state_stays_for_its_brain(runs: Path) -> None:
    for number in range(4):
        (runs / str(number)).mkdir(parents=True)
        for name in (LINES, STATE) if number < 2 else (LINES,):
            (runs / str(number) / name).write_bytes(b"x" * 1000)
        os.utime(runs / str(number) / LINES, (1000 + number, 1000 + number))
    tidy(0.001)
    assert [folder.name for folder in all_runs()] == ["3", "1"]
    assert (runs / "1" / STATE).exists()


def test_boxes_and_edits_are_run_again(runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start = LIVING.starts[0]
    box = Box("crate", start.x + 2, start.y, 0.3, 0.3, 0.4, 0.3)
    run, end = keep_one(runs, monkeypatch, seed=4, ticks=40, orders={
        10: lambda s: s.put_box(box),
        20: lambda s: s.edit_world(replace(s.simulator.world, walls=s.world.walls[:-1])),
    })  # fmt: skip
    assert run.size < 40_000
    assert [order.name for order in run.orders] == ["put_box", "edit_world", "set_mode"]
    assert replayed(run).state_hash() == end


def test_the_list_and_deleting(run: KeptRun, runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (runs / "broken").mkdir()
    (runs / "broken" / LINES).write_bytes(b"nothing")
    assert main(["runs"]) == 0
    text = capsys.readouterr().out
    for words in (f"{run.name:28}", "complete", "it does not begin with a whole line"):
        assert words in text
    assert main(["runs", "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert {row["id"] for row in rows} == {run.name, "broken"}
    assert [main(["runs", "delete", run.name]) for _ in range(2)] == [0, 2]
    assert [folder.name for folder in all_runs()] == ["broken"]


def test_without_locks_it_is_kept_and_told_of_by_its_age(runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on an NFS without its lock daemon: no error of a lock is taken for another program."""
    said: list[str] = []

    def no_locks(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("disk.locks.fcntl.flock", no_locks)
    run, end = keep_one(runs, monkeypatch, ticks=20, complaints=said)
    (words,) = said
    assert words.startswith(f"{runs} has no file locks: the run is kept there")
    assert replayed(run).state_hash() == end
    assert is_open(run.folder)
    with pytest.raises(ValueError, match=r"was written less than 60 s ago, and .* has no file locks to tell"):
        delete(run.folder)
    assert main(["runs"]) == 0
    left = time.time() - 61
    os.utime(run.folder / LINES, (left, left))
    assert not is_open(run.folder)
    delete(run.folder)
    assert all_runs() == []


def test_without_a_home_the_run_goes_on_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    said, session = list[str](), Session(LIVING, 3)
    monkeypatch.setenv("HOME", "/")
    monkeypatch.delenv("RATSLAM_RUNS")
    keeper = RunKeeper(said.append)
    keeper.start()
    keeper.begin(keeper.feed(session, beginning_of(session)))
    keeper.stop()
    assert said == [
        "the run is not kept: there is no home directory (it would be /): set HOME to a folder of yours; it goes on"
    ]
