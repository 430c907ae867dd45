"""`ratslam run`: what is started and stopped, in which order, what is printed, and a trial that it begins with."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import pytest

from app import engine_thread
from app.cli import beginnings, run
from app.cli import command_line as cli
from app.cli.run import Serving, run_with_trial
from app.config import Config
from app.engine.engine import Engine
from app.protocol.experiment import find_experiment
from app.run_record.folder import runs_folder
from app.run_record.keyframes import PastRoom
from sim2d import World
from tests.patience import PATIENCE_S
from web.http import server
from web.http.class_door import Classroom
from web.viewer import viewer

from .engines import an_engine
from .sessions import OFFICE
from .trials_to_watch import table_trial
from .worlds import room

Captured = pytest.CaptureFixture[str]
Patch = pytest.MonkeyPatch


class Doubles:
    """Stands in for engine, viewers and dashboard, and notes what is done with them."""

    def __init__(self, monkeypatch: Patch) -> None:
        self.log: list[str] = []
        self.made: dict[str, tuple] = {}
        self.began, self.refuse, self.compiles = threading.Event(), False, False
        self.latest = SimpleNamespace(waking="")
        monkeypatch.setattr("app.startup.compiling.Compiling", partial(CompilingDouble, self))
        monkeypatch.setattr(engine_thread, "EngineThread", partial(EngineDouble, self))
        monkeypatch.setattr(server, "Dashboard", partial(DashboardDouble, self))
        monkeypatch.setattr(viewer, "Viewers", lambda *_: "viewers")
        monkeypatch.setattr("webbrowser.open", lambda url: self.log.append(f"opens {url}"))

    def begun(self) -> tuple[Engine, dict[str, Any]]:
        """An engine in which the program's first run has begun, and the options of the program's own."""
        _, _, _, options = self.made["engine"]
        engine = an_engine(OFFICE)
        options["first"](engine)
        return engine, options


class CompilingDouble:
    def __init__(self, doubles: Doubles) -> None:
        self._doubles = doubles

    def __bool__(self) -> bool:
        return self._doubles.compiles

    def wait(self, tell: Callable[[str], None]) -> None:
        if self._doubles.compiles:
            tell("3 functions done")
            self._doubles.log.append(f"waited, {self._doubles.latest.waking}")

    def stop(self) -> None:
        self._doubles.log.append("compiling ends")


class EngineDouble:
    submit, startup_error = "submit", None

    def __init__(self, doubles: Doubles, world: World, seed: int, config: Config, **options: object) -> None:
        self._doubles, self.latest = doubles, doubles.latest
        doubles.made["engine"] = (world.name, seed, config, options)

    def start(self) -> None:
        self._doubles.log.append("engine starts")
        self._doubles.began.set()

    def stop(self, _patience_s: float) -> None:
        self._doubles.log.append("engine stops")


class DashboardDouble:
    on_ready: Callable[[str], None] | None = None

    def __init__(self, doubles: Doubles, *engine: object, port: int, for_class: Any, **_options: object) -> None:
        self._doubles = doubles
        self.classroom = None if for_class is None else Classroom(for_class.address or "192.168.1.5", for_class.port)
        doubles.made |= {"class": (for_class,), "dashboard": (*engine, port)}

    def bind(self) -> None:
        if self._doubles.refuse:
            raise server.CannotListen("port 8000 is taken; try --port 0")
        self._doubles.log.append("bound")

    def run(self) -> None:
        assert self._doubles.began.wait(PATIENCE_S)
        self._doubles.log.append("serving")
        assert self.on_ready is not None
        self.on_ready("http://127.0.0.1:8000/")

    def stop(self) -> None:
        self._doubles.log.append("told to end")


@pytest.fixture
def doubles(monkeypatch: Patch) -> Doubles:
    return Doubles(monkeypatch)


def test_run_binds_first_then_starts_and_stops(doubles: Doubles, monkeypatch: Patch, capsys: Captured) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")  # where there is always a screen
    command = ["--world", "loop", "--seed", "9", "--port", "0", "--paused", "--speed", "3", "--set", "robot.light=0.8"]
    assert cli.main(command) == 0
    assert doubles.log == [
        "bound", "engine starts", "serving", "opens http://127.0.0.1:8000/", "compiling ends", "engine stops", "compiling ends",
    ]  # fmt: skip
    name, seed, config, options = doubles.made["engine"]
    assert options.pop("keeper") is not None
    assert options.pop("past_room") == PastRoom(folder=runs_folder())
    assert (name, seed, options) == ("loop", 9, {"speed": 3.0, "running": False, "brain": None, "first": None})
    assert config == Config().with_value("robot.light", 0.8)
    assert doubles.made["dashboard"][1:] == ("submit", "viewers", 0)
    assert "RatSLAM is alive at http://127.0.0.1:8000/" in capsys.readouterr().out


def test_a_browser_opens_where_there_is_a_screen_unless_told_not_to(
    doubles: Doubles, monkeypatch: Patch, subtests: pytest.Subtests
) -> None:
    for platform, variable, options, opens in (
        ("linux", None, [], False),
        ("linux", "DISPLAY", [], True),
        ("linux", "WAYLAND_DISPLAY", [], True),
        ("darwin", None, [], True),
        ("win32", None, [], True),
        ("linux", "DISPLAY", ["--no-browser"], False),
    ):
        with subtests.test(msg=f"{platform} {variable} {options}"), monkeypatch.context() as patch:
            patch.setattr(sys, "platform", platform)
            for name in ("DISPLAY", "WAYLAND_DISPLAY"):
                patch.delenv(name, raising=False)
            if variable:
                patch.setenv(variable, ":0")
            doubles.log.clear()
            assert cli.main(["run", *options]) == 0
            assert any(entry.startswith("opens") for entry in doubles.log) == opens
            assert doubles.made["engine"][1] == 1  # the seed, when nobody gives one


def test_a_taken_port_is_a_sentence(doubles: Doubles, capsys: Captured) -> None:
    doubles.refuse = True
    assert cli.main([]) == 2
    assert capsys.readouterr().err == "ratslam: port 8000 is taken; try --port 0\n"
    assert doubles.log == ["compiling ends"]  # nothing else was started


def test_the_engine_stops_when_serving_fails(doubles: Doubles, monkeypatch: Patch) -> None:
    monkeypatch.setattr(DashboardDouble, "run", lambda _self: (_ for _ in ()).throw(KeyboardInterrupt))
    assert cli.main(["run"]) == 130
    assert "engine stops" in doubles.log


def test_a_first_start_serves_while_it_compiles_and_says_so(doubles: Doubles, capsys: Captured) -> None:
    doubles.compiles = True
    assert cli.main(["run", "--no-browser"]) == 0
    assert doubles.log[:4] == ["bound", "waited, 3 functions done", "engine starts", "serving"]
    assert "RatSLAM wakes up: compiling the engine for this machine, once" in capsys.readouterr().out


@pytest.mark.slow
def test_an_engine_that_cannot_begin_ends_the_program_with_a_sentence(monkeypatch: Patch, capsys: Captured) -> None:
    """Whether or not the page is already being served."""
    world = room(start=(0.1, 0.1, 0.0))
    monkeypatch.setattr(beginnings, "session_of", lambda _args: (world, Config(), None))
    assert cli.main(["run", "--no-browser", "--port", "0"]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("ratslam: the engine could not begin: ")
    assert "the robot cannot start at home" in said


def test_the_memory_for_looking_back_is_said_in_megabytes(doubles: Doubles, capsys: Captured) -> None:
    usual = PastRoom()
    assert (usual.memory_bytes, usual.disk_bytes) == (1e6 * run.PAST_MB, 1e6 * run.PAST_DISK_MB)
    assert cli.main(["run", "--keep-past", "50", "--keep-past-disk", "0"]) == 0
    room = doubles.made["engine"][3]["past_room"]
    assert (room.memory_bytes, room.disk_bytes) == (50_000_000, 0)
    for option, value, least in (("--keep-past-disk", "-1", 0), ("--keep-past", "3", 20)):
        assert cli.main(["run", option, value]) != 0
        assert f"{option} must be megabytes from {least} on, got {value}" in capsys.readouterr().err


def test_a_class_is_let_in_only_when_it_is_asked_for(
    doubles: Doubles, capsys: Captured, subtests: pytest.Subtests
) -> None:
    for options, wish, door in (
        ([], None, None),
        (["--class"], (None, 8001), "http://192.168.1.5:8001/"),
        (["--class", "--class-address", "10.0.0.7", "--class-port", "0"], ("10.0.0.7", 0), "http://10.0.0.7:0/"),
    ):
        with subtests.test(msg=str(options)):
            assert cli.main(["run", "--no-browser", *options]) == 0
            assert doubles.made["class"][0] == (None if wish is None else server.ForClass(*wish))
            told = capsys.readouterr().out
            assert ("A class votes at" in told) == (door is not None)
            assert door is None or f"votes at {door} and looks on at {door}?watch" in told
    for option in (("--class-address", "10.0.0.7"), ("--class-port", "8001")):
        assert cli.main(["run", "--no-browser", *option]) == 2
        assert capsys.readouterr().err == f"ratslam: {option[0]} goes with --class, which lets a class in\n"


# ------------------------------------------------------------ with a trial


def test_a_trial_is_what_the_dashboard_begins_with(doubles: Doubles) -> None:
    command = ["run", "--no-browser", "--experiment", "table"]
    of_its_own = ["--engine", "paper", "--levels", "2 %", "8 x 8", "--seed", "9", "--speed", "4"]
    assert cli.main([*command, *of_its_own]) == 0
    name, seed, config, _ = doubles.made["engine"]
    assert (name, seed, config.pose_cells.n_x) == ("office", 9, 8)
    engine, options = doubles.begun()
    view, table = engine.snapshot().trial, find_experiment("table")
    assert view is not None
    assert (view.title, view.engine, view.levels, view.seed) == (table.title, "paper", ("2 %", "8 x 8"), 9)
    assert (engine.running, options["speed"], view.ahead) == (True, 4.0, None)
    assert cli.main([*command, "--paused"]) == 0
    assert doubles.made["engine"][1] == table.seed
    assert not doubles.begun()[0].running


def test_a_stored_trial_is_run_ahead_to_its_moment_and_another_version_is_told(doubles: Doubles) -> None:
    trial = table_trial()
    assert run_with_trial(trial, 20.0, title="A title", serving=Serving(port=0, browser=False)) == 0
    engine, _ = doubles.begun()
    assert engine.runs_ahead
    assert engine.run.trial is not None
    assert (engine.run.trial.trial, engine.run.trial.title) == (trial, "A title")
    assert not [event for event in engine.run.event_log.events if event.kind == "warning"]
    assert run_with_trial(replace(trial, version="earlier"), None, serving=Serving(browser=False)) == 0
    assert "the program has changed" in doubles.begun()[0].run.event_log.events[-1].text


def test_what_does_not_go_together_is_a_sentence(capsys: Captured, subtests: pytest.Subtests) -> None:
    table = ["--experiment", "table"]
    for options, words in (
        (["--experiment", "castle"], "unknown experiment 'castle'; expected a file that ends in .toml, or one of: "),
        ([*table, "--levels", "2 %", "9 x 9"], "pose cells has no level '9 x 9'; expected one of: 64 x 64"),
        ([*table, "--set", "robot.light=0.8"], "--set does not go with --experiment"),
        ([*table, "--resume-brain"], "--resume-brain does not go with --experiment"),
        ([*table, "--world", "loop"], "--world loop does not go with --experiment"),
        (["--engine", "paper"], "--engine is for a trial; give --experiment NAME with it"),
        (["--situation", "moment.json", "--seed", "0"], "--seed does not go with --situation, which has its own"),
        (["--resume", "last", "--seed", "0"], "--seed does not go with --resume: the run has its own"),
        (["--recording", "drive.mcap", "--world", "loop"], "--world loop does not go with --recording, which is no"),
    ):
        with subtests.test(msg=words):
            assert cli.main(["run", "--no-browser", *options]) == 2
            assert words in capsys.readouterr().err
