"""Commands to the robot: goal, tags, mode, driving by hand, kidnapping. What to inspect and warnings, which change nothing
in it."""

from __future__ import annotations

from app.commands.outcome import Outcome
from app.engine.engine import Engine
from app.session_snapshot import take_session
from app.views import inspection
from web import messages as m


def set_goal(engine: Engine, command: m.SetGoal) -> Outcome:
    experience = engine.run.session.set_goal(command.x, command.y)
    engine.run.event_log.note("goal", f"to experience {experience}")


def tag(engine: Engine, command: m.Tag) -> Outcome:
    experience = engine.run.session.tag(command.name)
    engine.run.event_log.note("place", f"{command.name.strip()} is here, at experience {experience}")


def untag(engine: Engine, command: m.Untag) -> Outcome:
    engine.run.session.untag(command.name)


def go_to_tag(engine: Engine, command: m.GoToTag) -> Outcome:
    experience = engine.run.session.go_to_tag(command.name)
    engine.run.event_log.note("goal", f"to {command.name}, experience {experience}")


def cancel_goal(engine: Engine, _: m.CancelGoal) -> Outcome:
    engine.run.session.cancel_goal()


def set_mode(engine: Engine, command: m.SetMode) -> Outcome:
    engine.run.session.set_mode(command.mode)


def drive(engine: Engine, command: m.Drive) -> Outcome:
    engine.run.session.drive(command.speed, command.yaw_rate)
    engine.pace.drive()


def kidnap(engine: Engine, command: m.Kidnap) -> Outcome:
    engine.run.session.kidnap(command.x, command.y, command.heading_rad)
    engine.run.event_log.note("kidnap", "carried away without being told")


def inspect(engine: Engine, command: m.Inspect) -> Outcome:
    """Show this on every page from now on."""
    run = engine.shown
    try:
        inspection.inspect(run.session, run.visits, run.history.events.reasons, command)
    except ValueError as error:
        chosen = command.model_dump(exclude={"type"}, exclude_none=True)
        return m.Refused(", ".join(chosen) or "type", list(chosen.values()), str(error))
    run.snapshots.inspected = command
    return None


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
    return m.Accepted(session.tick_count, take_session(session) if session.source.worlds else None)


def warn(engine: Engine, request: m.Warn) -> Outcome:
    engine.run.event_log.note("warning", request.text)
