"""What has happened in a run so far, for people to look at. It watches the session and never changes it."""

from __future__ import annotations

from app.session import Session
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

    CACHES = ("log",)

    def __init__(self, session: Session) -> None:
        self.log = EventLog(session)
        self.events = EventWatch(session, self.log)
        self.trails, self.visits, self.series = Trails(session), VisitLog(session), RunSeries(session)

    def settle(self, session: Session, log: EventLog, last_snap: Snap | None) -> None:
        """Go on in a history that was restored with this session. Its events are noted in this log."""
        self.log = log
        self.events.settle(session, log, last_snap)
        for part in (self.trails, self.visits, self.series):
            part.settle(session)

    def watch(self) -> None:
        self.log.of_tick = True
        for part in (self.trails, self.visits, self.events, self.series):
            part.watch()
        self.log.of_tick = False
