"""One run, from a reset to the next: a session, what happened in it, and the snapshots of both."""

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
    """ValueError says why it cannot begin."""

    def __init__(
        self, number: int, world: World, seed: int, config: Config, titles: tuple[tuple[str, str], ...],
        brain: RatSlam | None = None, before: Session | None = None,
    ) -> None:  # fmt: skip
        """titles: names and titles of all worlds. brain, before: as in Session."""
        self.number = number
        self.session = Session(world, seed, config, brain, before)
        self.history = History(self.session)
        self.snapshots = Snapshots(self.session, self.history, number, titles)
        if brain is not None:  # a foreign one has to be such that it can be shown
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
        """One tick, and what is to be noted of it. What makes anything infinite or no number is thrown."""
        self.snapshots.walk = None
        self.session.tick(recorder)
        require_finite(self.session)
        self.history.watch()

    def walk(self, back: bool) -> bool:
        """To the next stage of the tick that is shown, or to the one before; False: there is none."""
        shown = self.snapshots.walk
        following = None if shown is None else shown.moved(-1 if back else 1)
        if following is None:
            return False
        self.snapshots.refresh()
        self.snapshots.walk = following
        return True

    def recorder(self) -> TickRecorder:
        """For the next tick, so that it can be walked through."""
        self.snapshots.refresh()
        return TickRecorder(self.session, self.snapshots.parts())

    def show(self, recorder: TickRecorder) -> None:
        """The first stage of the tick that was recorded."""
        self.snapshots.refresh()
        self.snapshots.walk = recorder.walk(self.snapshots.parts())
