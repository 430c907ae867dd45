"""Brains that are worth comparing with the first as it is now, as choices of the page. app/config/pairs.py makes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Since = Literal["beginning", "now"]


@dataclass(frozen=True, slots=True)
class PairChoice:
    """since: the run begins anew with both, or goes on with a copy that can become such a brain while it runs."""

    name: str
    title: str
    about: str
    since: Since


@dataclass(frozen=True, slots=True)
class AdditionsOff:
    """Our additions that the first brain lacks, by name: if it began again, and as it runs."""

    beginning: tuple[str, ...] = ()
    now: tuple[str, ...] = ()
