"""Events: the marks on the timeline."""

from __future__ import annotations

from app.session import Session
from web.messages import Event, EventKind

MOST_EVENTS = 500


class EventLog:
    """Keeps the newest events."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.events: tuple[Event, ...] = ()
        self._number = 0

    def note(self, kind: EventKind, text: str) -> Event:
        self._number += 1
        event = Event(self._number, self._session.time_s, kind, text)
        self.events = (*self.events[-MOST_EVENTS:], event)
        return event
