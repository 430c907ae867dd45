"""How a trial ended: with a result, or with an error."""

from __future__ import annotations

from dataclasses import dataclass

from app.trials.trial import Result


@dataclass(frozen=True, slots=True)
class Outcome:
    """Of the trial with this id. Exactly one of result and error is given."""

    trial_id: str
    result: Result | None = None
    error: str = ""  # in words
