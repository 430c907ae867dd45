"""Whatever is raised in the engine's thread is shown, every request is answered, and after a reset the session goes on."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.config import Config
from app.engine import pace
from app.engine.faults import require_finite, words_of
from app.engine_thread import EngineThread
from app.session import Session
from app.views.snapshots import Snapshots
from app.world_editor import WorldEditor
from web import messages as m

from .engine_threads import OFFICE, PATIENCE_S, accept, do, refuse, snapshot, step, wait_for
from .worlds import room

Start = Callable[..., EngineThread]
RESET = m.Reset(type="reset")


def throwing(error: BaseException) -> Callable[..., Any]:
    def thrown(*_: object, **__: object) -> Any:
        raise error

    return thrown


def test_words_name_the_kind_of_a_fault() -> None:
    assert words_of(RuntimeError("a wheel came off")) == "RuntimeError: a wheel came off"
    assert words_of(SystemExit()) == "SystemExit"


@pytest.mark.parametrize("error", [SystemExit(3), KeyboardInterrupt(), MemoryError("no room"), GeneratorExit()])
def test_whatever_a_tick_throws_is_a_fault(start: Start, error: BaseException) -> None:
    engine = start(running=True)
    engine.session.tick = throwing(error)  # type: ignore[method-assign]
    now = wait_for(engine, lambda now: now.fault is not None)
    assert (now.running, now.fault) == (False, words_of(error))
    assert now.events[-1].kind == "fault"
    anew = accept(engine, RESET)
    assert (anew.fault, anew.running) == (None, True)
    assert wait_for(engine, lambda now: now.tick > 3).run == anew.run


@pytest.mark.parametrize("error", [RuntimeError("no picture"), SystemExit()])
def test_a_snapshot_that_cannot_be_built_stops_the_session_and_the_last_one_is_shown(
    start: Start, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    engine = start(running=True)
    wait_for(engine, lambda now: now.tick > 3)
    with monkeypatch.context() as spoilt:
        spoilt.setattr(Snapshots, "build", throwing(error))
        now = wait_for(engine, lambda now: now.fault is not None)
        assert (now.running, now.fault, now.run) == (False, words_of(error), 1)
        assert isinstance(do(engine, m.SetSpeed(type="set_speed", factor=0.0)), m.Accepted)
        assert refuse(engine, step()).value == "step"
    anew = accept(engine, RESET)
    assert (anew.fault, anew.run, anew.running) == (None, 2, True)
    assert accept(engine, step(3)).fault is None


def test_an_editor_and_a_hand_that_fail_are_faults(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    engine = start(running=True)
    with monkeypatch.context() as spoilt:
        spoilt.setattr(WorldEditor, "follow", throwing(RuntimeError("no pencil")))
        assert wait_for(engine, lambda now: now.fault is not None).fault == "RuntimeError: no pencil"
    accept(engine, RESET)
    monkeypatch.setattr(pace, "HAND_EXPIRES_S", 0.0)
    plain = engine.session.pilot.drive
    drives = iter([plain, throwing(RuntimeError("no hand"))])
    monkeypatch.setattr(engine.session.pilot, "drive", lambda *order: next(drives, plain)(*order))
    assert isinstance(do(engine, m.Drive(type="drive", speed=0.1, yaw_rate=0.0)), m.Accepted)
    assert wait_for(engine, lambda now: now.fault is not None).fault == "RuntimeError: no hand"
    assert accept(engine, RESET).fault is None


def test_an_order_that_ends_threads_is_answered_and_shown(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    engine = start()
    monkeypatch.setattr(engine.session, "kidnap", throwing(SystemExit("bye")))
    with pytest.raises(SystemExit, match="bye"):
        do(engine, m.Kidnap(type="kidnap"))
    assert wait_for(engine, lambda now: now.fault is not None).fault == "SystemExit: bye"
    assert accept(engine, RESET).fault is None


def test_what_is_no_number_any_more_is_a_fault(start: Start) -> None:
    engine = start()
    accept(engine, step(20))
    session, plain = engine.session, engine.session.tick

    def spoil(recorder: Any = None) -> None:
        plain(recorder)
        session.brain.experience_map.poses[3, 1] = np.nan

    session.tick = spoil  # type: ignore[method-assign]
    now = accept(engine, step(5))
    assert now.fault == "FloatingPointError: not finite after tick 21: the map's poses"
    assert accept(engine, RESET).fault is None


def test_every_part_of_a_state_has_to_be_finite() -> None:
    session = Session(OFFICE, 5)
    require_finite(session)
    sound = session.estimate
    nowhere = replace(sound.pose_map_robot, x=math.inf)
    session.estimate = replace(sound, pose_map_robot=nowhere)
    with pytest.raises(FloatingPointError, match="not finite after tick 0: the robot's pose in the map"):
        require_finite(session)
    session.estimate = replace(sound, packet=replace(sound.packet, mass=math.nan))
    with pytest.raises(FloatingPointError, match="the winning packet"):
        require_finite(session)
    session.estimate = sound
    session.brain.pose_cells.active[1][0] = np.nan
    with pytest.raises(FloatingPointError, match="the activity of the pose cells"):
        require_finite(session)


def test_an_engine_that_cannot_begin_says_so_and_answers() -> None:
    engine = EngineThread(room(start=(0.1, 0.1, 0.0)), 1, Config())
    early = engine.submit(step())
    engine.start()
    answer = early.result(PATIENCE_S)
    assert isinstance(answer, m.Refused)
    assert engine.stillborn is not None
    assert "the robot cannot start at home" in engine.stillborn
    assert answer.reason == f"the engine could not begin: {engine.stillborn}"
    assert do(engine, m.ReadBrain()) == m.Refused("type", "ReadBrain", answer.reason)
    engine.stop()


def test_who_comes_after_the_end_is_told_so() -> None:
    engine = EngineThread(OFFICE, 5, Config(), running=False)
    engine.start()
    snapshot(engine)
    early = [engine.submit(step(1000)) for _ in range(3)]
    engine.stop()
    assert not engine._thread.is_alive()
    assert all(answer.done() for answer in early)
    late = engine.submit(step())
    assert isinstance(late.result(0), m.Refused)
    assert "has ended" in late.result(0).reason  # type: ignore[union-attr]


def test_an_answer_that_nobody_waits_for_harms_nobody(start: Start) -> None:
    engine = start()
    unwanted: Future[Any] = engine.submit(step(50))
    unwanted.cancel()
    assert accept(engine, step()).fault is None
