"""A trial that was run: what it was, and its scores."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StoredTrial:
    """One row of the store. A trial that failed has an error, no scores, and is run again by the next command."""

    id: str
    engine: str
    levels: tuple[str, ...]  # of each axis, by label
    seed: int
    scores: dict[str, float]
    moment_s: float  # simulated time of the moment that decided the trial
    moment_words: str
    simulated_s: float = 0.0
    wall_s: float = 0.0
    error: str = ""
    version: str = ""  # of the code
    quick: bool = False
