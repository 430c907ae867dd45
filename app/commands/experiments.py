"""Watching a trial of an experiment, and what becomes of it when somebody gives orders of their own."""

from __future__ import annotations

from app.commands.outcome import Outcome
from app.config.presets import values_of
from app.engine.engine import Engine
from app.engine.watched_trial import CHANGED
from app.protocol.experiment import Experiment, catalogue, check_levels, chosen_trial
from web import messages as m
from web.messages.commands import CommandModel


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


def after_order(engine: Engine, command: CommandModel) -> None:
    """An order has been carried out: a trial that is being watched may end by it, or become another run."""
    before = engine.run.config_before
    if before is not None and isinstance(command, (m.SetParameter, m.UsePreset)):
        # What somebody sets is wanted in the next run, too; what the trial or lesson had set goes with it.
        one = isinstance(command, m.SetParameter)
        engine.run.config_before = before.with_values({command.name: command.value} if one else values_of(command.name))
    for guide in engine.run.guides:
        if command.ends:
            guide.ordered(command.ends)
        elif command.alters:
            guide.alter()


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
