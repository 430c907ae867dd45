"""Every command and request has one handler; and what commands do to a running engine and to what people look at."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import get_args, get_type_hints

import pytest

from app.commands import carry_out
from app.commands.outcome import Outcome
from app.commands.table import COMMANDS, REQUESTS
from app.engine_thread import EngineThread
from web import messages as m

from .engine_threads import accept, do, refuse, snapshot, step
from .engines import READER, an_engine, tell
from .sessions import OFFICE
from .worlds import room

Start = Callable[..., EngineThread]


# ------------------------------------------------------------ the table


def test_every_command_and_request_has_a_handler_of_its_own_class() -> None:
    union, *_ = get_args(m.Command)
    assert set(COMMANDS) == set(get_args(union))
    assert set(REQUESTS) == set(get_args(m.EngineRequest))
    handlers = COMMANDS | REQUESTS
    assert len(set(handlers.values())) == len(handlers)
    for kind, handler in handlers.items():
        hints = get_type_hints(handler)
        _, command = inspect.signature(handler).parameters
        assert (hints[command], hints["return"]) == (kind, Outcome)


def test_what_nobody_carries_out_is_an_error() -> None:
    class Dance:
        type = "dance"

    with pytest.raises(TypeError, match="nobody carries out dance"):
        carry_out(an_engine(OFFICE), Dance())  # type: ignore[arg-type]


REFUSED = [
    ({"type": "set_goal", "x": 99.0, "y": 0.0}, "x, y", (99.0, 0.0), "is off the map"),
    ({"type": "set_mode", "mode": "goal"}, "mode", "goal", "set one first"),
    ({"type": "kidnap", "x": 5.0, "y": 0.05}, "x, y", (5.0, 0.05), "the robot needs 0.22 m"),
    (
        {"type": "set_parameter", "name": "robot.light", "value": 99.0},
        "value",
        99.0,
        "must be between 0.1 and 2, got 99.0",
    ),
    ({"type": "set_parameter", "name": "robot.lights", "value": 1.0}, "name", "robot.lights", "one of: robot.light"),
    ({"type": "use_preset", "name": "none"}, "name", "none", "expected one of: ours"),
    ({"type": "set_door", "name": "none", "open": True}, "name", "none", "this world has no door"),
    ({"type": "inject_packet", "x": 9999, "y": 0}, "x, y", (9999, 0), "x from 0 to 63 and y from 0 to 63"),
    ({"type": "undo_edit"}, "type", "undo_edit", "there is nothing to undo"),
    ({"type": "inspect", "view": 99999}, "view", [99999], "view must be from 0 to 0"),
    ({"type": "inspect", "experience": 10**6}, "experience", [10**6], "experience must be from 0 to 0"),
    ({"type": "step_stage", "back": True}, "back", True, "there is no stage before this one; go forwards"),
    ({"type": "reset", "world": "castle"}, "world", "castle", "expected one of: office"),
]


def test_a_command_that_is_refused_changes_nothing_and_is_not_noted(subtests: pytest.Subtests) -> None:
    engine = an_engine(OFFICE)
    before, events = engine.run.session.state_hash(), engine.run.event_log.events
    for fields, field, value, reason in REFUSED:
        with subtests.test(msg=str(fields)):
            answer = carry_out(engine, READER.validate_python(fields))
            assert isinstance(answer, m.Refused)
            assert (answer.field, answer.value) == (field, value)
            assert reason in answer.reason
    assert engine.run.session.state_hash() == before
    assert engine.run.event_log.events == events
    assert engine.run.number == 1


def test_what_a_command_does_is_seen_and_noted() -> None:
    engine = an_engine(OFFICE)

    def seen(kind: str, **fields: object) -> m.Snapshot:
        tell(engine, type=kind, **fields)
        return engine.snapshot()

    def noted(now: m.Snapshot) -> tuple[str, str]:
        return now.events[-1].kind, now.events[-1].text

    for _ in range(80):
        engine.tick()
    now = seen("set_goal", x=0.0, y=0.0)
    assert now.goal is not None
    assert (now.mode, noted(now)) == ("goal", ("goal", f"to experience {now.goal.experience}"))
    now = seen("cancel_goal")
    assert (now.goal, now.mode) == (None, "explore")
    assert seen("set_mode", mode="manual").mode == "manual"
    now = seen("set_parameter", name="robot.light", value=0.6)
    assert {p.name: p.value for p in now.parameters}["robot.light"] == 0.6
    assert noted(now) == ("parameter", "robot.light = 0.6")
    assert noted(seen("inject_packet", x=5, y=6, heading_rad=1.0, share=0.4))[0] == "packet"
    engine.tick()
    assert len(engine.snapshot().pose_cells.packets) == 2
    now = seen("kidnap", x=7.0, y=7.4, heading_rad=1.0)
    assert (now.truth.x, now.truth.y, now.truth.heading_rad) == pytest.approx((7.0, 7.4, 1.0))
    assert noted(now)[0] == "kidnap"
    by_chance = seen("kidnap").truth
    assert (by_chance.x, by_chance.y) != (now.truth.x, now.truth.y)


# ------------------------------------------------------------ in the thread


def order(kind: str, **fields: object) -> m.Command:
    return READER.validate_python({"type": kind, **fields})


def test_reset(start: Start) -> None:
    engine = start()
    first = accept(engine, step(50))
    again = accept(engine, order("reset"))
    assert (again.run, again.tick, again.seed, again.world.name) == (2, 0, 5, "office")
    assert accept(engine, step(50)).truth == first.truth
    other_seed = accept(engine, order("reset", seed=6))
    assert (other_seed.run, other_seed.seed) == (3, 6)
    loop = accept(engine, order("reset", world="loop"))
    assert (loop.world.name, loop.seed) == ("loop", 6)
    assert accept(engine, order("reset", world="office")).world.name == "office"
    assert refuse(engine, order("reset", world="castle")).field == "world"
    now = accept(engine, order("set_parameter", name="pose_cells.n_x", value=32))
    assert now.events[-1].text == "pose_cells.n_x = 32, from the next reset on"
    assert (now.run, now.pose_cells.shape) == (5, (36, 64, 64))
    assert accept(engine, order("reset")).pose_cells.shape == (36, 64, 32)


def test_a_reset_that_cannot_be_is_refused_and_the_old_run_goes_on(start: Start) -> None:
    engine = start(world=room(start=(0.4, 2.0, 0.0)))
    assert snapshot(engine).worlds[-1] == ("room", "A room")
    accept(engine, order("reset", world="loop"))
    assert accept(engine, order("reset", world="room")).world.name == "room"  # one's own can be come back to
    accept(engine, step(5))
    accept(engine, order("kidnap", x=2.0, y=2.0))
    accept(engine, order("set_parameter", name="robot.robot_radius_m", value=0.5))
    refused = refuse(engine, order("reset"))
    assert (refused.field, refused.value) == ("world", "room")
    assert "the robot cannot start at home" in refused.reason
    now = accept(engine, step())
    assert (now.run, now.tick) == (3, 6)


def test_what_is_inspected_is_the_same_for_all_and_ends_with_the_run(start: Start) -> None:
    engine = start()
    accept(engine, step(20))
    now = accept(engine, order("inspect", experience=0))
    assert isinstance(now.inspected, m.ExperienceReport)
    assert now.inspected.id == 0
    assert isinstance(accept(engine, step()).inspected, m.ExperienceReport)
    assert isinstance(accept(engine, order("inspect", view=0)).inspected, m.ViewReport)
    assert isinstance(accept(engine, order("inspect", x=1, y=2)).inspected, m.CellReport)
    assert refuse(engine, order("inspect", experience=10**6)).field == "experience"
    assert isinstance(snapshot(engine).inspected, m.CellReport)  # as it was
    assert accept(engine, order("inspect")).inspected is None
    accept(engine, order("inspect", view=0))
    assert accept(engine, order("reset")).inspected is None


def test_a_question_is_answered_and_changes_nothing(start: Start) -> None:
    engine = start()
    accept(engine, step(5))
    before = engine.session.state_hash()
    answer = do(engine, m.ReadExperience(0))
    assert isinstance(answer, m.Accepted)
    assert isinstance(answer.result, m.ExperienceReport)
    assert isinstance(do(engine, m.ReadExperience(10**6)), m.Refused)
    assert engine.session.state_hash() == before


def walked(engine: EngineThread, *, back: bool = False) -> tuple[m.Snapshot, m.TickWalk]:
    now = accept(engine, order("step_stage", back=back))
    assert now.walk is not None
    return now, now.walk


def test_a_tick_is_walked_through_stage_by_stage(start: Start) -> None:
    engine = start(running=True, speed=1.0)
    now, walk = walked(engine)
    assert not now.running
    tick, stages = now.tick, len(walk.stages)
    for at in range(stages):
        assert (now.tick, walk.at) == (tick, at)
        if at < stages - 1:
            now, walk = walked(engine)
    assert now.pose_cells.packets == snapshot(engine).pose_cells.packets
    assert walked(engine, back=True)[1].at == stages - 2
    walked(engine)
    following, walk = walked(engine)
    assert (following.tick, walk.at) == (tick + 1, 0)
    assert refuse(engine, order("step_stage", back=True)).field == "back"
    assert accept(engine, step()).walk is None
    assert refuse(engine, order("step_stage", back=True)).reason == "there is no stage before this one; go forwards"


def test_a_fault_ends_the_walk(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    engine = start()

    def breaks(*_: object, **__: object) -> None:
        raise RuntimeError("broken")

    monkeypatch.setattr(engine.session.brain.experience_map, "correct", breaks)
    now = accept(engine, order("step_stage", back=False))
    assert (now.walk, now.fault) == (None, "RuntimeError: broken")
    assert refuse(engine, order("step_stage", back=False)).field == "type"
