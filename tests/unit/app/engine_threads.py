"""An engine in its own thread, and what a person would do with it."""

from __future__ import annotations

from collections.abc import Callable

from app.engine_thread import EngineThread
from sim2d import load_world
from tests.patience import PATIENCE_S
from web import messages as m

OFFICE = load_world("office")


def do(engine: EngineThread, command: m.Command | m.EngineRequest) -> m.Accepted | m.Refused:
    return engine.submit(command).result(timeout=PATIENCE_S)


def accept(engine: EngineThread, command: m.Command) -> m.Snapshot:
    """Give a command that must be accepted; returns the snapshot after it."""
    answer = do(engine, command)
    assert isinstance(answer, m.Accepted), answer
    return snapshot(engine)


def refuse(engine: EngineThread, command: m.Command) -> m.Refused:
    answer = do(engine, command)
    assert isinstance(answer, m.Refused), answer
    return answer


def snapshot(engine: EngineThread) -> m.Snapshot:
    version, now = engine.latest.wait(0, PATIENCE_S)
    assert version > 0
    assert now is not None
    return now


def wait_for(engine: EngineThread, condition: Callable[[m.Snapshot], bool]) -> m.Snapshot:
    version, now = engine.latest.get()
    while now is None or not condition(now):
        before = version
        version, now = engine.latest.wait(version, PATIENCE_S)
        assert version > before, "nothing new came"
    return now


def step(ticks: int = 1) -> m.Step:
    return m.Step(type="step", ticks=ticks)
