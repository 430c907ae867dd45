"""One tick in detail: its stages, and what its parts cost. Parts of a snapshot."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Timing:
    """What a part of a tick costs, in milliseconds, over the last hundred ticks."""

    part: str
    mean_ms: float
    worst_ms: float


@dataclass(frozen=True, slots=True)
class TickStage:
    """One stage of a tick that is walked through."""

    name: str  # "image", "view match", "path integration", "injection", ...
    title: str
    words: str  # what it did, in a sentence


@dataclass(frozen=True, slots=True)
class TickWalk:
    """A tick shown stage by stage. The snapshot's pose cells, map and estimate are those of stage `at`."""

    stages: tuple[TickStage, ...]
    at: int
