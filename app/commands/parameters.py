"""Parameters, one by one or as a preset."""

from __future__ import annotations

from app.commands.outcome import Outcome, attempt
from app.config.presets import values_of
from app.engine.engine import Engine
from web import messages as m


def set_parameter(engine: Engine, command: m.SetParameter) -> Outcome:
    session, name, value = engine.run.session, command.name, command.value
    try:
        live = session.set_parameter(name, value)
    except ValueError as error:
        known = any(name == dotted for dotted, _, _ in session.config.items())
        field, wrong = ("value", value) if known else ("name", name)
        return m.Refused(field, wrong, str(error))
    engine.run.event_log.note("parameter", f"{name} = {value}" + ("" if live else ", from the next reset on"))
    return None


def use_preset(engine: Engine, command: m.UsePreset) -> Outcome:
    def use() -> None:
        waiting = engine.run.session.set_parameters(values_of(command.name))
        later = f"; from the next reset on: {', '.join(waiting)}" if waiting else ""
        engine.run.event_log.note("office", f"preset {command.name}{later}")

    return attempt("name", command.name, use)
