"""What has happened in a run so far, for people to look at. It watches the session and never changes it."""

from __future__ import annotations

from app.session import Session
from app.views.beside_history import BesideHistory
from app.views.event_log import EventLog
from app.views.event_watch import EventWatch
from app.views.series import RunSeries
from app.views.trails import Trails
from app.views.visits import VisitLog
from disk import kind
from web.messages import Snap


@kind("history/1")
class History:
    """Call `watch` after each tick."""

    CACHES = ("log", "_session")

    def __init__(self, session: Session) -> None:
        self._session, self.log = session, EventLog(session)
        self.events = EventWatch(session, self.log)
        self.trails, self.visits, self.series = Trails(session), VisitLog(session), RunSeries(session)
        self.beside: BesideHistory | None = None  # of the second brain, while there is one

    def settle(self, session: Session, log: EventLog, last_snap: Snap | None) -> None:
        """Go on in a history that was restored with this session. Its events are noted in this log."""
        self._session, self.log = session, log
        if self.beside is not None:
            self.beside.settle()
        self.events.settle(session, log, last_snap)
        for part in (self.trails, self.visits, self.series):
            part.settle(session)

    def watch(self) -> None:
        self.log.of_tick = True
        for part in (self.trails, self.visits, self.events, self.series):
            part.watch()
        self.watch_companion()
        if self.beside is not None:
            self.beside.watch(self._session)
        self.log.of_tick = False

    def watch_companion(self) -> None:
        """To be called when there is another second brain, too, so that it is shown before the next tick."""
        companion = self._session.companion
        if companion is None:
            self.beside = None
        elif self.beside is None or self.beside.of is not companion:
            self.beside = BesideHistory(self._session, companion)
