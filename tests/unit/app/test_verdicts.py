"""What the papers claim is judged by the numbers, and the verdicts that stand in the files are those of the numbers."""

from __future__ import annotations

import numpy as np
import pytest

from app.experiments.results import DOCS, cells_of, read_results
from app.experiments.summary import CellSummary, Estimate, wilson
from app.experiments.verdicts import Verdict, broken, rows, trend, verdicts
from app.protocol.experiment import Claim, Experiment, catalogue
from tests.unit.app.made_trials import experiment


def test_the_verdicts_in_the_files_are_those_of_the_published_numbers() -> None:
    data, experiments = read_results(DOCS / "results.json"), list(catalogue())
    found = list(verdicts((each, cells_of(data, each.name)) for each in experiments))
    assert broken(found) == []
    assert {v.experiment.name for v in found} == {each.name for each in experiments} - {"additions"}  # is no paper's
    assert [v.claim.says for v in found if v.agrees is False and not v.claim.why] == []


def cells(**reached: tuple[int, int, int]) -> list[CellSummary]:
    """Of the made experiment: goals reached of 30 at 0, 2 and 10 %, by engine, at both sizes the same."""
    return [
        CellSummary(engine, (level, size), 10, 0, {"goals reached": wilson(count, 30), "map error": Estimate(1.0, 0.9, 1.1, 10)})
        for engine, counts in reached.items()
        for level, count in zip(("0 %", "2 %", "10 %"), counts, strict=True)
        for size in ("8", "16")
    ]  # fmt: skip


def judged(claim: Claim, **reached: tuple[int, int, int]) -> list[Verdict]:
    return list(verdicts([(experiment(claims=[claim]), cells(**reached))]))


@pytest.mark.parametrize(
    ("condition", "paper", "ours"),
    [
        ({"levels": ["0 %", "8"], "least": 0.95}, False, True),
        ({"levels": ["0 %", "8"], "most": 0.95}, True, False),
        ({"levels": ["10 %", "8"], "minus": ["0 %", "8"], "least": -0.15}, False, True),
        ({"levels": ["8"], "falls_along": "N_vis"}, True, False),
    ],
)
def test_a_claim_is_judged_by_its_condition(condition: dict[str, object], paper: bool, ours: bool) -> None:
    claim = Claim.model_validate({"says": "It is so", "score": "goals reached", **condition})
    found = judged(claim, paper=(25, 20, 5), ours=(30, 30, 29))
    assert [v.agrees for v in found] == [paper, ours]
    (row,) = rows(found)
    assert [("differs" in row[2]), ("differs" in row[3])] == [not paper, not ours]


def test_a_verdict_that_changed_is_told_and_one_without_numbers_is_not() -> None:
    claim = Claim(says="All goals", score="goals reached", levels=["0 %", "8"], least=0.95, agrees=["paper"])
    lost, won = broken(judged(claim, paper=(25, 20, 5), ours=(30, 30, 29)))
    assert "made: 'All goals' no longer holds by the paper's rules (83 % (66-93))" in lost
    assert "holds now by our rules" in won
    assert broken(list(verdicts([(experiment(claims=[claim]), [])]))) == []


def test_the_trend_is_that_of_cochran_and_armitage() -> None:
    """Literally: the correlation of level and outcome over all trials, times the root of their number."""
    counts = [(27, 30), (20, 25), (9, 30), (2, 12)]
    level = np.concatenate([np.full(n, k) for k, (_, n) in enumerate(counts)])
    outcome = np.concatenate([np.arange(n) < good for good, n in counts]).astype(float)
    literal = np.corrcoef(level, outcome)[0, 1] * np.sqrt(len(level))
    assert trend([(good / n, n) for good, n in counts]) == pytest.approx(literal)
    assert trend([(1.0, 10), (1.0, 10)]) == 0.0


@pytest.mark.parametrize(
    ("claim", "told"),
    [
        ({"least": 0.9}, "give one level of N_vis: 0 %, 10 %, 2 %"),
        ({"levels": ["0 %", "8"]}, "give least or most, or else falls_along = AXIS"),
        ({"levels": ["0 %", "8"], "least": 0.5, "falls_along": "N_vis"}, "give least or most, or else falls_along"),
        ({"levels": ["8"], "falls_along": "N_vis", "score": "map error"}, "its score a rate"),
        ({"levels": ["0 %", "8"], "least": 0.5, "score": "goals"}, "there is no score labelled 'goals'"),
    ],
)
def test_a_claim_that_cannot_be_judged_is_refused(claim: dict[str, object], told: str) -> None:
    tree = experiment().model_dump(mode="json") | {"claims": [{"says": "It is so", "score": "goals reached", **claim}]}
    with pytest.raises(ValueError, match=told):
        Experiment.model_validate(tree)
