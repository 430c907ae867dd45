"""The trial of an experiment that somebody watches. Part of a snapshot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

TrialState = Literal["running", "over", "ended"]  # ended: by somebody's own orders, before it was over


@dataclass(frozen=True, slots=True)
class TrialView:
    """What the page tells of the trial."""

    experiment: str
    title: str
    engine: str
    levels: tuple[str, ...]  # of each axis, by label
    seed: int
    id: str
    state: TrialState
    doing: str  # "exploring", "on the way to printer"
    about_s: float  # how long it is, about, in simulated seconds
    ahead: float | None  # share done of running ahead to its moment; None: it runs at its pace
    altered: bool  # somebody has changed office or parameters: it is no longer the trial that it was
    outcome: str  # when it is over or ended, in words
