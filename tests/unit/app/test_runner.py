from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app import runner as runner_module
from app.config import Config
from app.runner import Runner
from app.session import PARTS, Session
from ratslam_core import RatSlam
from ratslam_core.brain_snapshot import restore_snapshot
from sim2d import SONAR_ANGLES_RAD, load_world, own_worlds, world_to_json
from web import messages as m

from .worlds import room

OFFICE = load_world("office")
PATIENCE_S = 60


class Watched(Runner):
    """Tells when the snapshot that follows an answer has been published."""

    def __init__(self, *args: object, **options: object) -> None:
        super().__init__(*args, **options)  # type: ignore[arg-type]
        self._round_ended = threading.Condition()
        self._rounds = self._answered_in = 0

    def _answer(self, command: m.Command) -> m.Accepted | m.Refused | Exception:
        self._answered_in = self._rounds
        return super()._answer(command)

    def _take_requests(self) -> None:
        super()._take_requests()
        with self._round_ended:
            self._rounds += 1
            self._round_ended.notify_all()

    def settle(self) -> None:
        with self._round_ended:
            assert self._round_ended.wait_for(lambda: self._rounds > self._answered_in, PATIENCE_S)


@pytest.fixture
def start() -> Iterator[Callable[..., Runner]]:
    """Runners that are stopped at the end; paused and as fast as possible unless told otherwise."""
    running: list[Runner] = []

    def begin(**options: object) -> Runner:
        world = options.pop("world", OFFICE)
        config = options.pop("config", Config())
        options = {"speed": 0.0, "running": False} | options
        made = Watched(world, 5, config, **options)
        made.start()
        running.append(made)
        snapshot(made)
        return made

    yield begin
    for made in running:
        made.stop()


def do(runner: Runner, command: m.Command) -> m.Accepted | m.Refused:
    answer = runner.submit(command).result(timeout=PATIENCE_S)
    if isinstance(runner, Watched):
        runner.settle()
    return answer


def accept(runner: Runner, command: m.Command) -> m.Snapshot:
    """Give a command that has to be accepted; the snapshot after it."""
    answer = do(runner, command)
    assert isinstance(answer, m.Accepted), answer
    return snapshot(runner)


def refuse(runner: Runner, command: m.Command) -> m.Refused:
    answer = do(runner, command)
    assert isinstance(answer, m.Refused), answer
    return answer


def snapshot(runner: Runner) -> m.Snapshot:
    version, now = runner.latest.wait(0, PATIENCE_S)
    assert version > 0
    assert now is not None
    return now


def wait_for(runner: Runner, condition: Callable[[m.Snapshot], bool]) -> m.Snapshot:
    version, now = runner.latest.get()
    while now is None or not condition(now):
        before = version
        version, now = runner.latest.wait(version, PATIENCE_S)
        assert version > before, "nothing new came"
    return now


def step(ticks: int = 1) -> m.Step:
    return m.Step(type="step", ticks=ticks)


# ---------------------------------------------------------------- pace


def test_the_first_snapshot_comes_before_anything_moves(start: Callable[..., Runner]) -> None:
    now = snapshot(start())
    assert (now.tick, now.run, now.running, now.seed, now.fault) == (0, 1, False, 5, None)
    assert now.speed == float("inf")
    assert ("office", OFFICE.title) in now.worlds


def test_steps_are_counted(start: Callable[..., Runner]) -> None:
    runner = start()
    assert accept(runner, step()).tick == 1
    assert accept(runner, step(7)).tick == 8
    now = accept(runner, step(100))
    assert now.tick == 108
    assert not now.running
    assert now.time_s == pytest.approx(10.8)


def test_stepping_is_the_same_as_the_session_alone(start: Callable[..., Runner]) -> None:
    runner = start()
    for ticks in (1, 30, 69):
        accept(runner, step(ticks))
    alone = Session(OFFICE, 5)
    for _ in range(100):
        alone.tick()
    assert runner.session.state_hash() == alone.state_hash()


def test_running_pauses_and_resumes_at_any_speed(start: Callable[..., Runner]) -> None:
    runner = start(running=True)
    wait_for(runner, lambda now: now.tick >= 30)
    paused = accept(runner, m.Pause(type="pause"))
    assert not paused.running
    tick = paused.tick
    assert do(runner, m.Pause(type="pause")) == m.Accepted(tick)
    assert accept(runner, m.SetSpeed(type="set_speed", factor=500.0)).speed == 500.0
    assert accept(runner, m.Resume(type="resume")).running
    later = wait_for(runner, lambda now: now.tick >= tick + 30)
    assert later.speed == 500.0
    assert accept(runner, step()).running is False
    alone = Session(OFFICE, 5)
    while alone.tick_count < runner.session.tick_count:
        alone.tick()
    assert runner.session.state_hash() == alone.state_hash()


def test_the_real_time_factor_is_measured(start: Callable[..., Runner]) -> None:
    runner = start(running=True)
    assert wait_for(runner, lambda now: now.real_time_factor > 0).tick > 0


# ---------------------------------------------------------------- the hand


def test_the_hand_drives(start: Callable[..., Runner], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner_module, "HAND_EXPIRES_S", 1e9)
    runner = start()
    assert accept(runner, m.Drive(type="drive", speed=0.3, yaw_rate=0.0)).mode == "manual"
    now = accept(runner, step(20))
    assert now.doing == "driven by hand"
    start_at = OFFICE.starts[0]
    assert now.truth.x - start_at.x > 0.4
    assert now.truth.y == pytest.approx(start_at.y, abs=0.02)


def test_the_hand_expires(start: Callable[..., Runner], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner_module, "HAND_EXPIRES_S", 0.0)
    runner = start()
    accept(runner, m.Drive(type="drive", speed=0.3, yaw_rate=0.0))
    now = accept(runner, step())
    while now.doing != "waiting for the hand":
        assert now.tick < 200
        now = accept(runner, step())
    assert now.mode == "manual"


def test_a_hand_that_expires_does_not_take_back_a_later_order(
    start: Callable[..., Runner], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner_module, "HAND_EXPIRES_S", 0.05)
    runner = start(running=True)
    accept(runner, m.Drive(type="drive", speed=0.3, yaw_rate=0.0))
    accept(runner, m.SetMode(type="set_mode", mode="explore"))
    wait_for(runner, lambda _: runner._hand_expires == float("inf"))
    now = accept(runner, step(3))
    assert now.mode == "explore"


# ---------------------------------------------------------------- orders and refusals


def test_goals(start: Callable[..., Runner]) -> None:
    runner = start()
    accept(runner, step(80))
    now = accept(runner, m.SetGoal(type="set_goal", x=0.0, y=0.0))
    assert now.goal is not None
    assert now.mode == "goal"
    assert now.events[-1].kind == "goal"
    assert now.events[-1].text == f"to experience {now.goal.experience}"
    refused = refuse(runner, m.SetGoal(type="set_goal", x=55.0, y=0.0))
    assert (refused.field, refused.value) == ("x, y", (55.0, 0.0))
    assert "is off the map" in refused.reason
    now = accept(runner, m.CancelGoal(type="cancel_goal"))
    assert (now.goal, now.mode) == (None, "explore")
    refused = refuse(runner, m.SetMode(type="set_mode", mode="goal"))
    assert (refused.field, refused.value) == ("mode", "goal")
    assert "set one first" in refused.reason
    assert accept(runner, m.SetMode(type="set_mode", mode="manual")).mode == "manual"


def test_kidnaps(start: Callable[..., Runner]) -> None:
    runner = start()
    now = accept(runner, m.Kidnap(type="kidnap", x=7.0, y=7.4, heading_rad=1.0))
    assert (now.truth.x, now.truth.y, now.truth.heading_rad) == pytest.approx((7.0, 7.4, 1.0))
    assert now.events[-1].kind == "kidnap"
    refused = refuse(runner, m.Kidnap(type="kidnap", x=5.0, y=0.05))
    assert (refused.field, refused.value) == ("x, y", (5.0, 0.05))
    assert "the robot needs" in refused.reason
    assert [event.kind for event in snapshot(runner).events] == ["kidnap"]
    by_chance = accept(runner, m.Kidnap(type="kidnap"))
    assert (by_chance.truth.x, by_chance.truth.y) != (now.truth.x, now.truth.y)


def test_parameters(start: Callable[..., Runner]) -> None:
    runner = start()

    def value(now: m.Snapshot, name: str) -> object:
        return {p.name: p.value for p in now.parameters}[name]

    def change(name: str, new: object) -> m.Command:
        return m.SetParameter(type="set_parameter", name=name, value=new)  # type: ignore[arg-type]

    now = accept(runner, change("robot.light", 0.6))
    assert value(now, "robot.light") == 0.6
    assert (now.events[-1].kind, now.events[-1].text) == ("parameter", "robot.light = 0.6")
    now = accept(runner, change("pose_cells.n_x", 32))
    assert now.events[-1].text == "pose_cells.n_x = 32, from the next reset on"
    assert now.pose_cells.shape == (36, 64, 64)
    refused = refuse(runner, change("robot.light", 5.0))
    assert (refused.field, refused.value) == ("value", 5.0)
    assert refused.reason == "robot.light must be from 0.1 to 2, got 5.0"
    refused = refuse(runner, change("robot.lights", 1.0))
    assert (refused.field, refused.value) == ("name", "robot.lights")
    assert "robot.light" in refused.reason
    now = accept(runner, m.Reset(type="reset"))
    assert now.pose_cells.shape == (36, 64, 32)
    assert value(now, "robot.light") == 0.6


# ---------------------------------------------------------------- reset and faults


def test_reset(start: Callable[..., Runner]) -> None:
    runner = start()
    first = accept(runner, step(50))
    again = accept(runner, m.Reset(type="reset"))
    assert (again.run, again.tick, again.seed, again.world.name) == (2, 0, 5, "office")
    assert accept(runner, step(50)).truth == first.truth
    other_seed = accept(runner, m.Reset(type="reset", seed=6))
    assert (other_seed.run, other_seed.seed) == (3, 6)
    loop = accept(runner, m.Reset(type="reset", world="loop"))
    assert (loop.world.name, loop.seed) == ("loop", 6)
    assert accept(runner, m.Reset(type="reset", world="office")).world.name == "office"
    refused = refuse(runner, m.Reset(type="reset", world="castle"))
    assert (refused.field, refused.value) == ("world", "castle")
    assert "expected one of: office" in refused.reason
    assert snapshot(runner).run == 5


def test_a_world_of_ones_own_can_be_come_back_to(start: Callable[..., Runner]) -> None:
    runner = start(world=room(start=(2.0, 2.0, 0.0)))
    assert snapshot(runner).worlds[-1] == ("room", "A room")
    accept(runner, m.Reset(type="reset", world="loop"))
    assert accept(runner, m.Reset(type="reset", world="room")).world.name == "room"


def test_a_reset_that_cannot_be_is_refused_and_the_old_run_goes_on(start: Callable[..., Runner]) -> None:
    runner = start(world=room(start=(0.4, 2.0, 0.0)))
    accept(runner, step(5))
    accept(runner, m.Kidnap(type="kidnap", x=2.0, y=2.0))
    accept(runner, m.SetParameter(type="set_parameter", name="robot.robot_radius_m", value=0.5))
    refused = refuse(runner, m.Reset(type="reset"))
    assert (refused.field, refused.value) == ("world", "room")
    assert "the robot cannot start at home" in refused.reason
    now = accept(runner, step())
    assert (now.run, now.tick) == (1, 6)


def fail(*_: object) -> None:
    raise RuntimeError("a wheel came off")


def test_a_fault_pauses_and_says_why(start: Callable[..., Runner], capsys: pytest.CaptureFixture[str]) -> None:
    runner = start()
    accept(runner, step(10))
    runner.session.tick = fail  # type: ignore[method-assign]
    now = accept(runner, step(5))
    assert (now.running, now.fault, now.tick) == (False, "RuntimeError: a wheel came off", 10)
    assert [(e.kind, e.text) for e in now.events] == [("fault", "RuntimeError: a wheel came off")]  # once
    assert "a wheel came off" in capsys.readouterr().err
    for command in (m.Resume(type="resume"), step()):
        refused = refuse(runner, command)
        assert refused.field == "type"
        assert refused.value == command.type
        assert "the session stopped at a fault (RuntimeError: a wheel came off); reset it" in refused.reason
    anew = accept(runner, m.Reset(type="reset"))
    assert (anew.fault, anew.run, anew.running) == (None, 2, True)


def test_a_fault_while_running(start: Callable[..., Runner]) -> None:
    runner = start(running=True)
    wait_for(runner, lambda now: now.tick > 5)
    runner.session.tick = fail  # type: ignore[method-assign]
    now = wait_for(runner, lambda now: now.fault is not None)
    assert not now.running
    assert accept(runner, m.Reset(type="reset")).running


def test_an_order_that_breaks_is_answered_with_its_error(
    start: Callable[..., Runner], monkeypatch: pytest.MonkeyPatch
) -> None:
    runner = start()

    def broken(*_: object) -> None:
        raise RuntimeError("no teleporter")

    monkeypatch.setattr(runner.session, "kidnap", broken)
    answer = runner.submit(m.Kidnap(type="kidnap"))
    with pytest.raises(RuntimeError, match="no teleporter"):
        answer.result(timeout=PATIENCE_S)
    assert accept(runner, step()).tick == 1  # the engine lives on


def test_stopping_ends_a_long_step() -> None:
    runner = Runner(OFFICE, 5, Config(), running=False)
    runner.start()
    snapshot(runner)
    answer = runner.submit(step(1000))
    wait_for_step = runner.submit(step(1000))
    runner.stop()
    assert not runner._thread.is_alive()
    assert answer.done() or wait_for_step.done() or runner.session.tick_count < 2000


def test_snapshots_of_a_run_only_go_forwards(start: Callable[..., Runner]) -> None:
    runner = start(running=True)
    seen = []
    version = 0
    for _ in range(12):
        version, now = runner.latest.wait(version, PATIENCE_S)
        assert now is not None
        seen.append((now.run, now.tick))
        assert len(now.map.ids) == len(now.times.seconds)
        assert [timing.part for timing in now.timings] == list(PARTS)
    assert seen == sorted(seen)
    assert seen[-1][1] > seen[0][1]
    assert np.isfinite([timing.mean_ms for timing in now.timings]).all()


def test_what_is_inspected_is_the_same_for_all_and_ends_with_the_run(start: Callable[..., Runner]) -> None:
    runner = start()
    accept(runner, step(20))
    now = accept(runner, m.Inspect(type="inspect", experience=0))
    assert isinstance(now.inspected, m.ExperienceReport)
    assert now.inspected.id == 0
    later = accept(runner, step())
    assert isinstance(later.inspected, m.ExperienceReport)
    assert isinstance(accept(runner, m.Inspect(type="inspect", view=0)).inspected, m.ViewReport)
    assert isinstance(accept(runner, m.Inspect(type="inspect", x=1, y=2)).inspected, m.CellReport)
    refused = refuse(runner, m.Inspect(type="inspect", experience=10**6))
    assert (refused.field, refused.value) == ("experience", [10**6])
    assert isinstance(snapshot(runner).inspected, m.CellReport)  # as it was
    assert accept(runner, m.Inspect(type="inspect")).inspected is None
    accept(runner, m.Inspect(type="inspect", view=0))
    assert accept(runner, m.Reset(type="reset")).inspected is None


def test_a_question_is_answered_and_changes_nothing(start: Callable[..., Runner]) -> None:
    runner = start()
    accept(runner, step(5))
    before = runner.session.state_hash()
    answer = do(runner, m.ReadExperience(0))
    assert isinstance(answer, m.Accepted)
    assert isinstance(answer.result, m.ExperienceReport)
    assert isinstance(do(runner, m.ReadExperience(10**6)), m.Refused)
    assert runner.session.state_hash() == before


def stage(*, back: bool = False) -> m.StepStage:
    return m.StepStage(type="step_stage", back=back)


def test_a_tick_is_walked_through_stage_by_stage(start: Callable[..., Runner]) -> None:
    runner, plain = start(running=True, speed=1.0), start()
    now = accept(runner, stage())
    assert not now.running
    tick = now.tick
    assert now.walk is not None
    names = [shown.name for shown in now.walk.stages]
    seen = [now.walk.at]
    for _ in names[1:]:
        now = accept(runner, stage())
        assert now.walk is not None
        assert now.tick == tick
        seen.append(now.walk.at)
    assert seen == list(range(len(names)))
    assert now.pose_cells.packets == snapshot(runner).pose_cells.packets
    back = accept(runner, stage(back=True)).walk
    assert back is not None
    assert back.at == len(names) - 2
    accept(runner, stage())
    following = accept(runner, stage())
    assert following.tick == tick + 1
    assert following.walk is not None
    assert following.walk.at == 0
    assert refuse(runner, stage(back=True)).field == "back"
    accept(plain, step(tick + 1))
    assert runner.session.state_hash() == plain.session.state_hash()
    assert accept(runner, step()).walk is None
    assert refuse(runner, stage(back=True)).reason == "there is no stage before this one; go forwards"


def test_a_fault_ends_the_walk(start: Callable[..., Runner], monkeypatch: pytest.MonkeyPatch) -> None:
    runner = start()

    def breaks(*_: object, **__: object) -> None:
        raise RuntimeError("broken")

    monkeypatch.setattr(runner.session.brain.experience_map, "correct", breaks)
    now = accept(runner, stage())
    assert now.walk is None
    assert now.fault == "RuntimeError: broken"
    assert refuse(runner, stage()).field == "type"


def test_a_brain_is_read_and_used_again(start: Callable[..., Runner]) -> None:
    runner = start()
    accept(runner, step(100))
    answer = do(runner, m.ReadBrain())
    assert isinstance(answer, m.Accepted)
    brain = restore_snapshot(answer.result)  # type: ignore[arg-type]
    known = len(brain.experience_map)
    accept(runner, step(50))
    before = snapshot(runner)
    assert isinstance(do(runner, m.UseBrain(brain)), m.Accepted)
    now = snapshot(runner)
    assert (now.run, now.tick, now.world.name) == (before.run + 1, 0, before.world.name)
    assert now.experiences >= known
    assert now.events[-1].text == f"woke up with {now.experiences} experiences"
    assert accept(runner, step(20)).tick == 20


@pytest.mark.parametrize("why", ["no sonars", "other", "broken"])
def test_a_brain_that_cannot_be_used_leaves_the_session_as_it_is(start: Callable[..., Runner], why: str) -> None:
    runner = start()
    accept(runner, step(30))
    before, run = runner.session.state_hash(), snapshot(runner).run
    brain: object = "no brain"
    if why != "other":
        brain = RatSlam()
    if why == "broken":
        brain = runner.session.brain.__class__(sonar_angles_rad=SONAR_ANGLES_RAD)
        brain.experience_map.transitions = None  # type: ignore[assignment]
    answer = do(runner, m.UseBrain(brain))
    assert isinstance(answer, m.Refused)
    assert answer.field == "brain"
    assert "this brain cannot be used here" in answer.reason
    assert (runner.session.state_hash(), snapshot(runner).run) == (before, run)
    assert accept(runner, step(5)).tick == 35


def test_a_packet_is_injected_and_noted(start: Callable[..., Runner]) -> None:
    runner = start()
    accept(runner, step(30))
    now = accept(runner, m.InjectPacket(type="inject_packet", x=5, y=6, heading_rad=1.0, share=0.4))
    assert now.events[-1].kind == "packet"
    assert len(accept(runner, step()).pose_cells.packets) == 2
    assert refuse(runner, m.InjectPacket(type="inject_packet", x=99, y=6)).value == (99, 6)


def wall_order() -> m.EditWorld:
    step = {"do": "add", "list": "walls", "item": {"from": [0.5, 0.5], "to": [1.5, 0.5]}}
    return m.EditWorld.model_validate({"type": "edit_world", "steps": [step]})


def test_an_edit_is_a_command_on_a_tick_and_outlives_a_reset(start: Callable[..., Runner]) -> None:
    runner = start(world=room(start=(2.0, 2.0, 0.0)))
    before = snapshot(runner)
    assert do(runner, m.Step(type="step", ticks=3)).tick == 3
    assert do(runner, wall_order()).tick == 3
    after = snapshot(runner)
    assert len(after.world.walls) == len(before.world.walls) + 1
    assert (after.office.undo, after.office.saved) == ("wall drawn", False)
    assert after.office.number > before.office.number
    do(runner, m.Reset(type="reset"))
    assert len(snapshot(runner).world.walls) == 5
    do(runner, m.UndoEdit(type="undo_edit"))
    assert (len(snapshot(runner).world.walls), snapshot(runner).office.redo) == (4, "wall drawn")
    do(runner, m.RedoEdit(type="redo_edit"))
    assert len(snapshot(runner).world.walls) == 5
    assert do(runner, m.RedoEdit(type="redo_edit")) == m.Refused("type", "redo_edit", "there is nothing to redo")


def test_a_refused_edit_says_why_and_the_robot_drives_on(start: Callable[..., Runner]) -> None:
    runner = start(world=room(start=(2.0, 2.0, 0.0)))
    across = {"do": "add", "list": "walls", "item": {"from": [1.0, 2.0], "to": [3.0, 2.0]}}
    refused = do(runner, m.EditWorld.model_validate({"type": "edit_world", "steps": [across]}))
    assert refused.field == "steps"
    assert "home" in refused.reason
    assert do(runner, m.Step(type="step")).tick == 1


def test_an_opened_world_is_begun_and_listed_and_names_are_not_taken_twice(start: Callable[..., Runner]) -> None:
    plan = room(start=(2.0, 2.0, 0.0))
    runner = start()
    assert do(runner, m.OpenWorld(plan)).result == "room"
    opened = snapshot(runner)
    assert (opened.world.name, opened.tick, opened.office.saved) == ("room", 0, True)
    assert ("room", "A room") in opened.worlds
    assert do(runner, m.OpenWorld(plan)).result == "room"  # the same again
    assert do(runner, m.OpenWorld(room((1.0, 1.0, 1.5, 1.0), start=(2.0, 2.0, 0.0)))).result == "room-2"
    do(runner, m.Reset(type="reset", world="room"))
    assert len(snapshot(runner).world.walls) == 4


def test_a_world_that_cannot_be_begun_leaves_the_session_alone(start: Callable[..., Runner]) -> None:
    runner = start(world=room(start=(2.0, 2.0, 0.0)))
    do(runner, m.Step(type="step", ticks=2))
    refused = do(runner, m.OpenWorld(room(start=(0.1, 0.1, 0.0))))
    assert (refused.field, "cannot start" in refused.reason) == ("world", True)
    after = snapshot(runner)
    assert (after.tick, after.world.name, len(after.worlds)) == (2, "room", len(dict(after.worlds)))


def test_a_saved_world_bears_its_name(start: Callable[..., Runner]) -> None:
    runner = start(world=room(start=(2.0, 2.0, 0.0)))
    do(runner, wall_order())
    world, edition = do(runner, m.ReadWorld()).result
    assert edition == snapshot(runner).office
    do(runner, m.WorldSaved(world, replace(world, name="mine", title="Mine")))
    after = snapshot(runner)
    assert (after.world.name, after.office.saved, after.tick) == ("mine", True, 0)
    assert ("mine", "Mine") in after.worlds
    assert len(after.world.walls) == 5


def test_a_world_in_no_file_counts_as_unsaved(start: Callable[..., Runner]) -> None:
    runner = start()
    assert do(runner, m.OpenWorld(room(start=(2.0, 2.0, 0.0)), filed=False)).result == "room"
    assert not snapshot(runner).office.saved
    assert accept(runner, m.Reset(type="reset", world="office")).office.saved
    assert not accept(runner, m.Reset(type="reset", world="room")).office.saved  # come back to
    world, _ = do(runner, m.ReadWorld()).result
    do(runner, m.WorldSaved(world, world))
    assert snapshot(runner).office.saved


def test_a_deleted_world_goes_on_until_another_is_opened(
    start: Callable[..., Runner], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    mine = room(start=(2.0, 2.0, 0.0))
    for name in ("mine", "other"):
        own_worlds.save(name, world_to_json(replace(mine, name=name)))
    runner = start()
    do(runner, m.Reset(type="reset", world="mine"))
    own_worlds.delete("other")
    do(runner, m.WorldDeleted("other"))
    assert "other" not in dict(snapshot(runner).worlds)
    assert snapshot(runner).office.saved
    own_worlds.delete("mine")
    do(runner, m.WorldDeleted("mine"))
    now = snapshot(runner)
    assert (now.world.name, now.office.saved, "mine" in dict(now.worlds)) == ("mine", False, True)
    assert accept(runner, m.Reset(type="reset")).world.name == "mine"
    assert "mine" not in dict(accept(runner, m.Reset(type="reset", world="loop")).worlds)
    assert refuse(runner, m.Reset(type="reset", world="mine")).field == "world"
    own_worlds.restore("mine")
    do(runner, m.WorldRestored("mine", "A room"))
    back = accept(runner, m.Reset(type="reset", world="mine"))
    assert (back.world.name, back.office.saved) == ("mine", True)
    do(runner, m.WorldDeleted("mine"))
    do(runner, m.WorldRestored("mine", "A room"))
    assert snapshot(runner).office.saved


def test_a_saved_world_that_is_spoilt_is_refused(
    start: Callable[..., Runner], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RATSLAM_WORLDS", str(tmp_path))
    (tmp_path / "bad.json").write_text("{}")
    runner = start(world=room(start=(2.0, 2.0, 0.0)))
    assert ("bad", "bad (cannot be read)") in snapshot(runner).worlds
    refused = do(runner, m.Reset(type="reset", world="bad"))
    assert (refused.field, refused.value) == ("world", "bad")
    assert "bad.json" in refused.reason
