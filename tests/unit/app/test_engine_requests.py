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

Start = Callable[..., EngineThread]
MIDDLE = room(start=(2.0, 2.0, 0.0))


def reset(world: str | None = None) -> m.Reset:
    return m.Reset(type="reset", world=world)


def keep(name: str) -> None:
    own_worlds.save(name, world_to_json(replace(MIDDLE, name=name)))


def wall_order(*ends: list[float]) -> m.EditWorld:
    wall = {"do": "add", "list": "walls", "item": {"from": ends[0], "to": ends[1]}}
    return m.EditWorld.model_validate({"type": "edit_world", "steps": [wall]})


DRAWS = wall_order([0.5, 0.5], [1.5, 0.5])


@pytest.fixture(autouse=True)
def worlds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the worlds of this test are kept."""
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    return tmp_path


# ------------------------------------------------------------ brains


def test_a_brain_is_read_and_used_again(start: Start) -> None:
    engine = start()
    accept(engine, step(100))
    brain = restore_snapshot(encode(do(engine, m.ReadBrain()).result))  # type: ignore[union-attr, arg-type]
    known = len(brain.experience_map)
    accept(engine, step(50))
    before = snapshot(engine)
    assert isinstance(do(engine, m.UseBrain(brain)), m.Accepted)
    now = snapshot(engine)
    assert (now.run, now.tick, now.world.name) == (before.run + 1, 0, before.world.name)
    assert now.experiences >= known
    assert now.events[-1].text == f"woke up with {now.experiences} experiences"
    assert accept(engine, step(20)).tick == 20


def test_a_brain_wakes_up_in_another_world_with_its_seed(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    engine, loop = start(), load_world("loop")
    brain = do(engine, m.ReadBrain()).result  # type: ignore[union-attr]
    monkeypatch.setattr("app.engine.library.load_world", lambda _: pytest.fail("the engine reads no file for this"))
    assert isinstance(do(engine, m.UseBrain(brain, loop, 77)), m.Accepted)
    now = snapshot(engine)
    assert (now.world.name, now.seed, now.tick, now.running) == ("loop", 77, 0, False)
    assert do(engine, m.ReadFiled("loop")).result is loop  # type: ignore[union-attr]
    assert isinstance(do(engine, m.UseBrain(copy_state(brain), replace(loop, title="older"), 78)), m.Accepted)
    assert engine.session.world is loop  # as it is in this session
    assert snapshot(engine).seed == 78


def test_a_brain_that_cannot_be_used_leaves_the_session_as_it_is(start: Start, subtests: pytest.Subtests) -> None:
    engine = start()
    accept(engine, step(30))
    before, run = engine.session.state_hash(), snapshot(engine).run
    broken = RatSlam(sonar_angles_rad=SONAR_ANGLES_RAD)
    broken.experience_map.transitions = None  # type: ignore[assignment]
    for why, brain in {"no sonars": RatSlam(), "other": "no brain", "broken": broken}.items():
        with subtests.test(msg=why):
            answer = do(engine, m.UseBrain(brain))
            assert isinstance(answer, m.Refused)
            assert (answer.field, "this brain cannot be used here" in answer.reason) == ("brain", True)
            assert (engine.session.state_hash(), snapshot(engine).run) == (before, run)
    assert accept(engine, step(5)).tick == 35


# ------------------------------------------------------------ worlds


def test_an_edit_is_a_command_on_a_tick_and_outlives_a_reset(start: Start) -> None:
    engine = start(world=MIDDLE)
    before = snapshot(engine)
    assert do(engine, step(3)).tick == 3
    assert do(engine, DRAWS).tick == 3
    after = snapshot(engine)
    assert len(after.world.walls) == len(before.world.walls) + 1
    assert (after.office.undo, after.office.saved) == ("wall drawn", False)
    assert after.office.number > before.office.number
    do(engine, reset())
    assert len(snapshot(engine).world.walls) == 5
    do(engine, m.UndoEdit(type="undo_edit"))
    assert (len(snapshot(engine).world.walls), snapshot(engine).office.redo) == (4, "wall drawn")
    do(engine, m.RedoEdit(type="redo_edit"))
    assert len(snapshot(engine).world.walls) == 5
    assert do(engine, m.RedoEdit(type="redo_edit")) == m.Refused("type", "redo_edit", "there is nothing to redo")


def test_a_refused_edit_or_world_says_why_and_the_robot_drives_on(start: Start) -> None:
    engine = start(world=MIDDLE)
    do(engine, step(2))
    refused = do(engine, wall_order([1.0, 2.0], [3.0, 2.0]))
    assert (refused.field, "home" in refused.reason) == ("steps", True)
    refused = do(engine, m.OpenWorld(room(start=(0.1, 0.1, 0.0))))
    assert (refused.field, "cannot start" in refused.reason) == ("world", True)
    after = snapshot(engine)
    assert (after.tick, after.world.name, len(after.worlds)) == (2, "room", len(dict(after.worlds)))
    assert do(engine, step()).tick == 3


def test_an_opened_world_is_begun_and_listed_and_names_are_not_taken_twice(start: Start) -> None:
    engine = start()
    assert do(engine, m.OpenWorld(MIDDLE)).result == "room"
    opened = snapshot(engine)
    assert (opened.world.name, opened.tick, opened.office.saved) == ("room", 0, True)
    assert ("room", "A room") in opened.worlds
    assert do(engine, m.OpenWorld(MIDDLE)).result == "room"  # the same again
    assert do(engine, m.OpenWorld(room((1.0, 1.0, 1.5, 1.0), start=(2.0, 2.0, 0.0)))).result == "room-2"
    do(engine, reset("room"))
    assert len(snapshot(engine).world.walls) == 4


def test_a_saved_world_bears_its_name(start: Start) -> None:
    engine = start(world=MIDDLE)
    do(engine, DRAWS)
    world, edition = do(engine, m.ReadWorld()).result
    assert edition == snapshot(engine).office
    do(engine, m.WorldSaved(world, replace(world, name="mine", title="Mine")))
    after = snapshot(engine)
    assert (after.world.name, after.office.saved, after.tick) == ("mine", True, 0)
    assert ("mine", "Mine") in after.worlds
    assert len(after.world.walls) == 5


def test_a_world_in_no_file_counts_as_unsaved(start: Start) -> None:
    engine = start()
    assert do(engine, m.OpenWorld(MIDDLE, filed=False)).result == "room"
    assert not snapshot(engine).office.saved
    assert accept(engine, reset("office")).office.saved
    assert not accept(engine, reset("room")).office.saved  # come back to
    world, _ = do(engine, m.ReadWorld()).result
    do(engine, m.WorldSaved(world, world))
    assert snapshot(engine).office.saved


def test_a_deleted_world_goes_on_until_another_is_opened(start: Start) -> None:
    keep("mine")
    keep("other")
    engine = start()
    do(engine, reset("mine"))
    own_worlds.delete("other")
    do(engine, m.WorldDeleted("other"))
    assert "other" not in dict(snapshot(engine).worlds)
    assert snapshot(engine).office.saved
    own_worlds.delete("mine")
    do(engine, m.WorldDeleted("mine"))
    now = snapshot(engine)
    assert (now.world.name, now.office.saved, "mine" in dict(now.worlds)) == ("mine", False, True)
    assert accept(engine, reset()).world.name == "mine"
    assert "mine" not in dict(accept(engine, reset("loop")).worlds)
    assert refuse(engine, reset("mine")).field == "world"
    own_worlds.restore("mine")
    do(engine, m.WorldRestored("mine", "A room"))
    back = accept(engine, reset("mine"))
    assert (back.world.name, back.office.saved) == ("mine", True)
    do(engine, m.WorldDeleted("mine"))
    do(engine, m.WorldRestored("mine", "A room"))
    assert snapshot(engine).office.saved


def test_a_file_that_came_while_the_program_ran_is_opened_and_a_spoilt_one_refused(start: Start, worlds: Path) -> None:
    (worlds / "bad.json").write_text("{}")
    engine = start(world=MIDDLE)
    assert ("bad", "bad (cannot be read)") in snapshot(engine).worlds
    refused = do(engine, reset("bad"))
    assert (refused.field, refused.value, "bad.json" in refused.reason) == ("world", "bad", True)
    keep("late")
    opened = accept(engine, reset("late"))
    assert (opened.world.name, "late" in dict(opened.worlds)) == ("late", True)


def test_the_engine_knows_what_it_read_from_a_file_or_wrote(start: Start) -> None:
    keep("mine")
    engine, mine = start(), replace(MIDDLE, name="mine")
    filed = lambda name: do(engine, m.ReadFiled(name)).result  # noqa: E731
    assert (filed("office"), filed("mine")) == (OFFICE, None)
    do(engine, reset("mine"))
    assert filed("mine") == mine
    opened = do(engine, m.OpenWorld(replace(mine, name="plan"))).result
    assert filed(opened) is None  # it has no file here
    do(engine, reset("mine"))
    written, _ = do(engine, m.ReadWorld()).result
    accept(engine, DRAWS)  # while it was written
    do(engine, m.WorldSaved(written, written))
    assert filed("mine") == mine
