"""Loop closures with the map before and after each of them, so that a correction can be marked and played again slowly.

Kept beside the events, since they belong to what has happened. Nothing of it is read by the session.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from app.views.arrays import frozen
from app.views.event_log import EventLog
from web.messages import Closure, Event

SETTLES_S = (
    15.0  # a map is solved every 5 s: after three of them, or at the next closure, its correction counts as over
)
EVERY_S = 1.0  # how often the map after a closure is taken anew until then
MOST = 12  # closures are kept

Places = NDArray[np.float32]  # (n, 2), map frame


class Closures:
    """Call `watch` after each tick, and `closed` when a loop has closed in it."""

    def __init__(self, session: Session, log: EventLog) -> None:
        self._session, self._log = session, log
        self._before = self._now = self._places()
        self._until_s = self._due_s = -math.inf

    def watch(self) -> None:
        self._before, self._now = self._now, self._places()
        if self._due_s <= self._session.time_s <= self._until_s and self._log.closures:
            self._due_s = self._session.time_s + EVERY_S
            self._take()

    def closed(self, event: Event, start: int, end: int) -> None:
        """The robot came from experience `start` to `end`, which it had made long before: they are linked."""
        links = self._session.brain.experience_map.links.astype(np.int32)
        known = (links < len(self._before)).all(1)
        closure = Closure(event.number, event.time_s, start, end, frozen(links[known]), self._before, self._before)
        self._log.closures = (*self._log.closures[-MOST + 1 :], closure)
        self._until_s, self._due_s = event.time_s + SETTLES_S, event.time_s
        self._take()

    def _take(self) -> None:
        """Where the experiences are now that were there before the newest closure."""
        closure = self._log.closures[-1]
        before = closure.before_xy[: len(self._now)]
        after = frozen(self._now[: len(before)])
        moved = float(np.hypot(*(after - before).T).max(initial=0.0))
        self._log.closures = (*self._log.closures[:-1], replace(closure, after_xy=after, moved_m=moved))

    def _places(self) -> Places:
        return frozen(self._session.brain.experience_map.poses[:, :2].astype(np.float32))
