"""The outcome of a command: accepted, refused, or answered later."""

from __future__ import annotations

from dataclasses import dataclass

from web.messages import Accepted, Refused


@dataclass(frozen=True, slots=True)
class Later:
    """The command is answered after `ticks` more ticks."""

    ticks: int


@dataclass(frozen=True, slots=True)
class Working:
    """The command is answered when the work that it has begun is done."""


Outcome = Accepted | Refused | Later | Working | None  # None: accepted, with no result to return
