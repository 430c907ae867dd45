"""Events, the marks on the timeline, and what is kept beside them for people. Nothing of it is read by the session."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from app.views.arrays import frozen
from web.messages import Closure, Event, EventKind, WhyReport

MOST_EVENTS = 2000


class EventLog:
    """Keeps the newest events, and with them why they happened and what they did to the map."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.events: tuple[Event, ...] = ()
        self.of_tick = False  # whether what is noted belongs to the tick, and not to an order after it
        self.why: dict[int, WhyReport] = {}  # by the numbers of events
        self.closures: tuple[Closure, ...] = ()  # of late, with the map before and after each
        self._number = 0
        self._counted: list[Event] = []  # those in whose place a newer one of their line stands, for the past
        self._of_ticks: set[int] = set()

    def note(self, kind: EventKind, text: str, line: str = "") -> Event:
        """line: a name for what repeats. The event then takes the place of the last one of this line, and counts it."""
        self._number += 1
        event = Event(self._number, self._session.time_s, kind, text, line)
        last = next((other for other in reversed(self.events) if line and other.line == line), None)
        if last is not None:
            event = replace(event, count=last.count + 1, since_s=last.time_s if last.since_s is None else last.since_s)
            self._counted = [*self._counted[-MOST_EVENTS:], last]
        self.events = (*(other for other in self.events[-MOST_EVENTS:] if other is not last), event)
        if self.of_tick:
            self._of_ticks.add(self._number)
        return event

    def until(self, time_s: float, session: Session) -> EventLog:
        """Another log, of this session, with the events up to the end of the tick at this simulated time, without
        those of the orders after it."""
        cut = EventLog(session)
        known = sorted((*self._counted, *self.events), key=lambda event: event.number)
        known = [event for event in known if self._is_before(event, time_s)]
        newest = {event.line or event.number: event for event in known}
        cut.events = tuple(event for event in known if newest[event.line or event.number] is event)
        cut._counted = [event for event in known if newest[event.line or event.number] is not event]
        cut.why = {event.number: self.why[event.number] for event in cut.events if event.number in self.why}
        kept = {event.number for event in cut.events}
        cut.closures = tuple(closure for closure in self.closures if closure.event in kept)
        cut._number, cut._of_ticks = self._number, set(self._of_ticks)  # no number is given twice
        return cut

    def _is_before(self, event: Event, time_s: float) -> bool:
        if abs(event.time_s - time_s) < 1e-9:
            return event.number in self._of_ticks
        return event.time_s < time_s


SETTLES_S = 15.0  # a map is solved every 5 s: after three times, or at the next closure, its correction is over
EVERY_S = 1.0  # how often the map after a closure is taken anew until then
MOST = 12  # closures are kept

_Places = NDArray[np.float32]  # (n, 2), map frame


class Closures:
    """Loop closures with the map before and after each, so that a correction can be marked and played again slowly.

    Call `watch` after each tick, and `closed` when a loop has closed in it.
    """

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

    def _places(self) -> _Places:
        return frozen(self._session.brain.experience_map.poses[:, :2].astype(np.float32))
