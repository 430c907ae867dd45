"""One run, from one reset to the next: a session, its history, and the snapshots of both."""

from __future__ import annotations

from app.config import Config
from app.engine.faults import require_finite
from app.session import Session
from app.views.event_log import EventLog
from app.views.history import History
from app.views.snapshots import Snapshots
from app.views.tick_stages import TickRecorder
from app.views.visits import VisitLog
from ratslam_core import RatSlam
from sim2d import World


class Run:
    """A session with its history and snapshots. ValueError says why it cannot begin."""

    def __init__(
        self, number: int, world: World, seed: int, config: Config, titles: tuple[tuple[str, str], ...],
        brain: RatSlam | None = None, before: Session | None = None,
    ) -> None:  # fmt: skip
        """titles: names and titles of all worlds. brain, before: as in Session."""
        self.number = number
        self.session = Session(world, seed, config, brain, before)
        self.history = History(self.session)
        self.snapshots = Snapshots(self.session, self.history, number, titles)
        if brain is not None:  # a foreign brain must be one that can be shown: try it before it is accepted
            self.snapshots.build(running=False, speed=1.0, real_time_factor=0.0, fault=None)
        for words in config.warnings:
            self.event_log.note("warning", words)

    @property
    def event_log(self) -> EventLog:
        return self.history.log

    @property
    def visits(self) -> VisitLog:
        return self.history.visits

    def tick(self, recorder: TickRecorder | None = None) -> None:
        """Run one tick and record it in the history. FloatingPointError if anything is no longer finite."""
        self.snapshots.walk = None
        self.session.tick(recorder)
        require_finite(self.session)
        self.history.watch()

    def walk(self, back: bool) -> bool:
        """Show the next stage of the recorded tick, or the previous one. False if there is none."""
        shown = self.snapshots.walk
        following = None if shown is None else shown.moved(-1 if back else 1)
        if following is None:
            return False
        self.snapshots.refresh()
        self.snapshots.walk = following
        return True

    def recorder(self) -> TickRecorder:
        """A recorder for the next tick, so that its stages can be shown one by one."""
        self.snapshots.refresh()
        return TickRecorder(self.session, self.snapshots.parts())

    def show(self, recorder: TickRecorder) -> None:
        """Show the first stage of the tick that was recorded."""
        self.snapshots.refresh()
        self.snapshots.walk = recorder.walk(self.snapshots.parts())
