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


def test_what_takes_the_run_elsewhere_ends_the_rest(start: Start) -> None:
    engine = start()
    for orders, command, after in (
        (1000, m.Pause(type="pause"), 6), (1000, m.StepStage(type="step_stage"), 7),
        (1000, m.Resume(type="resume"), 6), (10, step(4), 14), (1000, m.Reset(type="reset"), 0),
    ):  # fmt: skip
        accept(engine, m.Reset(type="reset"))
        order = at_tick(engine, 6, command)
        assert do(engine, step(orders)) == m.Accepted(10 if orders == 10 else 6), command
        assert order[0].result(PATIENCE_S) == m.Accepted(after), command
        now = snapshot(engine)
        if isinstance(command, m.Resume):
            accept(engine, m.Pause(type="pause"))
        else:
            assert (now.tick, now.running) == (after, False), command
            assert (now.walk is not None) is isinstance(command, m.StepStage)
    assert (now.run, accept(engine, step(2)).tick) == (7, 2)


def test_a_command_comes_between_two_ticks_of_a_long_step(start: Start) -> None:
    engine = start()
    kidnapped = at_tick(engine, 50, m.Kidnap(type="kidnap", x=7.0, y=7.4, heading_rad=1.0))
    assert do(engine, step(100)) == m.Accepted(100)
    assert kidnapped[0].result(0) == m.Accepted(50)
    alone = Session(OFFICE, 5)
    for tick in range(100):
        if tick == 50:
            alone.kidnap(7.0, 7.4, 1.0)
        alone.tick()
    assert engine.session.state_hash() == alone.state_hash()


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
