"""An engine without a thread: what commands do to it."""

from __future__ import annotations

from pydantic import TypeAdapter

from app.commands import carry_out
from app.config import Config
from app.engine.engine import Engine
from app.engine.pace import Pace
from app.engine.watchdog import Watchdog
from app.run_record.writer import RunKeeper
from sim2d import World
from web import messages as m

READER: TypeAdapter[m.Command] = TypeAdapter(m.Command)


def not_begun(world: World, keeper: RunKeeper | None = None) -> Engine:
    return Engine(world, Pace(0.0), Watchdog(1e9, lambda: None), running=False, answer=lambda *_: None, keeper=keeper)


def an_engine(world: World, seed: int = 3, config: Config | None = None, keeper: RunKeeper | None = None) -> Engine:
    engine = not_begun(world, keeper)
    engine.begin(world, seed, config or Config())
    return engine


def run_for(engine: Engine, ticks: int) -> None:
    for _ in range(ticks):
        engine.tick()


def of_kind(engine: Engine, kind: str) -> list[m.Event]:
    return [event for event in engine.run.event_log.events if event.kind == kind]


def tell(engine: Engine, /, **fields: object) -> str:
    """Give a command; returns the words on the timeline. ValueError when it is refused."""
    outcome = carry_out(engine, READER.validate_python(fields))
    if isinstance(outcome, m.Refused):
        raise ValueError(outcome.reason)
    events = engine.run.event_log.events
    return events[-1].text if events else ""
