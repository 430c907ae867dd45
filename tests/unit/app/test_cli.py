"""The command line without the dashboard: what is printed, written and refused."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from app.cli import command_line as cli
from app.cli.options import port_number, with_progress
from app.config import Config, from_toml
from sim2d.world.world_file import WORLDS

Captured = pytest.CaptureFixture[str]
Patch = pytest.MonkeyPatch


def refused(capsys: Captured, *words: str) -> str:
    """The one sentence with which a command line is refused."""
    assert cli.main([*words]) == 2
    out, err = capsys.readouterr()
    assert (out, err[:9], err.count("\n")) == ("", "ratslam: ", 1)
    return err


def test_config_is_taken_back(tmp_path: Path, capsys: Captured) -> None:
    assert cli.main(["config", "--set", "pose_cells.n_x=32", "local_view.enabled=false"]) == 0
    text = capsys.readouterr().out
    assert from_toml(text) == Config().with_value("pose_cells.n_x", 32).with_value("local_view.enabled", False)
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    assert cli.main(["config", "--config", str(file)]) == 0
    assert capsys.readouterr().out == text
    # neither of these would be taken without the other
    assert cli.main(["config", "--set", "robot.physics_rate_hz=77", "robot.sensor_rate_hz=7"]) == 0
    assert "physics_rate_hz = 77\n" in capsys.readouterr().out


def test_worlds_are_listed_and_their_schema_is_printed(capsys: Captured) -> None:
    assert cli.main(["worlds"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("office ")
    assert {line.split()[0] for line in lines} >= {"office", "loop", "floor"}
    assert "10 x 8 m; ACRA 2006: " in lines[0]
    assert cli.main(["worlds", "schema"]) == 0
    assert capsys.readouterr().out == (WORLDS / "schema.json").read_text("utf-8")


@pytest.mark.slow
def test_a_plan_is_checked_imported_and_driven_in(tmp_path: Path, capsys: Captured) -> None:
    picture, world = tmp_path / "plan.pgm", tmp_path / "plan.json"
    picture.write_bytes(b"P5\n80 60\n255\n" + b"\x00" * 80 + (b"\x00" + b"\xff" * 78 + b"\x00") * 58 + b"\x00" * 80)
    assert cli.main(["worlds", "check", str(picture)]) == 2
    assert "plan.pgm: a plain picture needs its scale" in capsys.readouterr().err
    assert cli.main(["worlds", "check", str(picture), "--scale", "0.1"]) == 0
    assert cli.main(["worlds", "import", str(picture), "--scale", "0.1", "--seed", "3", "-o", str(world)]) == 0
    assert "plan, 8 x 6 m, 4 walls, 4 starts" in capsys.readouterr().out
    for arguments in (["--world", str(world)], ["--world", str(picture), "--scale", "0.1"]):
        assert cli.main(["headless", "--minutes", "0.05", *arguments]) == 0
        assert json.loads(capsys.readouterr().out)["world"] == "plan"
    assert cli.main(["worlds", "import", str(picture), "--scale", "0.1", "-o", str(tmp_path / "no" / "x.json")]) == 2
    assert cli.main(["worlds", "import", str(picture), "--seed", "-1", "-o", str(world)]) == 2
    assert cli.main(["headless", "--world", "office", "--scale", "0.1"]) == 2


def test_check_says_everything_that_is_wrong(tmp_path: Path, capsys: Captured) -> None:
    path, text = tmp_path / "x.json", (WORLDS / "loop.json").read_text("utf-8")

    def wrong(file: str) -> list[str]:
        path.write_text(file)
        assert cli.main(["worlds", "check", str(path)]) == 2
        return capsys.readouterr().err.splitlines()

    height, heading = wrong(
        text.replace('"height": 2.6', '"height": -1', 1).replace('"heading_deg": 0.0', '"heading_deg": "east"')
    )
    assert "x.json: walls[0].height: got -1; input should be greater than 0 (line " in height
    assert "x.json: starts[0].heading_deg: got 'east'" in heading
    places = '"places": [{"name": "a", "x": 90, "y": 0}, {"name": "b", "x": 3, "y": 3},'
    first, second = wrong(text.replace('"places": [', places))
    assert first.startswith("ratslam: x.json: places[0] (")
    assert second.startswith("ratslam: x.json: places[1] (")
    assert "not JSON: line 2, column 1" in wrong("{\n,")[0]
    assert cli.main(["worlds", "check", str(tmp_path / "none.json")]) == 2
    assert cli.main(["worlds", "check", str(WORLDS / "office.json")]) == 0


@pytest.mark.slow
def test_headless_prints_or_writes_its_report_of_a_run_with_the_parameters(tmp_path: Path, capsys: Captured) -> None:
    hashes = []
    for options in ([], ["--set", "pilot.cruise_speed=0.2"]):
        assert cli.main(["headless", "--minutes", "0.1", "--seed", "3", "--world", "loop", *options]) == 0
        report = json.loads(capsys.readouterr().out)
        assert (report["world"], report["seed"], report["ticks"]) == ("loop", 3, 60)
        hashes.append(report["state_hash"])
    assert hashes[0] != hashes[1]
    file = tmp_path / "report.json"
    command = ["headless", "--minutes", "0.3", "--goals", "1", "--kidnap-at", "3", "7.5", "--report", str(file)]
    assert cli.main(command) == 0
    report, out = json.loads(file.read_text("utf-8")), capsys.readouterr().out
    assert len(report["goals"]) == 1
    assert [kidnap["at_s"] for kidnap in report["kidnaps"]] == [3.0, 7.5]
    assert out.startswith("office, seed 1: map error ")
    assert f"{int(report['goals'][0]['reached'])} of 1 goals reached" in out
    assert str(file) in out


REFUSED = [
    ("headless --world castle", "no world 'castle'; expected one of: office"),
    ("headless --seed -1", "--seed must be from 0 to 4294967295, got -1"),
    ("headless --seed 4294967296", "--seed must be from 0 to 4294967295, got 4294967296"),
    ("headless --minutes -1", "--minutes must be from 0 to 1e6, got -1.0"),
    ("headless --minutes nan", "--minutes must be from 0 to 1e6, got nan"),
    ("headless --goals -2", "--goals must be from 0 to 1e6, got -2"),
    ("headless --minutes 1 --kidnap-at 60", "--kidnap-at must be from 0 to below 60 s, got 60"),
    ("headless --minutes 1 --kidnap-at 5 -3", "--kidnap-at must be from 0 to below 60 s, got -3"),
    ("headless --kidnaps -1", "--kidnaps must be from 0 to 1e6, got -1"),
    ("headless --kidnaps 2 --kidnap-at 5", "do not give --kidnap-at with it"),
    ("headless --kidnaps 1 --minutes 0.5", "0.5 minutes are too short for a kidnap"),
    ("headless --report /nowhere/at/all.json", "there is no folder"),
    ("headless --config /nowhere.toml", "--config /nowhere.toml: No such file or directory"),
    ("headless --set pilot.cruise_speed", "--set takes NAME=VALUE, got 'pilot.cruise_speed'"),
    ("config --set pilot.cruise=1", "unknown parameter 'pilot.cruise'; expected one of: pilot.cruise_speed"),
    ("config --set pilot.cruise_speed=9", "pilot.cruise_speed must be between 0.05 and 0.5 m/s, got 9.0"),
    ("config --set pilot.cruise_speed=[1]", "'[1]' is not a number, true, false or a word"),
    ("config --set robot.light=1" + 400 * "0", "robot.light must be within its range"),
    ("run --speed -1", "--speed must be 0 (as fast as possible) or from 0.25 to 16, got -1"),
    ("run --speed nan", "--speed must be 0 (as fast as possible) or from 0.25 to 16, got nan"),
    ("run --world castle", "no world 'castle'"),
    ("--paused --speed 17", "--speed must be 0 (as fast as possible) or from 0.25 to 16, got 17"),
    ("--paused --speed 0.2", "or from 0.25 to 16, got 0.2"),
    (
        "config --set robot.physics_rate_hz=77",
        "robot.physics_rate_hz must be a multiple of sensor_rate_hz (10), got 77",
    ),
    ("headless --set robot.image_width=8", "robot.image_width must be at least 12"),
]


def test_what_cannot_be_is_a_sentence(capsys: Captured, subtests: pytest.Subtests) -> None:
    for command, sentence in REFUSED:
        with subtests.test(msg=command):
            assert sentence in refused(capsys, *command.split())


def test_a_file_that_cannot_be_used_is_named(tmp_path: Path, capsys: Captured, subtests: pytest.Subtests) -> None:
    toml, world = tmp_path / "mine.toml", tmp_path / "mine.json"
    for file, content, sentence in (
        (toml, b"[robott]\n", "unknown section 'robott'; expected one of: pose_cells"),
        (toml, b"[robot]\nlight = 7\n", "robot.light must be between 0.1 and 2, got 7.0"),
        (toml, b"light\n", "not valid TOML"),
        (toml, b"\xff\xfe\x00", ""),
        (world, b"{", "mine.json: not JSON: line 1"),
    ):
        with subtests.test(msg=sentence):
            file.write_bytes(content)
            words = ["config", "--config", str(file)] if file is toml else ["headless", "--world", str(file)]
            said = refused(capsys, *words)
            assert sentence in said
            assert file is world or f"--config {file}: " in said


def test_what_argparse_ends(capsys: Captured, subtests: pytest.Subtests) -> None:
    for command, code, words in (
        ("run --port 70000", 2, "error:"),
        ("run --port web", 2, "error:"),
        ("fly", 2, "error:"),
        ("headless --goals x", 2, "error:"),
        ("--help", 0, "headless"),
    ):
        with subtests.test(msg=command):
            with pytest.raises(SystemExit) as end:
                cli.main(command.split())
            assert end.value.code == code
            assert words in "".join(capsys.readouterr())


def test_a_port_is_a_whole_number() -> None:
    assert (port_number("0"), port_number("65535")) == (0, 65535)
    for text in ("65536", "-1", "8000.0", ""):
        with pytest.raises(argparse.ArgumentTypeError, match="a port is a whole number from 0 to 65535, got"):
            port_number(text)


@pytest.mark.slow
def test_control_c_ends_quietly(monkeypatch: Patch) -> None:
    def interrupted(*_args: object, **_more: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("app.headless.run_headless", interrupted)
    assert cli.main(["headless", "--minutes", "0.1"]) == 130


def test_progress_is_counted_beyond_what_was_expected(monkeypatch: Patch) -> None:
    """Goals come after the minutes that were asked for."""
    told: list[dict[str, float]] = []
    monkeypatch.setattr("rich.progress.Progress.update", lambda _bar, _task, **now: told.append(now))

    def work(progress: Callable[[float, str], None]) -> str:
        for _ in range(7):
            progress(10.0, "exploring")
        return "done"

    assert with_progress(50.0, work) == "done"
    assert [(now["completed"], now["total"]) for now in told[-3:]] == [(50, 50), (60, 60), (70, 70)]


def test_bench_prints_and_writes_its_rows(tmp_path: Path, monkeypatch: Patch, capsys: Captured) -> None:
    rows = [{"work": "sweep", "ms": 0.1, "holds": True}, {"work": "match", "ms": 0.2, "holds": True}]
    monkeypatch.setattr("benchmarks.engine.rows", lambda _quick: iter(rows[:1]))
    monkeypatch.setattr("benchmarks.office.rows", lambda _quick: iter(rows[1:]))
    monkeypatch.setattr("benchmarks.engine.line", lambda row: f"{row['work']}: {row['ms']}")
    file = tmp_path / "bench.json"
    assert cli.main(["bench", "--json", str(file)]) == 0
    assert json.loads(file.read_text("utf-8")) == rows
    assert cli.main(["bench"]) == 0
    assert capsys.readouterr().out == 2 * "sweep: 0.1\nmatch: 0.2\n"
