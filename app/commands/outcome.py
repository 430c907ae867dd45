"""What becomes of a command."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from web.messages import Accepted, Refused


@dataclass(frozen=True, slots=True)
class Later:
    """It is answered when so many ticks are done."""

    ticks: int


Outcome = Accepted | Refused | Later | None  # None: it has taken effect, and there is nothing more to tell


def attempt(field: str, value: object, order: Callable[[], object]) -> Refused | None:
    """Do it; where it cannot be, the field to blame, its value and the reason."""
    try:
        order()
    except ValueError as error:
        return Refused(field, value, str(error))
    return None
