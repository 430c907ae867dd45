"""What the engine has to know of world files that the server opens, saves, deletes and restores."""

from __future__ import annotations

from app.commands.outcome import Outcome
from app.engine.engine import Engine
from web import messages as m


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
