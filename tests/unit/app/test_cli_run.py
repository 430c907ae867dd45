"""`ratslam run`: what is started and stopped, in which order, and what is printed."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from functools import partial
from types import SimpleNamespace

import pytest

from app import engine_thread
from app.cli import beginnings, serving
from app.cli import command_line as cli
from app.config import Config
from app.kept_brains import keeper as brain_keeper
from app.runs.folder import runs_folder
from app.time_machine import PastRoom
from sim2d import World
from tests.patience import PATIENCE_S
from web.http import server
from web.http.class_door import Classroom
from web.viewer import viewers

from .worlds import room


class Doubles:
    """Stands in for engine, viewers and dashboard, and notes what is done with them."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, refuse: bool = False, compiles: bool = False) -> None:
        self.log: list[str] = []
        self.made: dict[str, tuple] = {}
        self.began, self.refuse, self.compiles = threading.Event(), refuse, compiles
        self.latest = SimpleNamespace(waking="")
        monkeypatch.setattr("app.startup.compiling.Compiling", partial(CompilingDouble, self))
        monkeypatch.setattr(engine_thread, "EngineThread", partial(EngineDouble, self))
        monkeypatch.setattr(server, "Dashboard", partial(DashboardDouble, self))
        monkeypatch.setattr(brain_keeper.BrainKeeper, "start", lambda _self: None)
        monkeypatch.setattr(brain_keeper.BrainKeeper, "stop", lambda _self: None)
        monkeypatch.setattr(viewers, "Viewers", lambda *_: "viewers")
        monkeypatch.setattr("webbrowser.open", lambda url: self.log.append(f"opens {url}"))


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
    submit, stillborn = "submit", None

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

    def __init__(
        self,
        doubles: Doubles,
        latest: object,
        submit: object,
        stage: object,
        *,
        port: int,
        for_class: server.ForClass | None,
        **_options: object,
    ) -> None:
        self._doubles = doubles
        doubles.made["class"] = (for_class,)
        self.classroom = None if for_class is None else Classroom(for_class.address or "192.168.1.5", for_class.port)
        doubles.made["dashboard"] = (latest, submit, stage, port)

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


def test_run_binds_first_then_starts_and_stops(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    doubles = Doubles(monkeypatch)
    monkeypatch.setattr(serving, "_has_screen", lambda: True)
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


@pytest.mark.parametrize(("options", "screen"), [(["--no-browser"], True), ([], False)])
def test_no_browser_opens_unasked_or_unseen(options: list[str], screen: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = Doubles(monkeypatch)
    monkeypatch.setattr(serving, "_has_screen", lambda: screen)
    assert cli.main(["run", *options]) == 0
    assert not any(entry.startswith("opens") for entry in doubles.log)


def test_a_taken_port_is_a_sentence(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    doubles = Doubles(monkeypatch, refuse=True)
    assert cli.main([]) == 2
    assert capsys.readouterr().err == "ratslam: port 8000 is taken; try --port 0\n"
    assert doubles.log == ["compiling ends"]  # nothing else was started


def test_the_engine_stops_when_serving_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = Doubles(monkeypatch)
    monkeypatch.setattr(DashboardDouble, "run", lambda _self: (_ for _ in ()).throw(KeyboardInterrupt))
    assert cli.main(["run"]) == 130
    assert "engine stops" in doubles.log


def test_a_first_start_serves_while_it_compiles_and_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    doubles = Doubles(monkeypatch, compiles=True)
    assert cli.main(["run", "--no-browser"]) == 0
    assert doubles.log[:4] == ["bound", "waited, 3 functions done", "engine starts", "serving"]
    assert "RatSLAM wakes up: compiling the engine for this machine, once" in capsys.readouterr().out


@pytest.mark.slow
def test_an_engine_that_cannot_begin_ends_the_program_with_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whether or not the page is already being served."""
    world = room(start=(0.1, 0.1, 0.0))
    monkeypatch.setattr(beginnings, "session_of", lambda _args: (world, Config(), None))
    assert cli.main(["run", "--no-browser", "--port", "0"]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("ratslam: the engine could not begin: ")
    assert "the robot cannot start at home" in said


@pytest.mark.parametrize(
    ("platform", "environment", "screen"),
    [("linux", {}, False), ("linux", {"DISPLAY": ":0"}, True), ("linux", {"WAYLAND_DISPLAY": "w"}, True),
     ("darwin", {}, True), ("win32", {}, True)],
)  # fmt: skip
def test_a_screen(platform: str, environment: dict[str, str], screen: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert serving._has_screen() is screen


def test_the_memory_for_looking_back_is_said_in_megabytes(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    usual = PastRoom()
    assert (usual.memory_bytes, usual.disk_bytes) == (1e6 * serving.PAST_MB, 1e6 * serving.PAST_DISK_MB)
    doubles = Doubles(monkeypatch)
    assert cli.main(["run", "--keep-past", "50", "--keep-past-disk", "0"]) == 0
    room = doubles.made["engine"][3]["past_room"]
    assert (room.memory_bytes, room.disk_bytes) == (50_000_000, 0)
    assert cli.main(["run", "--keep-past-disk", "-1"]) != 0
    assert "--keep-past-disk must be megabytes from 0 on, got -1" in capsys.readouterr().err
    assert cli.main(["run", "--keep-past", "3"]) != 0
    assert "--keep-past must be megabytes from 20 on, got 3" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "wish", "door"),
    [
        ([], None, None),
        (["--class"], (None, 8001), "http://192.168.1.5:8001/"),
        (["--class", "--class-address", "10.0.0.7", "--class-port", "0"], ("10.0.0.7", 0), "http://10.0.0.7:0/"),
    ],
)
def test_a_class_is_let_in_only_when_it_is_asked_for(options, wish, door, monkeypatch, capsys) -> None:
    doubles = Doubles(monkeypatch)
    assert cli.main(["run", "--no-browser", *options]) == 0
    assert doubles.made["class"][0] == (None if wish is None else server.ForClass(*wish))
    told = capsys.readouterr().out
    assert ("A class votes at" in told) == (door is not None)
    assert door is None or f"votes at {door} and looks on at {door}?watch" in told


@pytest.mark.parametrize("option", [("--class-address", "10.0.0.7"), ("--class-port", "8001")])
def test_where_a_class_is_let_in_says_nothing_without_that(option, monkeypatch, capsys) -> None:
    Doubles(monkeypatch)
    assert cli.main(["run", "--no-browser", *option]) == 2
    assert capsys.readouterr().err == f"ratslam: {option[0]} goes with --class, which lets a class in\n"
