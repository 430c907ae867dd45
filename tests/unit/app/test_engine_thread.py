"""The engine's thread: pace, driving by hand that expires, faults, snapshots."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from app.engine import pace
from app.engine_thread import EngineThread
from app.session import PARTS, SECOND
from web import messages as m

from .engine_threads import OFFICE, PATIENCE_S, accept, do, refuse, snapshot, step, wait_for


def test_what_only_reads_makes_no_snapshot(start: Callable[..., EngineThread]) -> None:
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


def test_the_first_snapshot_comes_before_anything_moves(start: Callable[..., EngineThread]) -> None:
    now = snapshot(start())
    assert (now.tick, now.run, now.running, now.seed, now.fault) == (0, 1, False, 5, None)
    assert now.speed == float("inf")
    assert ("office", OFFICE.title) in now.worlds


def test_steps_are_counted(start: Callable[..., EngineThread]) -> None:
    engine = start()
    assert accept(engine, step()).tick == 1
    assert accept(engine, step(7)).tick == 8
    now = accept(engine, step(100))
    assert now.tick == 108
    assert not now.running
    assert now.time_s == pytest.approx(10.8)


@pytest.mark.slow
def test_running_pauses_and_resumes_at_any_speed(start: Callable[..., EngineThread]) -> None:
    engine = start(running=True)
    wait_for(engine, lambda now: now.tick >= 30)
    paused = accept(engine, m.Pause(type="pause"))
    assert not paused.running
    tick = paused.tick
    assert do(engine, m.Pause(type="pause")) == m.Accepted(tick)
    assert accept(engine, m.SetSpeed(type="set_speed", factor=16.0)).speed == 16.0
    assert accept(engine, m.Resume(type="resume")).running
    later = wait_for(engine, lambda now: now.tick >= tick + 30)
    assert later.speed == 16.0
    assert accept(engine, step()).running is False


@pytest.mark.slow
def test_the_real_time_factor_is_measured(start: Callable[..., EngineThread]) -> None:
    engine = start(running=True)
    assert wait_for(engine, lambda now: now.real_time_factor > 0).tick > 0


def test_the_hand_drives(start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "HAND_EXPIRES_S", 1e9)
    engine = start()
    assert accept(engine, m.Drive(type="drive", speed=0.3, yaw_rate=0.0)).mode == "manual"
    now = accept(engine, step(20))
    assert now.doing == "driven by hand"
    start_at = OFFICE.starts[0]
    assert now.truth.x - start_at.x > 0.4
    assert now.truth.y == pytest.approx(start_at.y, abs=0.02)


def test_the_hand_expires(start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "HAND_EXPIRES_S", 0.0)
    engine = start()
    accept(engine, m.Drive(type="drive", speed=0.3, yaw_rate=0.0))
    now = accept(engine, step())
    while now.doing != "waiting for the hand":
        assert now.tick < 200
        now = accept(engine, step())
    assert now.mode == "manual"


def test_a_hand_that_expires_does_not_take_back_a_later_order(
    start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pace, "HAND_EXPIRES_S", 0.05)
    engine = start(running=True)
    accept(engine, m.Drive(type="drive", speed=0.3, yaw_rate=0.0))
    accept(engine, m.SetMode(type="set_mode", mode="explore"))
    wait_for(engine, lambda _: not engine.pace.hand_holds)
    now = accept(engine, step(3))
    assert now.mode == "explore"


def fail(*_: object) -> None:
    raise RuntimeError("a wheel came off")


def test_a_fault_pauses_and_says_why(start: Callable[..., EngineThread], capsys: pytest.CaptureFixture[str]) -> None:
    engine = start()
    accept(engine, step(10))
    engine.session.tick = fail  # type: ignore[method-assign]
    now = accept(engine, step(5))
    assert (now.running, now.fault, now.tick) == (False, "RuntimeError: a wheel came off", 10)
    assert [(e.kind, e.text) for e in now.events] == [("fault", "RuntimeError: a wheel came off")]  # once
    assert "a wheel came off" in capsys.readouterr().err
    for command in (m.Resume(type="resume"), step()):
        refused = refuse(engine, command)
        assert refused.field == "type"
        assert refused.value == command.type
        assert "the session stopped at a fault (RuntimeError: a wheel came off); reset it" in refused.reason
    anew = accept(engine, m.Reset(type="reset"))
    assert (anew.fault, anew.run, anew.running) == (None, 2, True)


def test_a_fault_while_running(start: Callable[..., EngineThread]) -> None:
    engine = start(running=True)
    wait_for(engine, lambda now: now.tick > 5)
    engine.session.tick = fail  # type: ignore[method-assign]
    now = wait_for(engine, lambda now: now.fault is not None)
    assert not now.running
    assert accept(engine, m.Reset(type="reset")).running


def test_an_order_that_breaks_is_answered_with_its_error(
    start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = start()

    def broken(*_: object) -> None:
        raise RuntimeError("no teleporter")

    monkeypatch.setattr(engine.session, "kidnap", broken)
    answer = engine.submit(m.Kidnap(type="kidnap"))
    with pytest.raises(RuntimeError, match="no teleporter"):
        answer.result(timeout=PATIENCE_S)
    assert accept(engine, step()).tick == 1  # the engine lives on


@pytest.mark.slow
def test_snapshots_of_a_run_only_go_forwards(start: Callable[..., EngineThread]) -> None:
    engine = start(running=True)
    seen = []
    version = 0
    for _ in range(12):
        version, now = engine.latest.wait(version, PATIENCE_S)
        assert now is not None
        seen.append((now.run, now.tick))
        assert len(now.map.ids) == len(now.times.seconds)
        assert [timing.part for timing in now.timings] == [part for part in PARTS if part != SECOND]
    assert seen == sorted(seen)
    assert seen[-1][1] > seen[0][1]
    assert np.isfinite([timing.mean_ms for timing in now.timings]).all()
