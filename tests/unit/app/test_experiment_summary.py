"""The table of an experiment: which trials count in which cell, and how its figures are told."""

from __future__ import annotations

import math

import pytest

from app.experiments.intervals import Estimate, wilson
from app.experiments.stored_trial import StoredTrial
from app.experiments.summary import summarise, words
from app.trials.experiment import Experiment, Score

EXPERIMENT = Experiment.model_validate({
    "name": "small", "title": "Small", "paper": "none", "asks": "Does it count?", "found": "It does.",
    "engines": {"paper": {"preset": "paper-2006"}, "ours": {}},
    "axes": [{"name": "size", "levels": [{"label": "large"}, {"label": "small"}]}],
    "protocol": [{"do": "wait", "seconds": 1}],
    "scores": [{"label": "goals", "rate": ["reached", "goals"]}, {"label": "error", "score": "error_m", "unit": "m"}],
})  # fmt: skip


def stored(engine: str, level: str, seed: int, error: str = "", **scores: float) -> StoredTrial:
    return StoredTrial(f"{engine}-{level}-{seed}", engine, (level,), seed, scores, 1.0, "the end", error=error)


TRIALS = [
    stored("ours", "small", 1, reached=2, goals=3, error_m=0.3),
    stored("ours", "small", 2, reached=3, goals=3, error_m=0.1),
    stored("ours", "small", 3, "ValueError: no"),
    stored("ours", "small", 4, error_m=0.2),
    stored("paper", "large", 1, reached=0, goals=3),
    stored("ours", "large", 1, reached=1, goals=3, error_m=0.5),
]


def test_rows_are_in_the_order_of_the_experiment() -> None:
    rows = summarise(EXPERIMENT, TRIALS)
    assert [(row.engine, row.levels, row.n, row.failed) for row in rows] == [
        ("paper", ("large",), 1, 0), ("ours", ("large",), 1, 0), ("ours", ("small",), 3, 1),
    ]  # fmt: skip


def test_a_rate_counts_all_trials_together_and_a_score_is_a_median() -> None:
    small = summarise(EXPERIMENT, TRIALS)[-1]
    assert small.values["goals"] == wilson(5, 6)
    error = small.values["error"]
    assert (error.value, error.n) == (0.2, 3)
    assert error.low <= 0.2 <= error.high


def test_what_no_trial_has_is_said_to_be_missing() -> None:
    error = summarise(EXPERIMENT, TRIALS)[0].values["error"]
    assert error.n == 0
    assert math.isnan(error.value)
    assert words(error, EXPERIMENT.scores[1]) == "-"


def test_the_order_in_which_trials_came_makes_no_difference() -> None:
    assert summarise(EXPERIMENT, TRIALS)[-1] == summarise(EXPERIMENT, TRIALS[::-1])[-1]


@pytest.mark.parametrize(
    ("value", "score", "expected"),
    [
        (wilson(25, 30), Score(label="a", rate=("r", "g")), "83 % (66-93)"),
        (Estimate(0.123, 0.1, 0.15, 9), Score(label="a", score="error_m", unit="m"), "0.123 m (0.1-0.15)"),
        (Estimate(1234.4, math.nan, math.nan, 1), Score(label="a", score="x"), "1234"),
    ],
)
def test_figures_are_told_with_their_intervals(value: Estimate, score: Score, expected: str) -> None:
    assert words(value, score) == expected
