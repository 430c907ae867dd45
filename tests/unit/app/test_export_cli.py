"""`ratslam export`: files where they are wanted, and one line for everything that is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.cli import command_line as cli
from app.cli import export as export_command
from app.export import FORMATS

from .exported import AgainAndAgain


@pytest.fixture(autouse=True)
def _kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """One run is kept, under the name "known"."""

    def open_run(name: str) -> AgainAndAgain:
        if name != "known":
            raise ValueError(f"there is no run {name!r}")
        return AgainAndAgain(30)

    monkeypatch.setattr("app.runs.run_file.open_run", open_run)
    monkeypatch.chdir(tmp_path)


def test_the_command_knows_every_format() -> None:
    assert export_command._FORMATS == FORMATS


def test_a_run_is_written_under_its_name(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert cli.main(["export", "known", "--to", "csv"]) == 0
    assert capsys.readouterr().out == "2026-01-02-office.csv  0.0 MB\n"
    assert cli.main(["export", "known", "--to", "tum", "--out", "a.tum", "--from", "1", "--until", "2"]) == 0
    assert len((tmp_path / "a-truth.tum").read_text().splitlines()) == 11
    assert cli.main(["export", "known", "--to", "mcap", "--pictures", "none", "--out", "a.mcap"]) == 0
    assert {file.name for file in tmp_path.iterdir()} == {
        "2026-01-02-office.csv", "a-truth.tum", "a-estimate.tum", "a-believed.tum", "a.mcap"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["lost", "--to", "csv"], "there is no run 'lost'"),
        (["known", "--to", "csv", "--from", "99"], "the run is 3 s long, so there is nothing in it from 99 s on"),
        (["known", "--to", "csv", "--from", "2", "--until", "1"], "--until must not be before --from (2 s), got 1"),
        (["known", "--to", "csv", "--from", "nan"], "--from must be a number of seconds from 0 on, got nan"),
        (["known", "--to", "mp4", "--speed", "-1"], "--speed must be from 0.1 to 1000 times, got -1"),
        (["known", "--to", "csv", "--out", "no/x.csv"], "--out no/x.csv: there is no folder"),
        (["known", "--to", "csv", "--out", "/dev/full"], "No space left on device"),
    ],
)
def test_what_is_wrong_is_one_line(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["export", *arguments]) == 2
    said = capsys.readouterr().err.strip().splitlines()
    assert len(said) == 1
    assert words in said[0]


def test_another_format_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cli.main(["export", "known", "--to", "avi"])
    assert "invalid choice: 'avi'" in capsys.readouterr().err
