"""Whether what the papers claim holds here: by their own rules, and by ours. Each claim and its verdict stand in the file of
the experiment; here they are judged by the numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from app.experiments.summary import ENGINE_WORDS, CellSummary, Estimate, words, words_of
from app.protocol.experiment import Claim, Experiment, Score

JUDGED = ("paper", "ours")
FALLS_Z = -1.645  # a trend that chance makes in one of twenty, one-sided
HEADS = ("experiment", "the paper", "by its rules", "by ours", "why they differ")


@dataclass(frozen=True, slots=True)
class Verdict:
    """On a claim, by the rules of an engine; `agrees` is None where there are no numbers."""

    experiment: Experiment
    claim: Claim
    engine: str
    found: str  # in words
    agrees: bool | None

    @property
    def holds(self) -> bool:
        """Whether the verdict in the experiment's file is this one."""
        return self.agrees is None or self.agrees == (self.engine in self.claim.agrees)

    def __str__(self) -> str:
        return "-" if self.agrees is None else f"{self.found}: {'agrees' if self.agrees else '**differs**'}"


def verdicts(found: Iterable[tuple[Experiment, Sequence[CellSummary]]]) -> Iterator[Verdict]:
    """One for each claim and each of `JUDGED` that the experiment runs."""
    for experiment, cells in found:
        for claim in experiment.claims:
            for engine in JUDGED:
                if engine in experiment.engines:
                    yield _judged(experiment, claim, engine, [cell for cell in cells if cell.engine == engine])


def rows(found: Sequence[Verdict]) -> list[tuple[str, ...]]:
    """A row of `HEADS` for each claim."""
    claims = dict.fromkeys((v.experiment.name, v.claim.says) for v in found)
    made = list[tuple[str, ...]]()
    for name, says in claims:
        by = {v.engine: v for v in found if (v.experiment.name, v.claim.says) == (name, says)}
        claim = next(iter(by.values())).claim
        made.append((name, says, *(str(by[e]) if e in by else "not run" for e in JUDGED), claim.why))
    return made


def broken(found: Sequence[Verdict]) -> list[str]:
    """What no longer holds, and what to do."""
    return [
        f"{v.experiment.name}: {v.claim.says!r} {'holds now' if v.agrees else 'no longer holds'} by {ENGINE_WORDS[v.engine]} "
        f"({v.found}); find out why, then change `agrees` and `why` of this claim in the experiment's file"
        for v in found
        if not v.holds
    ]


def _judged(experiment: Experiment, claim: Claim, engine: str, cells: Sequence[CellSummary]) -> Verdict:
    score = next(each for each in experiment.scores if each.label == claim.score)
    at = _at(cells, claim.score, claim.levels)
    if not at:
        return Verdict(experiment, claim, engine, "", None)
    if claim.falls_along is not None:
        z = trend([(each.value, each.n) for each in at])
        return Verdict(experiment, claim, engine, f"trend z = {z:.1f}", z <= FALLS_Z)
    value, found = at[0].value, words(at[0], score)
    if claim.minus:
        other = _at(cells, claim.score, claim.minus)
        if not other:
            return Verdict(experiment, claim, engine, "", None)
        value -= other[0].value
        found = _difference(score, value)
    return Verdict(experiment, claim, engine, found, claim.least <= value <= claim.most)


def _difference(score: Score, value: float) -> str:
    return (
        f"{100 * value:+.0f} points"
        if score.rate is not None
        else f"{'+' if value > 0 else ''}{words_of(score, value)}"
    )


def _at(cells: Sequence[CellSummary], label: str, levels: Sequence[str]) -> list[Estimate]:
    """The score at these levels, in the order of the cells; several along an axis that is not fixed."""
    return [c.values[label] for c in cells if set(levels) <= set(c.levels) and c.values[label].n]


def trend(rates: Sequence[tuple[float, int]]) -> float:
    """z of the Cochran-Armitage test for a trend of rates (0 to 1, of n) over equally spaced levels; below 0: they fall."""
    total = sum(n for _, n in rates)
    pooled = sum(rate * n for rate, n in rates) / total
    middle = sum(k * n for k, (_, n) in enumerate(rates)) / total
    spread = pooled * (1 - pooled) * sum(n * (k - middle) ** 2 for k, (_, n) in enumerate(rates))
    fall = sum(n * (rate - pooled) * (k - middle) for k, (rate, n) in enumerate(rates))
    return fall / math.sqrt(spread) if spread > 0 else 0.0
