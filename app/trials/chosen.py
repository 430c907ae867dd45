"""One trial of an experiment, chosen by engine, levels and seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from app.trials.experiment import EngineName, Experiment, duration_s, shortened
from app.trials.trial import Trial

OURS: EngineName = "ours"


def chosen_trial(
    experiment: Experiment,
    engine: EngineName | None = None,
    levels: Sequence[str] | None = None,
    seed: int | None = None,
    quick: bool = False,
) -> Trial:
    """The trial; what is left out is as the experiment begins. ValueError names an engine or level that there is not."""
    engine = engine or (OURS if OURS in experiment.engines else next(iter(experiment.engines)))
    wanted = first_levels(experiment) if levels is None else tuple(levels)
    check_levels(experiment, wanted)
    axes = [
        axis.model_copy(update={"levels": [each for each in axis.levels if each.label == label]})
        for axis, label in zip(experiment.axes, wanted, strict=True)
    ]
    found = experiment.model_copy(update={"axes": axes}).make_trials([engine], 1)[0]
    if quick:
        steps = tuple(shortened(step, experiment.quick.share) for step in found.protocol)
        found = replace(found, protocol=steps, quick=True)
    return found if seed is None else replace(found, seed=seed)


def first_levels(experiment: Experiment) -> tuple[str, ...]:
    """Those at which the experiment is watched if nobody says otherwise: of each axis, by label."""
    return tuple(experiment.watch) or tuple(axis.levels[0].label for axis in experiment.axes)


def check_levels(experiment: Experiment, levels: Sequence[str]) -> None:
    """ValueError names a level that an axis does not have, or says how many there must be."""
    axes = experiment.axes
    if len(levels) != len(axes):
        names = ", ".join(axis.name for axis in axes) or "it has no axes"
        raise ValueError(f"{experiment.name} takes {len(axes)} levels ({names}), got {len(levels)}")
    for axis, level in zip(axes, levels, strict=True):
        known = [each.label for each in axis.levels]
        if level not in known:
            raise ValueError(f"{axis.name} has no level {level!r}; expected one of: {', '.join(known)}")


def seconds_of(trial: Trial) -> float:
    """About how long a trial is, in simulated seconds."""
    return sum(map(duration_s, trial.protocol))
