"""Events: the marks on the timeline."""

from __future__ import annotations

from app.session import Session
from web.messages import Closure, Event, EventKind, WhyReport

MOST_EVENTS = 2000


class EventLog:
    """Keeps the newest events."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.events: tuple[Event, ...] = ()
        self.of_tick = False  # whether what is noted belongs to the tick, and not to an order after it
        self.why: dict[int, WhyReport] = {}  # by the numbers of events
        self.closures: tuple[Closure, ...] = ()  # of late, with the map before and after each
        self._number = 0
        self._of_ticks: set[int] = set()

    def note(self, kind: EventKind, text: str) -> Event:
        self._number += 1
        event = Event(self._number, self._session.time_s, kind, text)
        self.events = (*self.events[-MOST_EVENTS:], event)
        if self.of_tick:
            self._of_ticks.add(self._number)
        return event

    def until(self, time_s: float, session: Session) -> EventLog:
        """Another log, of this session, with the events up to the end of the tick at this simulated time, without those of
        the orders after it."""
        cut = EventLog(session)
        cut.events = tuple(event for event in self.events if self._is_before(event, time_s))
        cut.why = {event.number: self.why[event.number] for event in cut.events if event.number in self.why}
        kept = {event.number for event in cut.events}
        cut.closures = tuple(closure for closure in self.closures if closure.event in kept)
        cut._number, cut._of_ticks = self._number, set(self._of_ticks)  # no number is given twice
        return cut

    def _is_before(self, event: Event, time_s: float) -> bool:
        if abs(event.time_s - time_s) < 1e-9:
            return event.number in self._of_ticks
        return event.time_s < time_s
