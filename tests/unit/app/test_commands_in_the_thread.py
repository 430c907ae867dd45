"""Commands to the robot and to what people look at, given to a running engine."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from app.engine_thread import EngineThread
from web import messages as m

from .engine_threads import accept, do, refuse, snapshot, step
from .worlds import room

# ---------------------------------------------------------------- pace


def test_goals(start: Callable[..., EngineThread]) -> None:
    engine = start()
    accept(engine, step(80))
    now = accept(engine, m.SetGoal(type="set_goal", x=0.0, y=0.0))
    assert now.goal is not None
    assert now.mode == "goal"
    assert now.events[-1].kind == "goal"
    assert now.events[-1].text == f"to experience {now.goal.experience}"
    refused = refuse(engine, m.SetGoal(type="set_goal", x=55.0, y=0.0))
    assert (refused.field, refused.value) == ("x, y", (55.0, 0.0))
    assert "is off the map" in refused.reason
    now = accept(engine, m.CancelGoal(type="cancel_goal"))
    assert (now.goal, now.mode) == (None, "explore")
    refused = refuse(engine, m.SetMode(type="set_mode", mode="goal"))
    assert (refused.field, refused.value) == ("mode", "goal")
    assert "set one first" in refused.reason
    assert accept(engine, m.SetMode(type="set_mode", mode="manual")).mode == "manual"


def test_kidnaps(start: Callable[..., EngineThread]) -> None:
    engine = start()
    now = accept(engine, m.Kidnap(type="kidnap", x=7.0, y=7.4, heading_rad=1.0))
    assert (now.truth.x, now.truth.y, now.truth.heading_rad) == pytest.approx((7.0, 7.4, 1.0))
    assert now.events[-1].kind == "kidnap"
    refused = refuse(engine, m.Kidnap(type="kidnap", x=5.0, y=0.05))
    assert (refused.field, refused.value) == ("x, y", (5.0, 0.05))
    assert "the robot needs" in refused.reason
    assert [event.kind for event in snapshot(engine).events] == ["kidnap"]
    by_chance = accept(engine, m.Kidnap(type="kidnap"))
    assert (by_chance.truth.x, by_chance.truth.y) != (now.truth.x, now.truth.y)


def test_parameters(start: Callable[..., EngineThread]) -> None:
    engine = start()

    def value(now: m.Snapshot, name: str) -> object:
        return {p.name: p.value for p in now.parameters}[name]

    def change(name: str, new: object) -> m.Command:
        return m.SetParameter(type="set_parameter", name=name, value=new)  # type: ignore[arg-type]

    now = accept(engine, change("robot.light", 0.6))
    assert value(now, "robot.light") == 0.6
    assert (now.events[-1].kind, now.events[-1].text) == ("parameter", "robot.light = 0.6")
    now = accept(engine, change("pose_cells.n_x", 32))
    assert now.events[-1].text == "pose_cells.n_x = 32, from the next reset on"
    assert now.pose_cells.shape == (36, 64, 64)
    refused = refuse(engine, change("robot.light", 5.0))
    assert (refused.field, refused.value) == ("value", 5.0)
    assert refused.reason == "robot.light must be from 0.1 to 2, got 5.0"
    refused = refuse(engine, change("robot.lights", 1.0))
    assert (refused.field, refused.value) == ("name", "robot.lights")
    assert "robot.light" in refused.reason
    now = accept(engine, m.Reset(type="reset"))
    assert now.pose_cells.shape == (36, 64, 32)
    assert value(now, "robot.light") == 0.6


def test_reset(start: Callable[..., EngineThread]) -> None:
    engine = start()
    first = accept(engine, step(50))
    again = accept(engine, m.Reset(type="reset"))
    assert (again.run, again.tick, again.seed, again.world.name) == (2, 0, 5, "office")
    assert accept(engine, step(50)).truth == first.truth
    other_seed = accept(engine, m.Reset(type="reset", seed=6))
    assert (other_seed.run, other_seed.seed) == (3, 6)
    loop = accept(engine, m.Reset(type="reset", world="loop"))
    assert (loop.world.name, loop.seed) == ("loop", 6)
    assert accept(engine, m.Reset(type="reset", world="office")).world.name == "office"
    refused = refuse(engine, m.Reset(type="reset", world="castle"))
    assert (refused.field, refused.value) == ("world", "castle")
    assert "expected one of: office" in refused.reason
    assert snapshot(engine).run == 5


def test_a_world_of_ones_own_can_be_come_back_to(start: Callable[..., EngineThread]) -> None:
    engine = start(world=room(start=(2.0, 2.0, 0.0)))
    assert snapshot(engine).worlds[-1] == ("room", "A room")
    accept(engine, m.Reset(type="reset", world="loop"))
    assert accept(engine, m.Reset(type="reset", world="room")).world.name == "room"


def test_a_reset_that_cannot_be_is_refused_and_the_old_run_goes_on(start: Callable[..., EngineThread]) -> None:
    engine = start(world=room(start=(0.4, 2.0, 0.0)))
    accept(engine, step(5))
    accept(engine, m.Kidnap(type="kidnap", x=2.0, y=2.0))
    accept(engine, m.SetParameter(type="set_parameter", name="robot.robot_radius_m", value=0.5))
    refused = refuse(engine, m.Reset(type="reset"))
    assert (refused.field, refused.value) == ("world", "room")
    assert "the robot cannot start at home" in refused.reason
    now = accept(engine, step())
    assert (now.run, now.tick) == (1, 6)


def test_what_is_inspected_is_the_same_for_all_and_ends_with_the_run(start: Callable[..., EngineThread]) -> None:
    engine = start()
    accept(engine, step(20))
    now = accept(engine, m.Inspect(type="inspect", experience=0))
    assert isinstance(now.inspected, m.ExperienceReport)
    assert now.inspected.id == 0
    later = accept(engine, step())
    assert isinstance(later.inspected, m.ExperienceReport)
    assert isinstance(accept(engine, m.Inspect(type="inspect", view=0)).inspected, m.ViewReport)
    assert isinstance(accept(engine, m.Inspect(type="inspect", x=1, y=2)).inspected, m.CellReport)
    refused = refuse(engine, m.Inspect(type="inspect", experience=10**6))
    assert (refused.field, refused.value) == ("experience", [10**6])
    assert isinstance(snapshot(engine).inspected, m.CellReport)  # as it was
    assert accept(engine, m.Inspect(type="inspect")).inspected is None
    accept(engine, m.Inspect(type="inspect", view=0))
    assert accept(engine, m.Reset(type="reset")).inspected is None


def test_a_question_is_answered_and_changes_nothing(start: Callable[..., EngineThread]) -> None:
    engine = start()
    accept(engine, step(5))
    before = engine.session.state_hash()
    answer = do(engine, m.ReadExperience(0))
    assert isinstance(answer, m.Accepted)
    assert isinstance(answer.result, m.ExperienceReport)
    assert isinstance(do(engine, m.ReadExperience(10**6)), m.Refused)
    assert engine.session.state_hash() == before


def stage(*, back: bool = False) -> m.StepStage:
    return m.StepStage(type="step_stage", back=back)


def test_a_tick_is_walked_through_stage_by_stage(start: Callable[..., EngineThread]) -> None:
    engine = start(running=True, speed=1.0)
    now = accept(engine, stage())
    assert not now.running
    tick = now.tick
    assert now.walk is not None
    names = [shown.name for shown in now.walk.stages]
    seen = [now.walk.at]
    for _ in names[1:]:
        now = accept(engine, stage())
        assert now.walk is not None
        assert now.tick == tick
        seen.append(now.walk.at)
    assert seen == list(range(len(names)))
    assert now.pose_cells.packets == snapshot(engine).pose_cells.packets
    back = accept(engine, stage(back=True)).walk
    assert back is not None
    assert back.at == len(names) - 2
    accept(engine, stage())
    following = accept(engine, stage())
    assert following.tick == tick + 1
    assert following.walk is not None
    assert following.walk.at == 0
    assert refuse(engine, stage(back=True)).field == "back"
    assert accept(engine, step()).walk is None
    assert refuse(engine, stage(back=True)).reason == "there is no stage before this one; go forwards"


def test_a_fault_ends_the_walk(start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch) -> None:
    engine = start()

    def breaks(*_: object, **__: object) -> None:
        raise RuntimeError("broken")

    monkeypatch.setattr(engine.session.brain.experience_map, "correct", breaks)
    now = accept(engine, stage())
    assert now.walk is None
    assert now.fault == "RuntimeError: broken"
    assert refuse(engine, stage()).field == "type"


def test_a_packet_is_injected_and_noted(start: Callable[..., EngineThread]) -> None:
    engine = start()
    accept(engine, step(30))
    now = accept(engine, m.InjectPacket(type="inject_packet", x=5, y=6, heading_rad=1.0, share=0.4))
    assert now.events[-1].kind == "packet"
    assert len(accept(engine, step()).pose_cells.packets) == 2
    assert refuse(engine, m.InjectPacket(type="inject_packet", x=99, y=6)).value == (99, 6)
