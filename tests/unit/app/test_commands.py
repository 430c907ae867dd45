"""Every command and every request of the server has exactly one handler, and one table says which."""

from __future__ import annotations

import inspect
from typing import get_args, get_type_hints

import pytest

from app.commands import carry_out
from app.commands.outcome import Outcome
from app.commands.table import COMMANDS, REQUESTS
from web import messages as m

from .engines import an_engine, tell
from .sessions import OFFICE


def told() -> set[type]:
    """The classes of all commands."""
    union, *_ = get_args(m.Command)
    return set(get_args(union))


def test_every_command_and_request_has_a_handler_and_no_handler_is_idle() -> None:
    assert set(COMMANDS) == told()
    assert set(REQUESTS) == set(get_args(m.EngineRequest))
    handlers = [*COMMANDS.values(), *REQUESTS.values()]
    assert len(set(handlers)) == len(handlers)


def test_a_handler_is_of_the_class_that_it_stands_beside(subtests: pytest.Subtests) -> None:
    for kind in [*COMMANDS, *REQUESTS]:
        with subtests.test(kind=kind):
            handler = (COMMANDS | REQUESTS)[kind]
            hints = get_type_hints(handler)
            _, command = inspect.signature(handler).parameters
            assert hints[command] is kind
            assert hints["return"] == Outcome


def test_what_nobody_carries_out_is_an_error() -> None:
    class Dance:
        type = "dance"

    with pytest.raises(TypeError, match="nobody carries out dance"):
        carry_out(an_engine(OFFICE), Dance())  # type: ignore[arg-type]


def test_a_command_that_is_refused_changes_nothing_and_is_not_noted() -> None:
    engine = an_engine(OFFICE)
    before, events = engine.run.session.state_hash(), engine.run.event_log.events
    for fields in (
        {"type": "set_goal", "x": 99.0, "y": 0.0},
        {"type": "set_mode", "mode": "goal"},
        {"type": "kidnap", "x": 0.0, "y": 0.0},
        {"type": "set_parameter", "name": "robot.light", "value": 99.0},
        {"type": "use_preset", "name": "none"},
        {"type": "set_door", "name": "none", "open": True},
        {"type": "inject_packet", "x": 9999, "y": 0},
        {"type": "undo_edit"},
        {"type": "inspect", "view": 99999},
        {"type": "step_stage", "back": True},
        {"type": "reset", "world": "castle"},
    ):
        with pytest.raises(ValueError, match=r"\w+ \w+"):
            tell(engine, **fields)
    assert engine.run.session.state_hash() == before
    assert engine.run.event_log.events == events
    assert engine.run.number == 1
