"""Commands that change the office while the robot drives, with undo and redo; and what the engine has to know of world files
that the server opens, saves, deletes and restores."""

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


def edit_world(engine: Engine, command: m.EditWorld) -> Outcome:
    session = engine.run.session
    radius, free_in = session.simulator.params.robot_radius_m, session.simulator.free_in
    steps = [step.model_dump(exclude_none=True) for step in command.steps]
    return _edited(engine, "steps", steps, lambda: engine.editor.edit(command, radius, session.edit_world, free_in))


def undo_edit(engine: Engine, command: m.UndoEdit) -> Outcome:
    return _edited(engine, "type", command.type, lambda: engine.editor.undo(engine.run.session.edit_world))


def redo_edit(engine: Engine, command: m.RedoEdit) -> Outcome:
    return _edited(engine, "type", command.type, lambda: engine.editor.redo(engine.run.session.edit_world))


def _edited(engine: Engine, field: str, value: object, edit: Callable[[], str]) -> Outcome:
    """edit: makes the edit and returns what was done, in words, for the event log."""
    engine.editor.follow(engine.run.session.simulator.world)
    return attempt(field, value, lambda: engine.run.event_log.note("office", edit()))


def read_world(engine: Engine, _: m.ReadWorld) -> Outcome:
    session = engine.run.session
    engine.editor.follow(session.simulator.world)
    return m.Accepted(session.tick_count, (engine.editor.world, engine.editor.edition))


def read_filed(engine: Engine, request: m.ReadFiled) -> Outcome:
    return m.Accepted(engine.run.session.tick_count, engine.library.filed(request.name))


def open_world(engine: Engine, request: m.OpenWorld) -> Outcome:
    """Begin a run in a world that was read from a file, or in a new one."""
    world = engine.library.named(request.world)
    session = engine.run.session
    try:
        new = engine.begin(world, session.seed, engine.next_config)
    except ValueError as error:
        return m.Refused("world", world.name, str(error))
    if not request.filed:
        engine.editor.unfiled(world.name)
    engine.library.add(world)
    new.snapshots.worlds = engine.library.titles
    return m.Accepted(0, world.name)


def world_saved(engine: Engine, request: m.WorldSaved) -> Outcome:
    """The current world has been written to a file."""
    session = engine.run.session
    engine.editor.named(request.was, request.world, session.edit_world)
    engine.library.saved(request.world)
    _list_anew(engine)
    return m.Accepted(session.tick_count, request.world.name)


def world_deleted(engine: Engine, request: m.WorldDeleted) -> Outcome:
    engine.editor.unfiled(request.name)
    engine.library.deleted(request.name, engine.world.name)
    _list_anew(engine)


def world_restored(engine: Engine, request: m.WorldRestored) -> Outcome:
    engine.editor.filed(request.name)
    engine.library.restored(request.name, request.title)
    _list_anew(engine)


def _list_anew(engine: Engine) -> None:
    engine.run.snapshots.worlds = engine.library.titles
