"""Choosing what to inspect, and warnings to the page. Nothing here changes the robot."""

from __future__ import annotations

from app.commands.outcome import Outcome, attempt
from app.engine.engine import Engine
from app.session_snapshot import take_session
from app.views import inspection
from web import messages as m


def inspect(engine: Engine, command: m.Inspect) -> Outcome:
    """Show this on every page from now on."""
    run = engine.shown
    chosen = command.model_dump(exclude={"type"}, exclude_none=True)

    def choose() -> None:
        inspection.inspect(run.session, run.visits, run.history.events.reasons, command)
        run.snapshots.inspected = command

    return attempt(", ".join(chosen) or "type", list(chosen.values()), choose)


def read_experience(engine: Engine, request: m.ReadExperience) -> Outcome:
    run = engine.shown
    try:
        report = inspection.experience_report(run.session, run.visits, request.experience)
    except ValueError as error:
        return m.Refused("experience", request.experience, str(error))
    return m.Accepted(run.session.tick_count, report)


def read_session(engine: Engine, _: m.ReadSession) -> Outcome:
    """The whole state; None of a recording's, which cannot be told from the state alone."""
    session = engine.run.session
    return m.Accepted(session.tick_count, None if session.recording is not None else take_session(session))


def warn(engine: Engine, request: m.Warn) -> Outcome:
    engine.run.event_log.note("warning", request.text)
