"""A trial in the engine: it is the trial by itself, bit for bit, and it ends as it should."""

from __future__ import annotations

import pytest

from app.commands import carry_out
from app.engine.engine import Engine
from app.trials.trial import Trial, run_trial
from web import messages as m

from .engines import an_engine, tell
from .sessions import OFFICE
from .trials_to_watch import short_trial, table_trial

pytestmark = pytest.mark.slow


def watching(trial: Trial, moment_s: float | None = None) -> Engine:
    engine = an_engine(OFFICE)
    engine.begin_trial(trial, "A title", moment_s)
    return engine


def play(engine: Engine, most: int = 2000) -> None:
    """Run ticks, as the engine's thread does, until it pauses."""
    while engine.running and most > 0:
        engine.tick()
        most -= 1


def events(engine: Engine, *kinds: str) -> list[m.Event]:
    return [event for event in engine.run.event_log.events if event.kind in kinds]


@pytest.mark.parametrize("make", [short_trial, table_trial], ids=["short", "table"])
def test_it_is_the_trial_by_itself_bit_for_bit(make) -> None:
    trial = make()
    result, course = run_trial(trial)
    engine = watching(trial)
    play(engine)
    assert engine.run.session.state_hash() == result.state_hash
    assert engine.run.session.tick_count == course.session.tick_count
    assert engine.run.trial is not None
    assert engine.run.trial.course.visits == course.visits


def test_looking_and_pausing_change_nothing() -> None:
    trial = short_trial()
    engine, number = watching(trial), 0
    while engine.running:
        engine.tick()
        number += 1
        if number % 7 == 0:
            engine.snapshot()
        if number % 20 == 0 and engine.running:
            tell(engine, type="inspect", experience=0)
            tell(engine, type="pause")
            tell(engine, type="set_speed", factor=4.0)
            tell(engine, type="resume")
    assert engine.run.trial is not None
    assert (engine.run.trial.state, engine.run.trial.altered) == ("over", False)
    assert engine.run.session.state_hash() == run_trial(trial)[0].state_hash


def test_its_moments_stand_in_the_log_and_it_pauses_at_its_end() -> None:
    engine = watching(short_trial())
    assert events(engine, "trial")[0].text == "short begins: ours, seed 1"
    view = engine.snapshot().trial
    assert view is not None
    assert (view.title, view.state, view.doing, view.about_s) == ("A title", "running", "moved", 50.0)
    play(engine)
    assert not engine.running
    assert [event.kind for event in events(engine, "tagged", "kidnap", "reached", "failed")][:1] == ["kidnap"]
    kidnap = events(engine, "kidnap")[0]
    assert kidnap.time_s == pytest.approx(4.0)
    last = events(engine, "reached", "failed")[-1]
    view = engine.snapshot().trial
    assert view is not None
    assert view.state == "over"
    assert view.outcome == ("1 of 1 goal reached" if last.kind == "reached" else "0 of 1 goal reached")
    assert events(engine, "trial")[-1].text == f"short is over: {view.outcome}"
    tell(engine, type="resume")
    before = engine.run.session.tick_count
    engine.tick()
    assert (engine.run.session.tick_count, engine.running) == (before + 1, True)  # it goes on as any run does


@pytest.mark.parametrize(
    ("order", "why"),
    [
        ({"type": "drive", "speed": 0.1, "yaw_rate": 0.0}, "somebody drove the robot by hand"),
        ({"type": "kidnap"}, "somebody carried the robot away"),
        ({"type": "set_mode", "mode": "explore"}, "somebody told the robot what to do"),
        ({"type": "set_goal", "x": 0.0, "y": 0.0}, "somebody gave the robot a goal"),
        ({"type": "cancel_goal"}, "somebody cancelled the robot's goal"),
    ],
)
def test_an_order_of_ones_own_ends_it(order: dict[str, object], why: str) -> None:
    engine = watching(short_trial())
    for _ in range(20):
        engine.tick()
    assert tell(engine, **order) == f"short ends: {why}"
    view = engine.snapshot().trial
    assert view is not None
    assert (view.state, view.outcome) == ("ended", why)
    for _ in range(40):
        engine.tick()
    assert len(events(engine, "kidnap")) == (order["type"] == "kidnap")  # its own kidnap, at 4 s, does not come
    assert engine.running


def test_a_refused_order_does_not_end_it() -> None:
    engine = watching(short_trial())
    with pytest.raises(ValueError, match="off the map"):
        tell(engine, type="set_goal", x=99.0, y=0.0)
    assert engine.trial_plays


def test_a_change_of_office_or_parameters_makes_it_another_run_and_is_said_once() -> None:
    engine = watching(short_trial())
    for _ in range(5):
        engine.tick()
    tell(engine, type="set_parameter", name="robot.light", value=0.8)
    tell(engine, type="put_box", name="box", x=9.0, y=1.0)
    view = engine.snapshot().trial
    assert view is not None
    assert (view.state, view.altered) == ("running", True)
    told = [event.text for event in events(engine, "trial") if "changed by hand" in event.text]
    assert told == ["short was changed by hand: from here on it is another run"]


def test_a_reset_ends_it_and_takes_its_settings_away() -> None:
    engine = an_engine(OFFICE)
    own = engine.run.session.config
    tell(engine, type="watch_experiment", experiment="table", engine="paper", quick=True)
    assert engine.run.session.config != own
    reset(engine)
    assert engine.run.trial is None
    assert engine.run.session.config == own


def test_settings_that_somebody_made_in_a_trial_stay_and_the_trials_own_do_not() -> None:
    engine = an_engine(OFFICE)
    own = engine.run.session.config
    tell(engine, type="watch_experiment", experiment="table", engine="paper", quick=True)
    tell(engine, type="set_parameter", name="robot.light", value=0.8)
    reset(engine)
    assert engine.run.session.config == own.with_values({"robot.light": 0.8})


def reset(engine: Engine) -> None:
    assert isinstance(carry_out(engine, m.Reset(type="reset")), m.Accepted)


def test_it_is_run_ahead_to_shortly_before_its_moment() -> None:
    trial = table_trial()
    engine = watching(trial, moment_s=18.0)
    assert engine.runs_ahead
    engine.pace.speed = 16.0
    while engine.runs_ahead:
        view = engine.snapshot().trial
        assert view is not None
        assert view.ahead is not None
        engine.run_ahead(0.02)
    assert engine.run.session.time_s == pytest.approx(8.0)
    assert (engine.running, engine.pace.speed) == (True, 1.0)
    play(engine)
    assert engine.run.session.state_hash() == run_trial(trial)[0].state_hash


@pytest.mark.parametrize(("order", "running"), [("pause", False), ("resume", True)])
def test_running_ahead_can_be_broken_off(order: str, running: bool) -> None:
    engine = watching(table_trial(), moment_s=24.0)
    engine.run_ahead(0.0)
    tell(engine, type=order)
    assert (engine.runs_ahead, engine.trial_plays, engine.running) == (False, True, running)


def test_a_moment_near_the_beginning_is_simply_watched() -> None:
    assert not watching(short_trial(), moment_s=9.0).runs_ahead
