"""The engine's thread: pace, driving by hand that expires, snapshots; and whatever is raised in it is shown, every
request is answered, and after a reset the session goes on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.config import Config
from app.engine import pace
from app.engine.watchdog import require_finite, words_of
from app.engine_thread import EngineThread
from app.session import SECOND
from app.views.snapshots import Snapshots
from app.world_editor import WorldEditor
from web import messages as m

from .engine_threads import OFFICE, PATIENCE_S, accept, do, refuse, snapshot, step, wait_for
from .sessions import a_session
from .worlds import room

Start = Callable[..., EngineThread]
RESET, PAUSE, RESUME = m.Reset(type="reset"), m.Pause(type="pause"), m.Resume(type="resume")
KIDNAP, AHEAD = m.Kidnap(type="kidnap"), m.Drive(type="drive", speed=0.3, yaw_rate=0.0)


def test_what_only_reads_makes_no_snapshot(start: Start) -> None:
    """Who keeps brains reads one now and then, and the pages would be told the same once more."""
    engine = start()
    accept(engine, step(3))
    version, _ = engine.latest.get()
    for reads in (m.ReadSession(), m.ReadBrain()):
        assert do(engine, reads).result is not None
    assert engine.latest.get()[0] == version
    accept(engine, step(1))
    assert engine.latest.get()[0] > version


# ---------------------------------------------------------------- pace


def test_the_first_snapshot_comes_before_anything_moves_and_steps_are_counted(start: Start) -> None:
    engine = start()
    now = snapshot(engine)
    assert (now.tick, now.run, now.running, now.seed, now.fault) == (0, 1, False, 5, None)
    assert now.speed == float("inf")
    assert ("office", OFFICE.title) in now.worlds
    assert [accept(engine, step(ticks)).tick for ticks in (1, 7, 100)] == [1, 8, 108]
    now = snapshot(engine)
    assert not now.running
    assert now.time_s == pytest.approx(10.8)


@pytest.mark.slow
def test_running_pauses_and_resumes_at_any_speed(start: Start) -> None:
    engine = start(running=True)
    assert wait_for(engine, lambda now: now.real_time_factor > 0).tick > 0
    wait_for(engine, lambda now: now.tick >= 30)
    paused = accept(engine, PAUSE)
    assert not paused.running
    assert do(engine, PAUSE) == m.Accepted(paused.tick)
    assert accept(engine, m.SetSpeed(type="set_speed", factor=16.0)).speed == 16.0
    assert accept(engine, RESUME).running
    later = wait_for(engine, lambda now: now.tick >= paused.tick + 30)
    assert later.speed == 16.0
    assert accept(engine, step()).running is False


def test_the_hand_drives(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "HAND_EXPIRES_S", 1e9)
    engine = start()
    assert accept(engine, AHEAD).mode == "manual"
    now = accept(engine, step(20))
    assert now.doing == "driven by hand"
    start_at = OFFICE.starts[0]
    assert now.truth.x - start_at.x > 0.4
    assert now.truth.y == pytest.approx(start_at.y, abs=0.02)


def test_the_hand_expires(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "HAND_EXPIRES_S", 0.0)
    engine = start()
    accept(engine, AHEAD)
    now = accept(engine, step())
    while now.doing != "waiting for the hand":
        assert now.tick < 200
        now = accept(engine, step())
    assert now.mode == "manual"


def test_a_hand_that_expires_does_not_take_back_a_later_order(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "HAND_EXPIRES_S", 0.05)
    engine = start(running=True)
    accept(engine, AHEAD)
    accept(engine, m.SetMode(type="set_mode", mode="explore"))
    wait_for(engine, lambda _: not engine.pace.hand_holds)
    assert accept(engine, step(3)).mode == "explore"


@pytest.mark.slow
def test_snapshots_of_a_run_only_go_forwards(start: Start) -> None:
    engine, seen, version = start(running=True), [], 0
    parts = list(engine.session.stopwatch.parts)
    assert parts[-1] == SECOND  # there is no second brain
    for _ in range(12):
        version, now = engine.latest.wait(version, PATIENCE_S)
        assert now is not None
        seen.append((now.run, now.tick))
        assert len(now.map.ids) == len(now.times.seconds)
        assert [timing.part for timing in now.timings] == parts[:-1]
    assert seen == sorted(seen)
    assert seen[-1][1] > seen[0][1]
    assert np.isfinite([timing.mean_ms for timing in now.timings]).all()


# ---------------------------------------------------------------- faults


def throwing(error: BaseException) -> Callable[..., Any]:
    def thrown(*_: object, **__: object) -> Any:
        raise error

    return thrown


def test_a_fault_pauses_and_says_why(start: Start, capsys: pytest.CaptureFixture[str]) -> None:
    engine, words = start(), "RuntimeError: a wheel came off"
    accept(engine, step(10))
    engine.session.tick = throwing(RuntimeError("a wheel came off"))  # type: ignore[method-assign]
    now = accept(engine, step(5))
    assert (now.running, now.fault, now.tick) == (False, words, 10)
    assert [(e.kind, e.text) for e in now.events] == [("fault", words)]  # once
    assert "a wheel came off" in capsys.readouterr().err
    for command in (RESUME, step()):
        refused = refuse(engine, command)
        assert (refused.field, refused.value) == ("type", command.type)
        assert f"the session stopped at a fault ({words}); reset it" in refused.reason
    anew = accept(engine, RESET)
    assert (anew.fault, anew.run, anew.running) == (None, 2, True)


def test_whatever_a_tick_throws_is_a_fault(start: Start, subtests: pytest.Subtests) -> None:
    engine = start(running=True)
    faults = {
        "SystemExit": SystemExit(), "KeyboardInterrupt": KeyboardInterrupt(), "MemoryError: no room": MemoryError("no room"),
        "GeneratorExit": GeneratorExit(),
    }  # fmt: skip
    for words, error in faults.items():
        with subtests.test(msg=words):
            engine.session.tick = throwing(error)  # type: ignore[method-assign]
            now = wait_for(engine, lambda now: now.fault is not None)
            assert (now.running, now.fault, now.events[-1].kind) == (False, words, "fault")
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
    assert isinstance(do(engine, AHEAD), m.Accepted)
    assert wait_for(engine, lambda now: now.fault is not None).fault == "RuntimeError: no hand"
    assert accept(engine, RESET).fault is None


def test_an_order_that_breaks_is_answered_with_its_error(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    engine = start()
    monkeypatch.setattr(engine.session, "kidnap", throwing(RuntimeError("no teleporter")))
    with pytest.raises(RuntimeError, match="no teleporter"):
        do(engine, KIDNAP)
    assert accept(engine, step()).tick == 1  # the engine lives on
    monkeypatch.setattr(engine.session, "kidnap", throwing(SystemExit("bye")))  # which would end the thread
    with pytest.raises(SystemExit, match="bye"):
        do(engine, KIDNAP)
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
    session = a_session()
    require_finite(session)
    sound = session.estimate
    for spoilt, words in (
        ({"pose_map_robot": replace(sound.pose_map_robot, x=math.inf)}, "after tick 0: the robot's pose in the map"),
        ({"packet": replace(sound.packet, mass=math.nan)}, "the winning packet"),
    ):
        session.estimate = replace(sound, **spoilt)  # type: ignore[arg-type]
        with pytest.raises(FloatingPointError, match=f"not finite .*{words}"):
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
    assert engine.startup_error is not None
    assert "the robot cannot start at home" in engine.startup_error
    assert answer.reason == f"the engine could not begin: {engine.startup_error}"
    assert do(engine, m.ReadBrain()) == m.Refused("type", "ReadBrain", answer.reason)
    engine.stop()


def test_who_comes_at_the_end_is_answered_and_who_comes_after_it_is_told_so() -> None:
    engine = EngineThread(OFFICE, 5, Config(), running=False)
    engine.start()
    snapshot(engine)
    early = [engine.submit(step(1000)) for _ in range(3)]
    engine.stop()
    assert all(answer.done() for answer in early)
    late = engine.submit(step()).result(0)
    assert isinstance(late, m.Refused)
    assert "has ended" in late.reason


def test_an_answer_that_nobody_waits_for_harms_nobody(start: Start) -> None:
    engine = start()
    engine.submit(step(50)).cancel()
    assert accept(engine, step()).fault is None
