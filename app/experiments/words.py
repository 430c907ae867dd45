"""Engines, scores and cells in words."""

from __future__ import annotations

from app.experiments.stored_trial import StoredTrial
from app.trials.experiment import Score

ENGINE_WORDS = {
    "paper": "the paper's rules", "paper-2005": "the rules of 2005", "paper-2006": "the rules of 2006", "ours": "our rules",
}  # fmt: skip


def value_of(score: Score, trial: StoredTrial) -> float | None:
    """The score of one trial; None where it has none."""
    if score.rate is None:
        return trial.scores.get(str(score.score))
    good, of = (trial.scores.get(name) for name in score.rate)
    return (good or 0.0) / of if of else None


def words_of(score: Score, value: float) -> str:
    """A value of a score with its unit."""
    if score.rate is not None:
        return f"{100 * value:.0f} %"
    text = f"{value:.0f}" if abs(value) >= 100 or value == int(value) else f"{value:.3g}"
    return f"{text} {score.unit}".rstrip()
