"""What an export needs of a run: it can be played again, and a stretch of it can be chosen."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

from app.session import Session

Progress = Callable[[float, str], None]  # simulated seconds since the last call, what is being done
_CLOSE_S = 1e-6  # the times of ticks are rounded, those that people give are not


class Played(Protocol):
    """A run that was kept, or that can be made again in another way."""

    def replay(self, until: int | None = None) -> Iterator[Session]:
        """The session before its first tick and after each tick up to this one, always the same object. The orders of a
        tick are carried out after it was handed out."""
        ...


@dataclass(frozen=True, slots=True)
class Window:
    """A stretch of a run in simulated seconds, both ends within. ValueError when it is none."""

    from_s: float = 0.0
    until_s: float = math.inf

    def __post_init__(self) -> None:
        if not 0 <= self.from_s < math.inf:
            raise ValueError(f"--from must be a number of seconds from 0 on, got {self.from_s:g}")
        if not self.until_s >= self.from_s:
            raise ValueError(f"--until must not be before --from ({self.from_s:g} s), got {self.until_s:g}")

    def holds(self, time_s: float) -> bool:
        return self.from_s - _CLOSE_S <= time_s <= self.until_s + _CLOSE_S


def ticks_in(run: Played, window: Window, progress: Progress, what: str) -> Iterator[Session]:
    """The session after each tick of the window. ValueError when the run ended before it."""
    said_s = end_s = 0.0
    some = False
    for session in run.replay():
        end_s = session.time_s
        if end_s - said_s >= 1.0:
            progress(end_s - said_s, what)
            said_s = end_s
        if window.holds(end_s):
            some = True
            yield session
        if end_s + session.frame.dt > window.until_s + _CLOSE_S:  # the next tick would be in the same object
            break
    if not some:
        raise ValueError(f"the run is {end_s:g} s long, so there is nothing in it from {window.from_s:g} s on")


def last_of(ticks: Iterator[Session]) -> Session:
    """The session as it is after the last tick."""
    session = None
    for session in ticks:  # noqa: B007
        pass
    assert session is not None
    return session
