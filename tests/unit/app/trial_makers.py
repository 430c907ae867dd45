"""Trials that do nothing, for tests of what runs and keeps them."""

from __future__ import annotations

from app.experiments.store import Outcome
from app.protocol.course import Moment
from app.protocol.experiment import Experiment
from app.protocol.steps import Wait
from app.protocol.trial import Result, Trial

SMALL = Experiment.model_validate({
    "name": "small", "title": "Small", "paper": "none", "asks": "Does it count?", "found": "It does.",
    "world": "loop", "trials": 3,
    "engines": {"paper": {"preset": "paper-2006"}, "ours": {}},
    "axes": [{"name": "size", "levels": [{"label": "large"}, {"label": "small", "set": {"pose_cells.n_x": 16}}]}],
    "protocol": [{"do": "wait", "seconds": 1}],
    "scores": [{"label": "goals", "rate": ["reached", "goals"]}, {"label": "error", "score": "error_m", "unit": "m"}],
    "quick": {"levels": 2},
})  # fmt: skip


def make_trial(seed: int, level: str = "large", engine: str = "ours", version: str = "v1") -> Trial:
    """A trial whose protocol is to wait for a second."""
    values = {"pose_cells.n_x": 32 if level == "large" else 16}
    step = Wait(do="wait", seconds=1)
    return Trial("small", engine, (level,), seed, "loop", "a world", values, (step,), (), version)


def score_of(trial: Trial) -> float:
    """What the fake trial has as its only score: it tells whose it is."""
    return float(int(trial.id[:8], 16))


def make_outcome(trial: Trial) -> Outcome:
    return Outcome(trial.id, Result(trial.id, {"mark": score_of(trial)}, Moment(0.5, "the end"), 1.0, 0.25, trial.id))
