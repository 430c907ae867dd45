"""Editing the office while the robot drives, undo and redo."""

from __future__ import annotations

from collections.abc import Callable

from app.commands.outcome import Outcome, attempt
from app.engine.engine import Engine
from web import messages as m


def edit_world(engine: Engine, command: m.EditWorld) -> Outcome:
    session = engine.run.session
    radius, free_in = session.simulator.params.robot_radius_m, session.simulator.free_in
    steps = [step.model_dump(exclude_none=True) for step in command.steps]
    return _done(engine, "steps", steps, lambda: engine.editor.edit(command, radius, session.edit_world, free_in))


def undo_edit(engine: Engine, command: m.UndoEdit) -> Outcome:
    return _done(engine, "type", command.type, lambda: engine.editor.undo(engine.run.session.edit_world))


def redo_edit(engine: Engine, command: m.RedoEdit) -> Outcome:
    return _done(engine, "type", command.type, lambda: engine.editor.redo(engine.run.session.edit_world))


def _done(engine: Engine, field: str, value: object, edit: Callable[[], str]) -> Outcome:
    """edit: makes the edit and returns what was done, in words, for the event log."""
    engine.editor.follow(engine.run.session.simulator.world)
    return attempt(field, value, lambda: engine.run.event_log.note("office", edit()))
