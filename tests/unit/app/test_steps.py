"""Long steps give way: commands are taken between two ticks, and a pause cancels the rest."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from app.engine_thread import EngineThread
from app.session import Session
from web import messages as m

from .engine_threads import OFFICE, PATIENCE_S, accept, do, snapshot, step

Start = Callable[..., EngineThread]
Answer = Future[m.Accepted | m.Refused]


def at_tick(engine: EngineThread, tick: int, command: m.Command) -> list[Answer]:
    """Have a command arrive while this tick is computed; returns its answer."""
    answers: list[Answer] = []
    plain = engine.session.tick

    def tick_and_order(recorder: Any = None) -> None:
        plain(recorder)
        if engine.session.tick_count == tick and not answers:
            answers.append(engine.submit(command))

    engine.session.tick = tick_and_order  # type: ignore[method-assign]
    return answers


def test_a_pause_ends_the_rest(start: Start) -> None:
    engine = start()
    paused = at_tick(engine, 5, m.Pause(type="pause"))
    assert do(engine, step(1000)) == m.Accepted(5)
    assert paused[0].result(PATIENCE_S) == m.Accepted(5)
    assert snapshot(engine).tick == 5
    assert accept(engine, step(2)).tick == 7


def test_a_command_comes_between_two_ticks_of_a_long_step(start: Start) -> None:
    engine = start()
    order = m.Kidnap(type="kidnap", x=7.0, y=7.4, heading_rad=1.0)
    kidnapped = at_tick(engine, 50, order)
    assert do(engine, step(100)) == m.Accepted(100)
    assert kidnapped[0].result(0) == m.Accepted(50)
    alone = Session(OFFICE, 5)
    for tick in range(100):
        if tick == 50:
            alone.kidnap(7.0, 7.4, 1.0)
        alone.tick()
    assert engine.session.state_hash() == alone.state_hash()


def test_another_step_comes_after_the_first(start: Start) -> None:
    engine = start()
    more = at_tick(engine, 3, step(4))
    assert do(engine, step(10)) == m.Accepted(10)
    assert more[0].result(PATIENCE_S) == m.Accepted(14)
    assert snapshot(engine).tick == 14


def test_a_reset_ends_the_rest(start: Start) -> None:
    engine = start()
    reset = at_tick(engine, 6, m.Reset(type="reset"))
    assert do(engine, step(1000)) == m.Accepted(6)
    assert reset[0].result(PATIENCE_S) == m.Accepted(0)
    now = snapshot(engine)
    assert (now.run, now.tick, now.running) == (2, 0, False)


def test_playing_on_ends_the_rest(start: Start) -> None:
    engine = start()
    resumed = at_tick(engine, 6, m.Resume(type="resume"))
    assert do(engine, step(1000)) == m.Accepted(6)
    assert resumed[0].result(PATIENCE_S) == m.Accepted(6)
    accept(engine, m.Pause(type="pause"))


def test_a_stage_that_is_walked_to_ends_the_rest(start: Start) -> None:
    engine = start()
    walked = at_tick(engine, 6, m.StepStage(type="step_stage"))
    assert do(engine, step(1000)) == m.Accepted(6)
    assert walked[0].result(PATIENCE_S) == m.Accepted(7)
    assert snapshot(engine).walk is not None


def test_a_long_step_is_seen_while_it_lasts(start: Start) -> None:
    engine = start()
    seen = []
    plain = engine.session.tick

    def tick_and_look(recorder: Any = None) -> None:
        plain(recorder)
        engine.pace._published = 0.0  # long ago
        seen.append(snapshot(engine).tick)

    engine.session.tick = tick_and_look  # type: ignore[method-assign]
    accept(engine, step(10))
    assert seen == list(range(10))
