"""Commands that change the office: doors, lamps, boxes."""

from __future__ import annotations

from collections.abc import Callable

from app.commands.outcome import Outcome, attempt
from app.engine.engine import Engine
from sim2d import Box
from web import messages as m


def set_door(engine: Engine, command: m.SetDoor) -> Outcome:
    session = engine.run.session
    words = "opens" if command.open else "shuts"
    return _done(engine, command.name, words, lambda: session.set_door(command.name, command.open))


def set_lamp(engine: Engine, command: m.SetLamp) -> Outcome:
    session = engine.run.session
    words = "on" if command.on else "off"
    return _done(engine, command.name, words, lambda: session.set_lamp(command.name, command.on))


def put_box(engine: Engine, command: m.PutBox) -> Outcome:
    session, c = engine.run.session, command
    box = Box(c.name, c.x, c.y, c.width, c.depth, c.height, c.angle_rad)
    return _done(engine, command.name, "put down", lambda: session.put_box(box))


def remove_box(engine: Engine, command: m.RemoveBox) -> Outcome:
    session = engine.run.session
    return _done(engine, command.name, "taken away", lambda: session.remove_box(command.name))


def _done(engine: Engine, name: str, words: str, order: Callable[[], None]) -> Outcome:
    def do() -> None:
        order()
        engine.run.event_log.note("office", f"{name} {words}")

    return attempt("name", name, do)
