"""Exports that are asked for: by `ratslam export`, and by the page, for which a copy of the session is enough or a run
that keeps itself is played again."""

from __future__ import annotations

import asyncio
import os
import sys
from concurrent.futures import Future
from pathlib import Path

import networkx as nx
import pytest

from app.cli import command_line as cli
from app.export import FORMATS
from app.export.export import NOT_KEPT, PageExports
from app.export.text_formats import g2o_text
from app.session_snapshot import take_session
from ratslam_live import command_of
from web.http.export import ExportRequest
from web.messages import Accepted, ReadSession, Refused

from .exported import AgainAndAgain
from .sessions import a_session

# ------------------------------------------------------------ by the command


@pytest.fixture
def folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Where the command is given. One run is kept, under the name "known"."""

    def open_run(name: str) -> AgainAndAgain:
        if name != "known":
            raise ValueError(f"there is no run {name!r}")
        return AgainAndAgain(30)

    monkeypatch.setattr("app.run_record.reader.open_run", open_run)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_run_is_written_under_its_name(capsys: pytest.CaptureFixture[str], folder: Path) -> None:
    assert cli.main(["export", "known", "--to", "csv"]) == 0
    assert capsys.readouterr().out == "2026-01-02-office.csv  0.0 MB\n"
    assert cli.main(["export", "known", "--to", "tum", "--out", "a.tum", "--from", "1", "--until", "2"]) == 0
    assert len((folder / "a-truth.tum").read_text().splitlines()) == 11
    assert cli.main(["export", "known", "--to", "mcap", "--pictures", "none", "--out", "a.mcap"]) == 0
    assert {file.name for file in folder.iterdir()} == {
        "2026-01-02-office.csv", "a-truth.tum", "a-estimate.tum", "a-believed.tum", "a.mcap"
    }  # fmt: skip


@pytest.mark.usefixtures("folder")
def test_what_is_wrong_is_one_line(capsys: pytest.CaptureFixture[str], subtests: pytest.Subtests) -> None:
    for arguments, words in (
        ("lost --to csv", "there is no run 'lost'"),
        ("known --to csv --from 99", "the run is 3 s long, so there is nothing in it from 99 s on"),
        ("known --to csv --from 2 --until 1", "--until must not be before --from (2 s), got 1"),
        ("known --to csv --from nan", "--from must be a number of seconds from 0 on, got nan"),
        ("known --to mp4 --speed -1", "--speed must be from 0.1 to 1000 times, got -1"),
        ("known --to csv --out no/x.csv", "--out no/x.csv: there is no folder"),
        ("known --to csv --out /dev/full", "No space left on device"),
    ):
        with subtests.test(msg=arguments):
            assert cli.main(["export", *arguments.split()]) == 2
            (said,) = capsys.readouterr().err.strip().splitlines()
            assert words in said
    with pytest.raises(SystemExit):
        cli.main(["export", "known", "--to", "avi"])
    said = capsys.readouterr().err
    assert "invalid choice: 'avi'" in said
    assert all(format_ in said.split("invalid choice")[1] for format_ in FORMATS)


# ------------------------------------------------------------ by the page

SESSION = a_session(60)


def submit(request: object) -> Future[Accepted | Refused]:
    assert isinstance(request, ReadSession)
    answer: Future[Accepted | Refused] = Future()
    answer.set_result(Accepted(60, take_session(SESSION)))
    return answer


def test_what_can_be_had_depends_on_whether_the_run_keeps_itself() -> None:
    refused = {offer.format for offer in PageExports().offers() if offer.refusal == NOT_KEPT}
    assert refused == {"mcap", "tum", "csv", "mp4"}
    offers = PageExports(lambda: Path("run")).offers()
    assert [offer.format for offer in offers] == list(FORMATS)
    assert all(offer.refusal is None and offer.words for offer in offers)


def test_the_map_now_comes_from_a_copy(tmp_path: Path) -> None:
    def write(to: str) -> list[Path]:
        return asyncio.run(PageExports().write(to, submit, tmp_path / f"run.{to}", ExportRequest()))

    (graph,), (poses,), pictures = write("graphml"), write("g2o"), write("png")
    assert len(nx.read_graphml(graph)) == len(SESSION.brain.experience_map)
    assert poses.read_bytes() == g2o_text(SESSION)
    assert [picture.name for picture in pictures] == ["run-map.png", "run-times.png", "run-paths.png"]
    with pytest.raises(ValueError, match="does not keep itself"):
        write("mcap")


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stands in for Python: a script that is given the words of the command."""
    script = tmp_path / "program"
    monkeypatch.setattr(sys, "executable", str(script))
    return script


def will(script: Path, do: str) -> None:
    script.write_text(f"#!/bin/sh\n{do}\n")
    script.chmod(0o700)


def test_a_kept_run_is_played_again_by_a_process_of_its_own(program: Path, tmp_path: Path) -> None:
    exports, out = PageExports(lambda: tmp_path / "kept run"), tmp_path / "run.csv"
    will(program, 'echo "$@" > ' + f'"{out}"')
    assert asyncio.run(exports.write("csv", submit, out, ExportRequest())) == [out]
    words = [*command_of("app")[1:], "export", str(tmp_path / "kept run"), "--to", "csv", "--out", str(out)]
    assert out.read_text() == " ".join([*words, "--say-share --pictures png\n"])
    will(program, 'echo done 0.42; echo "$@" > ' + f'"{out}"')
    asyncio.run(exports.write("csv", submit, out, ExportRequest(from_s=1.5, until_s=20.0, pictures="jpeg")))
    assert out.read_text().endswith("--say-share --pictures jpeg --from 1.5 --until 20.0\n")
    assert exports.done == 0.42
    will(program, "echo ratslam: the disk is full >&2; exit 2")
    with pytest.raises(ValueError, match=r"^the disk is full$"):
        asyncio.run(exports.write("csv", submit, out, ExportRequest()))


def test_what_nobody_waits_for_is_ended(program: Path, tmp_path: Path) -> None:
    pid = tmp_path / "pid"
    will(program, f'echo $$ > "{pid}.new"; mv "{pid}.new" "{pid}"; exec sleep 1000')

    async def ask_and_leave() -> None:
        writing = asyncio.create_task(
            PageExports(lambda: tmp_path).write("csv", submit, tmp_path / "run.csv", ExportRequest())
        )
        while not pid.exists():
            await asyncio.sleep(0.01)
        writing.cancel()
        with pytest.raises(asyncio.CancelledError):
            await writing

    asyncio.run(ask_and_leave())
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()), 0)
