"""When each experience and each view was first and last active, and how often it became active."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from disk import kind
from web.messages import Times


@kind("visits/1")
class Visits:
    """Visits of experiences, or of views. Those that a brain brought with it have no times until they are met again."""

    def __init__(self) -> None:
        self._first_s, self._last_s = np.full(1024, np.nan), np.full(1024, np.nan)
        self._count = np.zeros(1024, np.int64)
        self._active = -1

    def note(self, number: int, time_s: float) -> None:
        """The experience or view that is active now; -1: none."""
        if number >= len(self._count):
            more = max(number + 1, 2 * len(self._count)) - len(self._count)
            self._first_s, self._last_s = (np.append(a, np.full(more, np.nan)) for a in (self._first_s, self._last_s))
            self._count = np.append(self._count, np.zeros(more, np.int64))
        if number >= 0:
            if self._count[number] == 0:
                self._first_s[number] = time_s
            self._last_s[number] = time_s
            self._count[number] += number != self._active
        self._active = number

    @property
    def first_s(self) -> NDArray[np.float64]:
        """When each was active first, simulated seconds; NaN: never."""
        return self._first_s

    def of(self, number: int) -> Times:
        if number >= len(self._count) or self._count[number] == 0:
            return Times(None, None, 0)
        return Times(float(self._first_s[number]), float(self._last_s[number]), int(self._count[number]))


@kind("visit_log/1")
class VisitLog:
    """Call `watch` after each tick."""

    CACHES = ("_session",)

    def __init__(self, session: Session) -> None:
        self._session = session
        self.experiences, self.views = Visits(), Visits()
        self.watch()

    def settle(self, session: Session) -> None:
        """Go on in a history that was restored."""
        self._session = session

    def watch(self) -> None:
        session = self._session
        self.experiences.note(session.brain.experience_map.active, session.time_s)
        self.views.note(session.estimate.recognition.view, session.time_s)
