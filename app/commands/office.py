"""Commands that change the office while the robot drives, with undo and redo; and what the engine has to know of world files
that the server opens, saves, deletes and restores."""

from __future__ import annotations

from collections.abc import Callable

from app.commands.outcome import Outcome
from app.engine.engine import Engine
from sim2d import Box
from web import messages as m


def set_door(engine: Engine, command: m.SetDoor) -> Outcome:
    engine.run.session.set_door(command.name, command.open)
    engine.run.event_log.note("office", f"{command.name} {'opens' if command.open else 'shuts'}")


def set_lamp(engine: Engine, command: m.SetLamp) -> Outcome:
    engine.run.session.set_lamp(command.name, command.on)
    engine.run.event_log.note("office", f"{command.name} {'on' if command.on else 'off'}")


def put_box(engine: Engine, command: m.PutBox) -> Outcome:
    c = command
    engine.run.session.put_box(Box(c.name, c.x, c.y, c.width, c.depth, c.height, c.angle_rad))
    engine.run.event_log.note("office", f"{c.name} put down")


def remove_box(engine: Engine, command: m.RemoveBox) -> Outcome:
    engine.run.session.remove_box(command.name)
    engine.run.event_log.note("office", f"{command.name} taken away")


def edit_world(engine: Engine, command: m.EditWorld) -> Outcome:
    session = engine.run.session
    radius, free_in = session.simulator.params.robot_radius_m, session.simulator.free_in
    _edited(engine, lambda: engine.editor.edit(command, radius, session.edit_world, free_in))


def undo_edit(engine: Engine, _: m.UndoEdit) -> Outcome:
    _edited(engine, lambda: engine.editor.undo(engine.run.session.edit_world))


def redo_edit(engine: Engine, _: m.RedoEdit) -> Outcome:
    _edited(engine, lambda: engine.editor.redo(engine.run.session.edit_world))


def _edited(engine: Engine, edit: Callable[[], str]) -> None:
    """edit: makes the edit and returns what was done, in words, for the event log."""
    engine.editor.follow(engine.run.session.simulator.world)
    engine.run.event_log.note("office", edit())


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
