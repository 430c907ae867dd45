"""A run that kept itself comes out the same, wherever its file was cut off; a full disk ends no run."""

from __future__ import annotations

import errno
import json
import os
import time
from pathlib import Path

import pytest

from app.cli.command_line import main
from app.runs.folder import LINES, STATE, all_runs, delete, is_open, tidy
from app.runs.header import beginning_of
from app.runs.journal import Journal
from app.runs.keeper import RunKeeper
from app.runs.lines import Lines, line_of
from app.runs.replay import ReplayError, newest_state, replay, resumed
from app.runs.run_file import KeptRun, open_run
from app.session import Session
from sim2d import Box, load_world
from tests.unit.app.runs.kept import TICKS, keep_one

pytestmark = pytest.mark.slow

LIVING = load_world("living")


def test_it_comes_out_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, end = keep_one(tmp_path, monkeypatch)
    assert (run.last_tick, run.end, run.damage) == (TICKS, "the program ended", "")
    assert [(order.tick, order.name) for order in run.orders] == [(50, "kidnap"), (75, "drive"), (TICKS, "set_mode")]
    assert 100 in run.hashes
    assert replay(run).state_hash() == end
    assert (run.folder / STATE).exists() is False, "nothing is saved before a simulated minute"
    assert [session.tick_count for session in run.play(until=7)] == list(range(8))


def test_it_goes_on_from_its_newest_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.runs.states.SAVE_EVERY_S", 1.0)
    monkeypatch.setattr("app.runs.states.SAVE_PAUSE_S", 0.0)
    run, end = keep_one(tmp_path, monkeypatch)
    state = newest_state(run)
    assert state is not None
    assert state.tick_count == 100
    assert resumed(run).state_hash() == end
    (run.folder / STATE).write_bytes(b"PK")
    assert newest_state(run) is None
    assert resumed(run).state_hash() == end


def test_cut_off_anywhere_it_opens_up_to_its_last_whole_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, _ = keep_one(tmp_path / "whole", monkeypatch)
    data = (run.folder / LINES).read_bytes()
    header = data.index(b"\n") + 1
    (tmp_path / "cut").mkdir()
    for at in [0, 1, header - 1, *range(header, len(data) + 1, 3)]:
        (tmp_path / "cut" / LINES).write_bytes(data[:at])
        if at < header:
            with pytest.raises(ValueError, match="it does not begin with a whole line"):
                open_run(tmp_path / "cut")
            continue
        cut = open_run(tmp_path / "cut")
        assert cut.size == data.rfind(b"\n", 0, at) + 1
        assert bool(cut.damage) == (cut.size < at)
        assert cut.orders == run.orders[: len(cut.orders)]
        assert cut.pulses == run.pulses[: len(cut.pulses)]
        assert all(order.tick <= cut.last_tick for order in cut.orders)


def test_it_goes_on_in_the_same_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, _ = keep_one(tmp_path, monkeypatch)
    path = run.folder / LINES
    path.write_bytes(path.read_bytes()[:-30])
    cut = open_run(run.folder)
    assert cut.end == ""
    assert cut.damage
    journal = Journal(cut.folder, cut.size, cut.check)
    assert is_open(cut.folder)
    with pytest.raises(ValueError, match="is going on in another program"):
        Journal(cut.folder, cut.size, cut.check)
    with pytest.raises(ValueError, match="is going on in another program; end its program first"):
        delete(cut.folder)
    journal.add({"tick": cut.last_tick, "again": "other"})
    journal.close()
    assert not is_open(cut.folder)
    whole = open_run(cut.folder)
    assert whole.again == [(cut.last_tick, "other")]
    assert (whole.damage, whole.end) == ("", "")


def _driving_at(run: KeptRun, speed: float) -> None:
    """Another version writes this speed into its order, and signs it."""
    lines = list(Lines(run.folder / LINES))
    lines[0]["run"]["version"] = "000000000000"
    order = next(line for line in lines if line.get("order") == "drive")
    order["values"]["speed"] = speed
    data, check = b"", 0
    for value in lines:
        line, check = line_of(value, check)
        data += line
    (run.folder / LINES).write_bytes(data)


def test_an_order_that_no_session_can_be_given_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the same laws as in a link."""
    run, _ = keep_one(tmp_path, monkeypatch)
    _driving_at(run, 50.0)
    with pytest.raises(ValueError, match=r"tick 75: the order drive .* again: drive: speed: input should be less"):
        replay(open_run(run.folder))


def test_a_run_that_differs_says_so_with_its_tick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    run, _ = keep_one(tmp_path, monkeypatch)
    _driving_at(run, 0.9)
    with pytest.raises(
        ReplayError, match=r"comes out differently from tick 76 on .* another version \(000000000000\)"
    ) as error:
        replay(open_run(run.folder))
    assert error.value.tick == 76
    monkeypatch.setattr("app.cli.runs.compile_first", lambda: None)
    assert main(["replay", run.name]) == 1
    assert "from tick 76 on" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ({"tick": 3, "pulses": "AAAA"}, "bytes for the ticks from"),
        ({"tick": 10**18, "pulses": "AAAAAA=="}, "bytes for the ticks from"),
        ({"tick": -1, "order": "kidnap", "values": {}}, "it is of tick -1"),
        ({"tick": 5, "order": "kidnap", "values": 3}, "line"),
        ({"tick": 5, "order": "edit_world", "values": {}, "edit": {"from": -1}}, "cannot be made again"),
        ({"tick": "x", "end": ""}, "a tick must be a whole number"),
        ({"end": ""}, "tick"),
    ],
)
def test_a_line_that_no_run_writes_is_refused(
    line: dict, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run, _ = keep_one(tmp_path, monkeypatch, ticks=5)
    with (run.folder / LINES).open("ab") as file:
        file.write(line_of(line, run.check)[0])
    with pytest.raises(ValueError, match=words):
        open_run(run.folder)


class Full:
    """A disk that takes so many bytes and no more, until it has room again."""

    def __init__(self, file, room: int) -> None:
        self.file, self.room = file, room

    def write(self, data: bytes) -> int:
        if self.room <= 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        written = self.file.write(data[: self.room])
        self.room -= written
        return written

    def __getattr__(self, name: str):
        return getattr(self.file, name)


@pytest.mark.parametrize("room", [0, 10, 1000, None])
def test_a_full_disk_is_told_of_once_and_the_file_opens(
    room: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """None: room for the header and half of the rest."""
    begin, enough = Journal.__init__, room is None
    if room is None:
        whole = (keep_one(tmp_path / "whole", monkeypatch)[0].folder / LINES).read_bytes()
        room = (whole.index(b"\n") + len(whole)) // 2
        tmp_path /= "full"

    def full(self: Journal, *values) -> None:
        begin(self, *values)
        self._file = Full(self._file, room)  # type: ignore[assignment]

    monkeypatch.setattr(Journal, "__init__", full)
    complaints: list[str] = []
    if not enough:
        with pytest.raises(ValueError, match="does not begin with a whole line"):
            keep_one(tmp_path, monkeypatch, complaints=complaints)
    else:
        run, _ = keep_one(tmp_path, monkeypatch, complaints=complaints)
        assert run.last_tick < TICKS
    assert len(complaints) == 1
    assert "No space left on device" in complaints[0]


def test_what_a_full_disk_did_not_take_is_written_when_there_is_room(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "run")
    full = journal._file = Full(journal._file, 12)  # type: ignore[assignment]
    for number in range(3):
        with pytest.raises(OSError, match="No space"):
            journal.add({"n": number})
    assert list(Lines(tmp_path / "run" / LINES)) == []
    full.room = 10**6
    journal.add({"n": 3})
    assert [value["n"] for value in list(Lines(tmp_path / "run" / LINES))] == [0, 1, 2, 3]


def test_a_folder_that_cannot_be_made_is_told_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    complaints: list[str] = []
    with pytest.raises(ValueError, match="no run is kept"):
        keep_one(tmp_path / "file", monkeypatch, ticks=3, complaints=complaints)
    assert len(complaints) == 1


def test_the_oldest_runs_go_first_and_one_that_goes_on_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import os

    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    for number in range(6):
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / LINES).write_bytes(b"x" * 1000)
        (folder / STATE).write_bytes(b"x" * 1000)
        os.utime(folder / LINES, (1000 + number, 1000 + number))
    journal = Journal(tmp_path / "0", 1000)
    os.utime(tmp_path / "0" / LINES, (1000, 1000))
    assert [folder.name for folder in all_runs()] == ["5", "4", "3", "2", "1", "0"]
    tidy(0.0071)
    assert [folder.name for folder in all_runs()] == ["5", "4", "3", "2", "0"]
    assert not (tmp_path / "2" / STATE).exists()
    tidy(most=2)
    assert [folder.name for folder in all_runs()] == ["5", "4", "0"]
    journal.close()


def test_boxes_and_edits_are_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from app.runs.header import beginning_of
    from app.runs.keeper import RunKeeper

    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    session = Session(LIVING, 4)
    keeper = RunKeeper(print)
    book = keeper.book(session, beginning_of(session))
    session.on_order = book.order
    keeper.begin(book)
    keeper.start()
    start = session.world.starts[0]
    for tick in range(40):
        if tick == 10:
            session.put_box(Box("crate", start.x + 2, start.y, 0.3, 0.3, 0.4, 0.3))
        if tick == 20:
            session.edit_world(replace(session.simulator.world, walls=session.world.walls[:-1]))
        session.tick()
        book.tick(session)
    keeper.stop()
    run = open_run("last")
    assert run.size < 40_000
    assert replay(run).state_hash() == session.state_hash()


def test_the_list_and_deleting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    run, _ = keep_one(tmp_path, monkeypatch, ticks=5)
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / LINES).write_bytes(b"nothing")
    assert main(["runs"]) == 0
    text = capsys.readouterr().out
    assert f"{run.name:28}" in text
    assert "complete" in text
    assert "it does not begin with a whole line" in text
    assert main(["runs", "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert {row["id"] for row in rows} == {run.name, "broken"}
    assert main(["runs", "delete", run.name]) == 0
    assert main(["runs", "delete", run.name]) == 2
    assert [folder.name for folder in all_runs()] == ["broken"]


def test_without_locks_it_is_kept_and_told_of_by_its_age(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on an NFS without its lock daemon: no error of a lock is taken for another program."""
    said: list[str] = []

    def no_locks(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("disk.locks.fcntl.flock", no_locks)
    run, end = keep_one(tmp_path, monkeypatch, complaints=said)
    assert len(said) == 1
    assert said[0].startswith(f"{tmp_path} has no file locks: the run is kept there")
    assert replay(run).state_hash() == end
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
    said: list[str] = []
    monkeypatch.setenv("HOME", "/")
    session = Session(LIVING, 3)
    monkeypatch.delenv("RATSLAM_RUNS", raising=False)
    keeper = RunKeeper(said.append)
    keeper.start()
    keeper.begin(keeper.book(session, beginning_of(session)))
    keeper.stop()
    assert said == [
        "the run is not kept: there is no home directory (it would be /): set HOME to a folder of yours; it goes on"
    ]
