"""The outcome of a command: accepted, refused, or answered later."""

from __future__ import annotations

from collections.abc import Callable
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


def attempt(field: str, value: object, order: Callable[[], object]) -> Refused | None:
    """Call `order`. If it raises ValueError, return a refusal with this field, its value and the reason."""
    try:
        order()
    except ValueError as error:
        return Refused(field, value, str(error))
    return None
