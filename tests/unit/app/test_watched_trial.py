"""A trial in the engine: it is the trial by itself, bit for bit, it ends as it should, and a command begins it."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from app.commands import carry_out
from app.commands.table import COMMANDS
from app.engine.engine import Engine
from app.engine_thread import EngineThread
from app.protocol.experiment import find_experiment
from app.protocol.trial import Trial, run_trial
from web import messages as m

from .engine_threads import accept, refuse, snapshot, wait_for
from .engines import an_engine, tell
from .sessions import OFFICE
from .trials_to_watch import short_trial, table_trial

pytestmark = pytest.mark.slow
Start = Callable[..., EngineThread]


def watching(trial: Trial, moment_s: float | None = None) -> Engine:
    engine = an_engine(OFFICE)
    engine.begin_trial(trial, "A title", moment_s)
    return engine


def watch(engine: Engine, experiment: str = "table", /, **fields: object) -> str:
    """Give the command; returns the words on the timeline."""
    return tell(engine, type="watch_experiment", experiment=experiment, **fields)


def an_order(**fields: object) -> m.WatchExperiment:
    return m.WatchExperiment.model_validate({"type": "watch_experiment", "experiment": "table", **fields})


def shown(now: m.Snapshot) -> m.TrialView:
    assert now.trial is not None
    return now.trial


def play(engine: Engine, most: int = 2000) -> str:
    """Run ticks, as the engine's thread does, until it pauses; returns what the session is then."""
    while engine.running and most > 0:
        engine.tick()
        most -= 1
    return engine.run.session.state_hash()


def events(engine: Engine, *kinds: str) -> list[m.Event]:
    return [event for event in engine.run.event_log.events if event.kind in kinds]


@pytest.fixture(scope="module")
def table_hash() -> str:
    return run_trial(table_trial())[0].state_hash


def test_the_run_before_waits_through_trials_and_goes_on_as_it_was() -> None:
    engine = an_engine(OFFICE)
    own, known = engine.run, engine.run.session.state_hash()
    for _ in range(2):
        engine.begin_trial(short_trial(), "A title")
        play(engine)
    tell(engine, type="go_back")
    assert (engine.run, engine.running, engine.run.session.state_hash()) == (own, False, known)
    assert engine.snapshot().trial is None


# ---------------------------------------------------------------- the same run


def test_it_is_the_trial_by_itself_bit_for_bit() -> None:
    """Looking and pausing change nothing."""
    trial = short_trial()
    result, course = run_trial(trial)
    for disturbed in (False, True):
        engine, number = watching(trial), 0
        while engine.running:
            engine.tick()
            number += 1
            if disturbed and number % 7 == 0:
                engine.snapshot()
            if disturbed and number % 20 == 0 and engine.running:
                tell(engine, type="inspect", experience=0)
                tell(engine, type="pause")
                tell(engine, type="set_speed", factor=4.0)
                tell(engine, type="resume")
        assert engine.run.session.state_hash() == result.state_hash
        assert engine.run.session.tick_count == course.session.tick_count
        assert engine.run.trial is not None
        assert engine.run.trial.course.visits == course.visits
        assert (engine.run.trial.state, engine.run.trial.altered) == ("over", False)


def test_its_moments_stand_in_the_log_and_it_pauses_at_its_end() -> None:
    engine = watching(short_trial())
    assert events(engine, "trial")[0].text == "short begins: ours, seed 1"
    view = shown(engine.snapshot())
    assert (view.title, view.state, view.doing, view.about_s) == ("A title", "running", "moved", 50.0)
    play(engine)
    assert not engine.running
    first, *_, last = events(engine, "tagged", "kidnap", "reached", "failed")
    assert (first.kind, first.time_s) == ("kidnap", pytest.approx(4.0))
    view = shown(engine.snapshot())
    assert (view.state, view.outcome) == ("over", f"{int(last.kind == 'reached')} of 1 goal reached")
    assert events(engine, "trial")[-1].text == f"short is over: {view.outcome}"
    tell(engine, type="resume")
    before = engine.run.session.tick_count
    engine.tick()
    assert (engine.run.session.tick_count, engine.running) == (before + 1, True)  # it goes on as any run does


def test_it_is_run_ahead_to_shortly_before_its_moment(table_hash: str) -> None:
    engine = watching(table_trial(), moment_s=18.0)
    engine.pace.speed = 16.0
    assert engine.runs_ahead
    while engine.runs_ahead:
        assert shown(engine.snapshot()).ahead is not None
        engine.run_ahead(0.02)
    assert engine.run.session.time_s == pytest.approx(8.0)
    assert (engine.running, engine.pace.speed) == (True, 1.0)
    assert play(engine) == table_hash
    assert not watching(short_trial(), moment_s=9.0).runs_ahead, "a moment near the beginning is simply watched"


@pytest.mark.parametrize(("order", "running"), [("pause", False), ("resume", True)])
def test_running_ahead_can_be_broken_off(order: str, running: bool) -> None:
    engine = watching(table_trial(), moment_s=24.0)
    engine.run_ahead(0.0)
    tell(engine, type=order)
    assert (engine.runs_ahead, engine.trial_plays, engine.running) == (False, True, running)


def test_in_its_thread_it_is_the_same_run_and_pauses_at_its_end(start: Start, table_hash: str) -> None:
    engine = start()
    accept(engine, an_order(quick=True, moment_s=24.0))
    wait_for(engine, lambda now: now.trial is not None and now.trial.ahead is None and now.time_s >= 14.0)
    assert snapshot(engine).speed == 1.0
    accept(engine, m.SetSpeed(type="set_speed", factor=0))
    last = wait_for(engine, lambda now: now.trial is not None and now.trial.state == "over")
    assert not last.running
    assert engine.session.state_hash() == table_hash


# ---------------------------------------------------------------- orders of one's own


def test_an_order_of_ones_own_ends_it(subtests: pytest.Subtests) -> None:
    for order, why in (
        ({"type": "drive", "speed": 0.1, "yaw_rate": 0.0}, "somebody drove the robot by hand"),
        ({"type": "kidnap"}, "somebody carried the robot away"),
        ({"type": "set_mode", "mode": "explore"}, "somebody told the robot what to do"),
        ({"type": "set_goal", "x": 0.0, "y": 0.0}, "somebody gave the robot a goal"),
        ({"type": "cancel_goal"}, "somebody cancelled the robot's goal"),
    ):
        engine = watching(short_trial())
        for _ in range(20):
            engine.tick()
        with subtests.test(str(order["type"])):
            assert tell(engine, **order) == f"short ends: {why}"
            view = shown(engine.snapshot())
            assert (view.state, view.outcome) == ("ended", why)
            for _ in range(40):
                engine.tick()
            assert len(events(engine, "kidnap")) == (order["type"] == "kidnap")  # its own, at 4 s, does not come
            assert engine.running


def test_a_refused_order_does_not_end_it_and_a_change_of_office_or_parameters_makes_it_another_run() -> None:
    engine = watching(short_trial())
    with pytest.raises(ValueError, match="off the map"):
        tell(engine, type="set_goal", x=99.0, y=0.0)
    assert engine.trial_plays
    for _ in range(5):
        engine.tick()
    tell(engine, type="set_parameter", name="robot.light", value=0.8)
    tell(engine, type="put_box", name="box", x=9.0, y=1.0)
    view = shown(engine.snapshot())
    assert (view.state, view.altered) == ("running", True)
    told = [event.text for event in events(engine, "trial") if "changed by hand" in event.text]
    assert told == ["short was changed by hand: from here on it is another run"]


def test_a_reset_ends_it_and_takes_its_settings_away_but_not_those_that_somebody_made() -> None:
    for values in ({}, {"robot.light": 0.8}):
        engine = an_engine(OFFICE)
        own = engine.run.session.config
        watch(engine, engine="paper", quick=True)
        assert engine.run.session.config != own
        for name, value in values.items():
            tell(engine, type="set_parameter", name=name, value=value)
        assert isinstance(carry_out(engine, m.Reset(type="reset")), m.Accepted)
        assert engine.run.trial is None
        assert engine.run.session.config == own.with_values(values)  # type: ignore[arg-type]


def test_of_every_command_it_is_known_what_it_does_to_a_trial() -> None:
    leaves = {
        m.Tag, m.Untag, m.Pause, m.Resume, m.Step, m.StepStage, m.SetSpeed, m.Reset, m.Inspect, m.WatchExperiment,
        m.Seek, m.BackToNow, m.GoOnFromHere, m.GoOnWithout, m.ChangeBranch, m.CompareBranch, m.Loop,
        m.GoBack, m.PutBookmark, m.RemoveBookmark,
        m.BeginLesson, m.Predict, m.Vote, m.ShowLesson, m.LessonAgain, m.EndLesson, m.RunUntil,
        m.CompareBrains, m.EndComparison,
    }  # fmt: skip
    assert leaves == {each for each in COMMANDS if not (each.ends or each.alters)}
    assert not [each for each in COMMANDS if each.ends and each.alters]


# ---------------------------------------------------------------- the command


def test_it_begins_the_trial_that_is_asked_for_and_what_is_left_out_is_as_the_file_says() -> None:
    engine = an_engine(OFFICE)
    words = watch(engine, engine="paper", levels=["2 %", "8 x 8"], seed=7, quick=True)
    assert words == "table begins: paper, 2 %, 8 x 8, seed 7"
    session = engine.run.session
    assert (session.config.pose_cells.n_x, session.config.local_view.false_positives) == (8, 0.02)
    assert (session.seed, engine.running, engine.run.number) == (7, True, 2)
    watch(engine)
    view = shown(engine.snapshot())
    assert (view.engine, view.levels, view.seed) == ("ours", ("0 %", "64 x 64"), find_experiment("table").seed)


def test_what_there_is_not_is_refused_with_what_there_is(start: Start, subtests: pytest.Subtests) -> None:
    engine = start()
    before = snapshot(engine).run
    for fields, field, words in (
        ({"experiment": "castle"}, "experiment", r"there is no experiment 'castle'; expected one of: .*table"),
        ({"experiment": "/etc/passwd.toml"}, "experiment", "there is no experiment"),
        ({"levels": ["2 %"]}, "levels", r"table takes 2 levels \(N_vis, pose cells\), got 1"),
        ({"levels": ["2 %", "9 x 9"]}, "levels", r"pose cells has no level '9 x 9'; expected one of: 64 x 64, 32 x 32"),
    ):
        with subtests.test(words):
            answer = refuse(engine, an_order(**fields))
            assert answer.field == field
            assert re.search(words, answer.reason)
            assert snapshot(engine).run == before


def test_a_trial_of_another_version_is_told() -> None:
    engine = an_engine(OFFICE)
    watch(engine, quick=True, trial=table_trial().id)
    assert not events(engine, "warning")
    watch(engine, quick=True, trial="0" * 16)
    assert "the program has changed" in engine.run.event_log.events[-1].text


def test_the_one_that_is_watched_begins_again_by_its_id() -> None:
    trial = short_trial()  # of no catalogue
    engine = watching(trial)
    for _ in range(3):
        engine.tick()
    assert watch(engine, "short", trial=trial.id) == "short begins: ours, seed 1"
    assert (engine.run.session.tick_count, engine.run.trial and engine.run.trial.trial) == (0, trial)
