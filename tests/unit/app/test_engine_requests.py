"""Brains and worlds read from and given to a running engine, and edits of the office."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from app.engine_thread import EngineThread
from disk import copy_state, encode
from ratslam_core import RatSlam, restore_snapshot
from sim2d import SONAR_ANGLES_RAD, load_world, own_worlds, world_to_json
from web import messages as m

from .engine_threads import OFFICE, accept, do, refuse, snapshot, step
from .worlds import room

# ---------------------------------------------------------------- pace


def test_a_brain_is_read_and_used_again(start: Callable[..., EngineThread]) -> None:
    engine = start()
    accept(engine, step(100))
    answer = do(engine, m.ReadBrain())
    assert isinstance(answer, m.Accepted)
    brain = restore_snapshot(encode(answer.result))  # type: ignore[arg-type]
    known = len(brain.experience_map)
    accept(engine, step(50))
    before = snapshot(engine)
    assert isinstance(do(engine, m.UseBrain(brain)), m.Accepted)
    now = snapshot(engine)
    assert (now.run, now.tick, now.world.name) == (before.run + 1, 0, before.world.name)
    assert now.experiences >= known
    assert now.events[-1].text == f"woke up with {now.experiences} experiences"
    assert accept(engine, step(20)).tick == 20


def test_a_brain_wakes_up_in_another_world_with_its_seed(
    start: Callable[..., EngineThread], monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = start()
    brain = do(engine, m.ReadBrain()).result  # type: ignore[union-attr]
    loop = load_world("loop")

    def disk(_: str) -> None:
        raise AssertionError("the engine reads no file for this")

    monkeypatch.setattr("app.engine.library.load_world", disk)
    assert isinstance(do(engine, m.UseBrain(brain, loop, 77)), m.Accepted)
    now = snapshot(engine)
    assert (now.world.name, now.seed, now.tick, now.running) == ("loop", 77, 0, False)
    assert do(engine, m.ReadFiled("loop")).result is loop  # type: ignore[union-attr]
    assert isinstance(do(engine, m.UseBrain(copy_state(brain), replace(loop, title="older"), 78)), m.Accepted)
    assert engine.session.world is loop  # as it is in this session
    assert snapshot(engine).seed == 78


@pytest.mark.parametrize("why", ["no sonars", "other", "broken"])
def test_a_brain_that_cannot_be_used_leaves_the_session_as_it_is(start: Callable[..., EngineThread], why: str) -> None:
    engine = start()
    accept(engine, step(30))
    before, run = engine.session.state_hash(), snapshot(engine).run
    brain: object = "no brain"
    if why != "other":
        brain = RatSlam()
    if why == "broken":
        brain = engine.session.brain.__class__(sonar_angles_rad=SONAR_ANGLES_RAD)
        brain.experience_map.transitions = None  # type: ignore[assignment]
    answer = do(engine, m.UseBrain(brain))
    assert isinstance(answer, m.Refused)
    assert answer.field == "brain"
    assert "this brain cannot be used here" in answer.reason
    assert (engine.session.state_hash(), snapshot(engine).run) == (before, run)
    assert accept(engine, step(5)).tick == 35


def wall_order() -> m.EditWorld:
    step = {"do": "add", "list": "walls", "item": {"from": [0.5, 0.5], "to": [1.5, 0.5]}}
    return m.EditWorld.model_validate({"type": "edit_world", "steps": [step]})


def test_an_edit_is_a_command_on_a_tick_and_outlives_a_reset(start: Callable[..., EngineThread]) -> None:
    engine = start(world=room(start=(2.0, 2.0, 0.0)))
    before = snapshot(engine)
    assert do(engine, m.Step(type="step", ticks=3)).tick == 3
    assert do(engine, wall_order()).tick == 3
    after = snapshot(engine)
    assert len(after.world.walls) == len(before.world.walls) + 1
    assert (after.office.undo, after.office.saved) == ("wall drawn", False)
    assert after.office.number > before.office.number
    do(engine, m.Reset(type="reset"))
    assert len(snapshot(engine).world.walls) == 5
    do(engine, m.UndoEdit(type="undo_edit"))
    assert (len(snapshot(engine).world.walls), snapshot(engine).office.redo) == (4, "wall drawn")
    do(engine, m.RedoEdit(type="redo_edit"))
    assert len(snapshot(engine).world.walls) == 5
    assert do(engine, m.RedoEdit(type="redo_edit")) == m.Refused("type", "redo_edit", "there is nothing to redo")


def test_a_refused_edit_says_why_and_the_robot_drives_on(start: Callable[..., EngineThread]) -> None:
    engine = start(world=room(start=(2.0, 2.0, 0.0)))
    across = {"do": "add", "list": "walls", "item": {"from": [1.0, 2.0], "to": [3.0, 2.0]}}
    refused = do(engine, m.EditWorld.model_validate({"type": "edit_world", "steps": [across]}))
    assert refused.field == "steps"
    assert "home" in refused.reason
    assert do(engine, m.Step(type="step")).tick == 1


def test_an_opened_world_is_begun_and_listed_and_names_are_not_taken_twice(start: Callable[..., EngineThread]) -> None:
    plan = room(start=(2.0, 2.0, 0.0))
    engine = start()
    assert do(engine, m.OpenWorld(plan)).result == "room"
    opened = snapshot(engine)
    assert (opened.world.name, opened.tick, opened.office.saved) == ("room", 0, True)
    assert ("room", "A room") in opened.worlds
    assert do(engine, m.OpenWorld(plan)).result == "room"  # the same again
    assert do(engine, m.OpenWorld(room((1.0, 1.0, 1.5, 1.0), start=(2.0, 2.0, 0.0)))).result == "room-2"
    do(engine, m.Reset(type="reset", world="room"))
    assert len(snapshot(engine).world.walls) == 4


def test_a_world_that_cannot_be_begun_leaves_the_session_alone(start: Callable[..., EngineThread]) -> None:
    engine = start(world=room(start=(2.0, 2.0, 0.0)))
    do(engine, m.Step(type="step", ticks=2))
    refused = do(engine, m.OpenWorld(room(start=(0.1, 0.1, 0.0))))
    assert (refused.field, "cannot start" in refused.reason) == ("world", True)
    after = snapshot(engine)
    assert (after.tick, after.world.name, len(after.worlds)) == (2, "room", len(dict(after.worlds)))


def test_a_saved_world_bears_its_name(start: Callable[..., EngineThread]) -> None:
    engine = start(world=room(start=(2.0, 2.0, 0.0)))
    do(engine, wall_order())
    world, edition = do(engine, m.ReadWorld()).result
    assert edition == snapshot(engine).office
    do(engine, m.WorldSaved(world, replace(world, name="mine", title="Mine")))
    after = snapshot(engine)
    assert (after.world.name, after.office.saved, after.tick) == ("mine", True, 0)
    assert ("mine", "Mine") in after.worlds
    assert len(after.world.walls) == 5


def test_a_world_in_no_file_counts_as_unsaved(start: Callable[..., EngineThread]) -> None:
    engine = start()
    assert do(engine, m.OpenWorld(room(start=(2.0, 2.0, 0.0)), filed=False)).result == "room"
    assert not snapshot(engine).office.saved
    assert accept(engine, m.Reset(type="reset", world="office")).office.saved
    assert not accept(engine, m.Reset(type="reset", world="room")).office.saved  # come back to
    world, _ = do(engine, m.ReadWorld()).result
    do(engine, m.WorldSaved(world, world))
    assert snapshot(engine).office.saved


def test_a_deleted_world_goes_on_until_another_is_opened(
    start: Callable[..., EngineThread], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    mine = room(start=(2.0, 2.0, 0.0))
    for name in ("mine", "other"):
        own_worlds.save(name, world_to_json(replace(mine, name=name)))
    engine = start()
    do(engine, m.Reset(type="reset", world="mine"))
    own_worlds.delete("other")
    do(engine, m.WorldDeleted("other"))
    assert "other" not in dict(snapshot(engine).worlds)
    assert snapshot(engine).office.saved
    own_worlds.delete("mine")
    do(engine, m.WorldDeleted("mine"))
    now = snapshot(engine)
    assert (now.world.name, now.office.saved, "mine" in dict(now.worlds)) == ("mine", False, True)
    assert accept(engine, m.Reset(type="reset")).world.name == "mine"
    assert "mine" not in dict(accept(engine, m.Reset(type="reset", world="loop")).worlds)
    assert refuse(engine, m.Reset(type="reset", world="mine")).field == "world"
    own_worlds.restore("mine")
    do(engine, m.WorldRestored("mine", "A room"))
    back = accept(engine, m.Reset(type="reset", world="mine"))
    assert (back.world.name, back.office.saved) == ("mine", True)
    do(engine, m.WorldDeleted("mine"))
    do(engine, m.WorldRestored("mine", "A room"))
    assert snapshot(engine).office.saved


def test_a_world_whose_file_came_while_the_program_ran_is_opened_by_its_name(
    start: Callable[..., EngineThread], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    engine = start()
    own_worlds.save("late", world_to_json(replace(room(start=(2.0, 2.0, 0.0)), name="late")))
    opened = accept(engine, m.Reset(type="reset", world="late"))
    assert (opened.world.name, "late" in dict(opened.worlds)) == ("late", True)


def test_a_saved_world_that_is_spoilt_is_refused(
    start: Callable[..., EngineThread], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    (tmp_path / "bad.json").write_text("{}")
    engine = start(world=room(start=(2.0, 2.0, 0.0)))
    assert ("bad", "bad (cannot be read)") in snapshot(engine).worlds
    refused = do(engine, m.Reset(type="reset", world="bad"))
    assert (refused.field, refused.value) == ("world", "bad")
    assert "bad.json" in refused.reason


def test_the_engine_knows_what_it_read_from_a_file_or_wrote(
    start: Callable[..., EngineThread], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    mine = replace(room(start=(2.0, 2.0, 0.0)), name="mine")
    own_worlds.save("mine", world_to_json(mine))
    engine = start()
    filed = lambda name: do(engine, m.ReadFiled(name)).result  # noqa: E731
    assert (filed("office"), filed("mine")) == (OFFICE, None)
    do(engine, m.Reset(type="reset", world="mine"))
    assert filed("mine") == mine
    step = m.EditStep(list="places", do="add", item={"name": "here", "x": 1.0, "y": 1.0})
    opened = do(engine, m.OpenWorld(replace(mine, name="plan"))).result
    assert filed(opened) is None  # it has no file here
    do(engine, m.Reset(type="reset", world="mine"))
    written, _ = do(engine, m.ReadWorld()).result
    accept(engine, m.EditWorld(type="edit_world", steps=[step]))  # while it was written
    do(engine, m.WorldSaved(written, written))
    assert filed("mine") == mine
