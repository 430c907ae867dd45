"""The command that begins a trial: what it takes, and what it says of names that there are not."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from app.commands.experiments import ALTERS, ENDS
from app.commands.table import COMMANDS
from app.engine_thread import EngineThread
from app.trials.chosen import chosen_trial
from app.trials.experiment import find_experiment
from app.trials.trial import run_trial
from web import messages as m

from .engine_threads import accept, do, refuse, snapshot, wait_for
from .engines import an_engine, tell
from .sessions import OFFICE
from .trials_to_watch import short_trial


def watch(**fields: object) -> m.WatchExperiment:
    return m.WatchExperiment.model_validate({"type": "watch_experiment", "experiment": "table", **fields})


def test_it_begins_the_trial_that_is_asked_for() -> None:
    engine = an_engine(OFFICE)
    words = tell(
        engine, type="watch_experiment", experiment="table", engine="paper", levels=["2 %", "8 x 8"], seed=7, quick=True
    )
    assert words == "table begins: paper, 2 %, 8 x 8, seed 7"
    config = engine.run.session.config
    assert (config.pose_cells.n_x, config.local_view.false_positives) == (8, 0.02)
    assert (engine.run.session.seed, engine.running, engine.run.number) == (7, True, 2)


def test_what_is_left_out_is_as_the_file_says() -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="watch_experiment", experiment="table")
    view = engine.snapshot().trial
    assert view is not None
    assert (view.engine, view.levels, view.seed) == ("ours", ("0 %", "64 x 64"), find_experiment("table").seed)


@pytest.mark.parametrize(
    ("fields", "field", "words"),
    [
        ({"experiment": "castle"}, "experiment", r"there is no experiment 'castle'; expected one of: .*table"),
        ({"experiment": "/etc/passwd.toml"}, "experiment", "there is no experiment"),
        ({"levels": ["2 %"]}, "levels", r"table takes 2 levels \(N_vis, pose cells\), got 1"),
        ({"levels": ["2 %", "9 x 9"]}, "levels", r"pose cells has no level '9 x 9'; expected one of: 64 x 64, 32 x 32"),
    ],
)
def test_what_there_is_not_is_refused_with_what_there_is(
    start: Callable[..., EngineThread], fields: dict[str, object], field: str, words: str
) -> None:
    engine = start()
    before = snapshot(engine).run
    answer = refuse(engine, watch(**fields))
    assert answer.field == field
    assert re.search(words, answer.reason)
    assert snapshot(engine).run == before


def test_a_trial_of_another_version_is_told() -> None:
    engine = an_engine(OFFICE)
    trial = chosen_trial(find_experiment("table"), quick=True)
    tell(engine, type="watch_experiment", experiment="table", quick=True, trial=trial.id)
    assert not [event for event in engine.run.event_log.events if event.kind == "warning"]
    tell(engine, type="watch_experiment", experiment="table", quick=True, trial="0" * 16)
    assert "the program has changed" in engine.run.event_log.events[-1].text


def test_of_every_command_it_is_known_what_it_does_to_a_trial() -> None:
    leaves = {
        m.Tag, m.Untag, m.Pause, m.Resume, m.Step, m.StepStage, m.SetSpeed, m.Reset, m.Inspect, m.WatchExperiment,
        m.Seek, m.BackToNow, m.GoOnFromHere, m.GoOnWithout, m.ChangeBranch, m.CompareBranch, m.Loop,
        m.LeaveSituation, m.PutBookmark, m.RemoveBookmark,
        m.BeginLesson, m.Predict, m.Vote, m.ShowLesson, m.LessonAgain, m.EndLesson, m.RunUntil,
        m.CompareBrains, m.EndComparison,
    }  # fmt: skip
    groups = [set(ENDS), set(ALTERS), leaves]
    assert set.union(*groups) == set(COMMANDS)
    assert sum(map(len, groups)) == len(COMMANDS)


def test_the_one_that_is_watched_begins_again_by_its_id() -> None:
    engine = an_engine(OFFICE)
    trial = short_trial()  # of no catalogue
    engine.begin_trial(trial, "A title")
    for _ in range(3):
        engine.tick()
    assert tell(engine, type="watch_experiment", experiment="short", trial=trial.id) == "short begins: ours, seed 1"
    assert (engine.run.session.tick_count, engine.run.trial and engine.run.trial.trial) == (0, trial)


def test_in_its_thread_it_is_the_same_run_and_pauses_at_its_end(start: Callable[..., EngineThread]) -> None:
    engine = start()
    trial = chosen_trial(find_experiment("table"), quick=True)
    accept(engine, watch(quick=True, moment_s=24.0))
    wait_for(engine, lambda now: now.trial is not None and now.trial.ahead is None and now.time_s >= 14.0)
    assert snapshot(engine).speed == 1.0
    accept(engine, m.SetSpeed(type="set_speed", factor=0))
    last = wait_for(engine, lambda now: now.trial is not None and now.trial.state == "over")
    assert not last.running
    assert engine.session.state_hash() == run_trial(trial)[0].state_hash


def test_while_it_is_run_ahead_commands_are_answered_and_it_can_be_broken_off(
    start: Callable[..., EngineThread],
) -> None:
    engine = start()
    accept(engine, watch(moment_s=1400.0))
    now = wait_for(engine, lambda now: now.trial is not None and (now.trial.ahead or 0) > 0)
    assert now.trial is not None
    assert now.trial.ahead is not None
    assert isinstance(do(engine, m.Inspect(type="inspect", experience=0)), m.Accepted)
    assert (now := snapshot(engine)).trial is not None
    assert now.trial.ahead is not None  # looking does not break it off
    now = accept(engine, m.Pause(type="pause"))
    assert now.trial is not None
    assert (now.trial.ahead, now.trial.state, now.running) == (None, "running", False)
    assert now.time_s < 1390.0
