"""What follows a protocol: watching a trial of an experiment; lessons, which are begun, predicted, voted on and shown; running
until something happens."""

from __future__ import annotations

from app.commands.outcome import Outcome
from app.engine.engine import Engine
from app.engine.lesson_supervisor import LessonSupervisor, Teaching
from app.engine.waiting import RunUntil
from app.engine.watched_trial import CHANGED
from app.protocol.conditions import read_until
from app.protocol.experiment import Experiment, catalogue, check_levels, chosen_trial
from app.protocol.lesson import find_lesson
from app.views.office import REACH_M
from web import messages as m

NONE = "no lesson was begun in this run: begin one first"


def begin_lesson(engine: Engine, command: m.BeginLesson) -> Outcome:
    lesson = find_lesson(command.name)
    seed = lesson.scene.seed if command.seed is None else command.seed
    engine.begin_lesson(Teaching(lesson, seed, engine.next_config))


def predict(engine: Engine, command: m.Predict) -> Outcome:
    _open(engine).teaching.predict(m.LessonPrediction(command.choice, command.x, command.y))
    return m.Accepted(engine.shown.session.tick_count)


def vote(engine: Engine, command: m.Vote) -> Outcome:
    lesson = _open(engine)
    if lesson.teaching.lesson.name != command.lesson:
        raise ValueError(f"the lesson is {lesson.teaching.lesson.name!r} now, not {command.lesson!r}")
    prediction = m.LessonPrediction(command.choice, command.x, command.y)
    lesson.teaching.vote(command.voter, prediction, command.sender)
    return m.Accepted(engine.shown.session.tick_count)


def show_lesson(engine: Engine, command: m.ShowLesson) -> Outcome:
    """Let it happen, from the present."""
    lesson = engine.run.lesson
    if lesson is None:
        return m.Refused("type", command.type, NONE)
    if lesson.state != "predict":
        return m.Refused(
            "type", command.type, f"the lesson is in the state {lesson.state!r}: lesson_again begins it anew"
        )
    refused = engine.pause_for(command.type)
    if refused is not None:
        return refused
    engine.break_off()
    engine.time.back_to_now()
    if lesson.round_over:
        engine.begin_lesson(lesson.next_round(), at_once=True)
    else:
        lesson.show()
    engine.running = True
    engine.pace.speed = lesson.speed
    engine.pace.hurry()
    return None


def lesson_again(engine: Engine, command: m.LessonAgain) -> Outcome:
    lesson = engine.run.lesson
    if lesson is None:
        return m.Refused("type", command.type, NONE)
    teaching = lesson.teaching
    engine.begin_lesson(Teaching(teaching.lesson, teaching.seed, teaching.config_before))
    return None


def end_lesson(engine: Engine, command: m.EndLesson) -> Outcome:
    if engine.run.lesson is None:
        return m.Refused("type", command.type, NONE)
    engine.break_off()
    engine.run.lesson = engine.run.before = None
    return None


def run_until(engine: Engine, command: m.RunUntil) -> Outcome:
    """From the present on."""
    where = command.place if command.x is None or command.y is None else (command.x, command.y)
    refused = engine.pause_for(command.type)
    if refused is not None:
        return refused
    engine.break_off()
    engine.time.back_to_now()
    engine.running = False
    if command.place is not None and isinstance(where, tuple):
        raise ValueError("give either place or x and y")
    near = {"within_m": REACH_M / 2} if isinstance(where, str) else {}  # by then the map knows it by its name
    until = read_until({"what": command.what, "count": command.count, "place": where, **near})
    engine.run.until = RunUntil(until, command.within_s, engine.run.session, engine.run.history)
    engine.running = True
    return None


def _open(engine: Engine) -> LessonSupervisor:
    """The lesson, while predictions are taken. ValueError otherwise."""
    lesson = engine.run.lesson
    if lesson is None:
        raise ValueError(NONE)
    if lesson.state not in ("scene", "predict"):
        raise ValueError("it has been shown already: predictions come first")
    return lesson


def watch_experiment(engine: Engine, command: m.WatchExperiment) -> Outcome:
    """Begin the trial in a new run, and play it. The id of the one that is being watched begins that one again."""
    now = engine.run.trial
    if now is not None and command.trial == now.trial.id:
        engine.begin_trial(now.trial, now.title, command.moment_s)
        return None
    known = {experiment.name: experiment for experiment in catalogue()}
    experiment = known.get(command.experiment)
    if experiment is None:
        reason = f"there is no experiment {command.experiment!r}; expected one of: {', '.join(known)}"
        return m.Refused("experiment", command.experiment, reason)
    wrong = _wrong(experiment, command)
    if wrong is not None:
        return wrong
    try:
        trial = chosen_trial(experiment, command.engine, command.levels, command.seed, command.quick)
        engine.begin_trial(trial, experiment.title, command.moment_s)
    except ValueError as error:
        return m.Refused("experiment", command.experiment, str(error))
    if command.trial is not None and command.trial != trial.id:
        engine.run.event_log.note("warning", CHANGED)
    return None


def _wrong(experiment: Experiment, command: m.WatchExperiment) -> m.Refused | None:
    if command.engine is not None and command.engine not in experiment.engines:
        engines = ", ".join(experiment.engines)
        return m.Refused(
            "engine", command.engine, f"{experiment.name} has no engine {command.engine!r}; it has: {engines}"
        )
    if command.levels is not None:
        try:
            check_levels(experiment, command.levels)
        except ValueError as error:
            return m.Refused("levels", command.levels, str(error))
    return None
