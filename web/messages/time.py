"""Where on the run's timeline the page is: live or in the past, on which branch, and between which marks it loops."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class BranchView:
    """One line of time. It left its parent's at `from_s` (simulated seconds)."""

    number: int
    parent: int | None  # None: the run as it began
    from_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class TimeView:
    """The live branch goes to `end_s`; `past`: what is shown is an earlier moment of it."""

    past: bool
    end_tick: int
    end_s: float
    begin_s: float  # nothing before it can be shown
    branch: int
    branches: tuple[BranchView, ...]
    loop: tuple[float, float] | None  # simulated seconds, between which the past is played again and again
    differs: str = ""  # in words, where two branches that were compared differ first
