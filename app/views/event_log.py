"""Events: the marks on the timeline."""

from __future__ import annotations

from app.session import Session
from web.messages import Event, EventKind

MOST_EVENTS = 2000


class EventLog:
    """Keeps the newest events."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.events: tuple[Event, ...] = ()
        self._number = 0

    def note(self, kind: EventKind, text: str) -> None:
        self._number += 1
        self.events = (*self.events[-MOST_EVENTS:], Event(self._number, self._session.time_s, kind, text))

    def until(self, time_s: float, session: Session) -> EventLog:
        """Another log, of this session, with the events up to this time. Simulated seconds."""
        cut = EventLog(session)
        cut.events = tuple(event for event in self.events if event.time_s <= time_s + 1e-9)
        cut._number = self._number  # no number is given twice
        return cut
