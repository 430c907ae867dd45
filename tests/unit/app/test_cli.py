"""The command line without the dashboard: what is printed, written and refused."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

import pytest

from app.cli import command_line as cli
from app.cli import progress
from app.cli.options import port_number
from app.config import Config, from_toml
from sim2d.world.world_file import WORLDS


def test_config_is_taken_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["config", "--set", "pose_cells.n_x=32", "local_view.enabled=false"]) == 0
    text = capsys.readouterr().out
    assert from_toml(text) == Config().with_value("pose_cells.n_x", 32).with_value("local_view.enabled", False)
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    assert cli.main(["config", "--config", str(file)]) == 0
    assert capsys.readouterr().out == text


def test_settings_of_one_command_line_are_taken_together(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["config", "--set", "robot.physics_rate_hz=77", "robot.sensor_rate_hz=7"]) == 0
    assert "physics_rate_hz = 77\n" in capsys.readouterr().out
    assert cli.main(["config", "--set", "robot.physics_rate_hz=77"]) == 2


def test_worlds_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["worlds"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("office ")
    assert {line.split()[0] for line in lines} >= {"office", "loop", "floor"}
    assert "10 x 8 m; ACRA 2006: " in lines[0]


@pytest.mark.slow
def test_a_plan_is_checked_imported_and_driven_in(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
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


def test_check_says_everything_that_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "x.json"
    text = (WORLDS / "loop.json").read_text("utf-8")
    path.write_text(
        text.replace('"height": 2.6', '"height": -1', 1).replace('"heading_deg": 0.0', '"heading_deg": "east"')
    )
    assert cli.main(["worlds", "check", str(path)]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 2
    assert "x.json: walls[0].height: got -1; input should be greater than 0 (line " in errors[0]
    assert "x.json: starts[0].heading_deg: got 'east'" in errors[1]
    path.write_text(
        text.replace('"places": [', '"places": [{"name": "a", "x": 90, "y": 0}, {"name": "b", "x": 3, "y": 3},')
    )
    assert cli.main(["worlds", "check", str(path)]) == 2
    assert [line.split("(")[0] for line in capsys.readouterr().err.splitlines()] == [
        "ratslam: x.json: places[0] ", "ratslam: x.json: places[1] ",
    ]  # fmt: skip
    path.write_text("{\n,")
    assert cli.main(["worlds", "check", str(path)]) == 2
    assert "not JSON: line 2, column 1" in capsys.readouterr().err
    assert cli.main(["worlds", "check", str(tmp_path / "none.json")]) == 2
    assert cli.main(["worlds", "check", str(WORLDS / "office.json")]) == 0


def test_the_schema_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["worlds", "schema"]) == 0
    assert capsys.readouterr().out == (WORLDS / "schema.json").read_text("utf-8")


@pytest.mark.slow
def test_headless_prints_its_report(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["headless", "--minutes", "0.1", "--seed", "3", "--world", "loop"]) == 0
    out = capsys.readouterr().out
    report = json.loads(out)
    assert (report["world"], report["seed"], report["ticks"]) == ("loop", 3, 60)


@pytest.mark.slow
def test_headless_writes_its_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "report.json"
    command = ["headless", "--minutes", "0.3", "--goals", "1", "--kidnap-at", "3", "7.5", "--report", str(file)]
    assert cli.main(command) == 0
    report = json.loads(file.read_text("utf-8"))
    assert len(report["goals"]) == 1
    assert [kidnap["at_s"] for kidnap in report["kidnaps"]] == [3.0, 7.5]
    out = capsys.readouterr().out
    assert out.startswith("office, seed 1: map error ")
    assert f"{int(report['goals'][0]['reached'])} of 1 goals reached" in out
    assert str(file) in out


@pytest.mark.slow
def test_parameters_reach_the_run(tmp_path: Path) -> None:
    reports = []
    for options in ([], ["--set", "pilot.cruise_speed=0.2"]):
        file = tmp_path / "report.json"
        assert cli.main(["headless", "--minutes", "0.2", "--report", str(file), *options]) == 0
        reports.append(json.loads(file.read_text("utf-8")))
    assert reports[0]["state_hash"] != reports[1]["state_hash"]


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        (["headless", "--world", "castle"], "no world 'castle'; expected one of: office"),
        (["headless", "--seed", "-1"], "--seed must be from 0 to 4294967295, got -1"),
        (["headless", "--seed", "4294967296"], "--seed must be from 0 to 4294967295, got 4294967296"),
        (["headless", "--minutes", "-1"], "--minutes must be from 0 to 1e6, got -1.0"),
        (["headless", "--minutes", "nan"], "--minutes must be from 0 to 1e6, got nan"),
        (["headless", "--goals", "-2"], "--goals must be from 0 to 1e6, got -2"),
        (["headless", "--minutes", "1", "--kidnap-at", "60"], "--kidnap-at must be from 0 to below 60 s, got 60"),
        (["headless", "--minutes", "1", "--kidnap-at", "5", "-3"], "--kidnap-at must be from 0 to below 60 s, got -3"),
        (["headless", "--kidnaps", "-1"], "--kidnaps must be from 0 to 1e6, got -1"),
        (["headless", "--kidnaps", "2", "--kidnap-at", "5"], "do not give --kidnap-at with it"),
        (["headless", "--kidnaps", "1", "--minutes", "0.5"], "0.5 minutes are too short for a kidnap"),
        (["headless", "--report", "/nowhere/at/all.json"], "there is no folder"),
        (["headless", "--config", "/nowhere.toml"], "--config /nowhere.toml: No such file or directory"),
        (["headless", "--set", "pilot.cruise_speed"], "--set takes NAME=VALUE, got 'pilot.cruise_speed'"),
        (
            ["config", "--set", "pilot.cruise=1"],
            "unknown parameter 'pilot.cruise'; expected one of: pilot.cruise_speed",
        ),
        (["config", "--set", "pilot.cruise_speed=9"], "pilot.cruise_speed must be between 0.05 and 0.5 m/s, got 9.0"),
        (["config", "--set", "pilot.cruise_speed=[1]"], "'[1]' is not a number, true, false or a word"),
        (["config", "--set", "robot.light=1" + 400 * "0"], "robot.light must be within its range"),
        (["run", "--speed", "-1"], "--speed must be 0 (as fast as possible) or from 0.25 to 16, got -1"),
        (["run", "--speed", "nan"], "--speed must be 0 (as fast as possible) or from 0.25 to 16, got nan"),
        (["run", "--world", "castle"], "no world 'castle'"),
        (["--paused", "--speed", "17"], "--speed must be 0 (as fast as possible) or from 0.25 to 16, got 17"),
        (["--paused", "--speed", "0.2"], "or from 0.25 to 16, got 0.2"),
        (["headless", "--set", "robot.image_width=8"], "robot.image_width must be at least 12"),
    ],
)
def test_what_cannot_be_is_a_sentence(command: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(command) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("ratslam: ")
    assert sentence in captured.err
    assert len(captured.err.splitlines()) == 1
    assert captured.out == ""


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[robott]\n", "unknown section 'robott'; expected one of: pose_cells"),
        ("[robot]\nlight = 7\n", "robot.light must be from 0.1 to 2, got 7.0"),
        ("light\n", "not valid TOML"),
    ],
)
def test_a_bad_config_file_is_named(
    text: str, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    assert cli.main(["config", "--config", str(file)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"ratslam: --config {file}: ")
    assert sentence in error


def test_a_config_file_that_is_not_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(b"\xff\xfe\x00")
    assert cli.main(["config", "--config", str(file)]) == 2
    assert str(file) in capsys.readouterr().err


def test_a_world_file_that_cannot_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mine.json"
    file.write_text("{", encoding="utf-8")
    assert cli.main(["headless", "--world", str(file)]) == 2
    assert "mine.json: not JSON: line 1" in capsys.readouterr().err


@pytest.mark.parametrize(
    "command", [["run", "--port", "70000"], ["run", "--port", "web"], ["fly"], ["headless", "--goals", "x"]]
)
def test_what_argparse_refuses_ends_with_two(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(command)
    assert end.value.code == 2
    assert "error:" in capsys.readouterr().err


def test_a_port_is_a_whole_number() -> None:
    assert port_number("0") == 0
    assert port_number("65535") == 65535
    for text in ("65536", "-1", "8000.0", ""):
        with pytest.raises(argparse.ArgumentTypeError, match="a port is a whole number from 0 to 65535, got"):
            port_number(text)


def test_help_is_not_a_run(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(["--help"])
    assert end.value.code == 0
    assert "headless" in capsys.readouterr().out


@pytest.mark.slow
def test_it_runs_as_a_module() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "import sys; from app.cli.command_line import main; sys.exit(main())", "worlds"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0
    assert done.stdout.startswith("office ")


@pytest.mark.slow
def test_control_c_ends_quietly(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_args: object, **_more: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("app.headless.run_headless", interrupted)
    assert cli.main(["headless", "--minutes", "0.1"]) == 130


def test_progress_is_counted_beyond_what_was_expected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Goals come after the minutes that were asked for."""
    bars = []
    tqdm = __import__("tqdm").tqdm

    class Bar(tqdm):
        def __init__(self, **options: object) -> None:
            super().__init__(**{**options, "disable": False, "file": open("/dev/null", "w", encoding="utf-8")})  # type: ignore[arg-type]  # noqa: SIM115
            bars.append(self)

        def close(self) -> None:
            super().close()
            self.fp.close()

    monkeypatch.setattr("tqdm.tqdm", Bar)

    def work(progress) -> str:
        for _ in range(7):
            progress(10.0, "exploring")
        return "done"

    assert progress.with_progress(50.0, work) == "done"
    assert bars[0].n == 70
    assert bars[0].total == 70


def test_bench_prints_and_writes_its_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [{"work": "sweep", "ms": 0.1, "holds": True}, {"work": "match", "ms": 0.2, "holds": True}]
    monkeypatch.setattr("benchmarks.engine.rows", lambda _quick: iter(rows[:1]))
    monkeypatch.setattr("benchmarks.office.rows", lambda _quick: iter(rows[1:]))
    monkeypatch.setattr("benchmarks.engine.line", lambda row: f"{row['work']}: {row['ms']}")
    file = tmp_path / "bench.json"
    assert cli.main(["bench", "--json", str(file)]) == 0
    assert json.loads(file.read_text("utf-8")) == rows
    assert cli.main(["bench"]) == 0
    assert capsys.readouterr().out == 2 * "sweep: 0.1\nmatch: 0.2\n"
