"""One run, from one reset to the next: a session, its history, and the snapshots of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.config import Config
from app.engine.lesson_supervisor import LessonSupervisor
from app.engine.situation_replay import SituationReplay
from app.engine.supervisor import Supervisor
from app.engine.waiting import RunUntil
from app.engine.watchdog import require_finite
from app.engine.watched_trial import WatchedTrial
from app.orders import Order
from app.run_record.bookmarks import Bookmarks
from app.run_record.header import Beginning
from app.run_record.keyframes import TimeMachine
from app.run_record.reader import KeptRun
from app.run_record.writer import RunFeed
from app.session import Session
from app.views.events import EventLog
from app.views.history import History, VisitLog
from app.views.snapshots import Snapshots
from app.views.tick_stages import TickRecorder
from sim2d import World

if TYPE_CHECKING:
    from app.engine.time_travel import TimeTravel


@dataclass(frozen=True, slots=True)
class Before:
    """The run that waits while a lesson, a trial or a situation has its place."""

    run: Run
    time: TimeTravel
    world: World
    running: bool
    speed: float


class Run:
    """A session with its history and snapshots."""

    def __init__(
        self, number: int, session: Session, titles: tuple[tuple[str, str], ...], history: History | None = None
    ) -> None:
        """titles: names and titles of all worlds. history: of a session that has one already."""
        self.number, self.session = number, session
        self.machine: TimeMachine | None = None  # keeps, from some tick on, what is needed to go back to any other
        self.trial: WatchedTrial | None = None
        self.replay: SituationReplay | None = None  # a situation that was opened
        self.beginning: Beginning | KeptRun | None = (
            None  # None: of a recording, and of a branch, which has its parent's
        )
        self.lesson: LessonSupervisor | None = None
        self.until: RunUntil | None = None  # what `run_until` waits for
        self.config_before: Config | None = None  # a trial's settings go with it
        self.before: Before | None = None
        self.feed: RunFeed | None = None  # of who keeps the run
        self.bookmarks = Bookmarks()
        self.history = history or History(self.session)
        self.snapshots = Snapshots(self.session, self.history, number, titles)
        if history is None:
            for words in session.warnings:
                self.event_log.note("warning", words)
        session.on_order = self._note_order

    def _note_order(self, order: Order) -> None:
        if self.feed is not None:
            self.feed.order(order)
        if self.machine is not None:
            self.machine.note_order(order)

    def keep_bookmarks(self) -> None:
        if self.feed is not None:
            self.feed.mark(self.bookmarks.rows)

    @property
    def event_log(self) -> EventLog:
        return self.history.log

    @property
    def visits(self) -> VisitLog:
        return self.history.visits

    def tick(self, recorder: TickRecorder | None = None) -> None:
        """Run one tick and record it in the history. FloatingPointError if anything is no longer finite."""
        self.snapshots.walk = None
        if self.until is not None and not self.until.runs_ahead:
            self.until = None
        for supervisor in self.supervisors:
            supervisor.before_tick()
        self.session.tick(recorder)
        require_finite(self.session)
        if self.feed is not None:
            self.feed.tick(self.session)
        self.history.watch()
        if self.machine is not None:  # before the supervisors' orders, which come after this tick
            self.machine.ticked()
        for supervisor in self.supervisors:
            supervisor.after_tick()

    @property
    def runs_ahead(self) -> bool:
        """Whether a supervisor asks for the highest speed."""
        return any(supervisor.runs_ahead for supervisor in self.supervisors)

    def stop_running_ahead(self) -> None:
        for supervisor in self.supervisors:
            supervisor.stop_running_ahead()

    def take_pause_request(self) -> bool:
        """Whether a supervisor asks for a pause. One-shot: asking clears it."""
        pausing = [supervisor for supervisor in self.supervisors if supervisor.pause_requested]
        for supervisor in pausing:
            supervisor.pause_requested = False
        if self.lesson is not None and self.lesson.inspects is not None:
            self.snapshots.inspected, self.lesson.inspects = self.lesson.inspects, None
            self.snapshots.refresh()  # that of this tick may have been built already
        return bool(pausing)

    @property
    def supervisors(self) -> list[Supervisor]:
        return [
            supervisor for supervisor in (self.trial, self.lesson, self.until, self.replay) if supervisor is not None
        ]

    def require_showable(self) -> None:
        """Build a snapshot, to raise what would be raised later."""
        self.snapshots.build(running=False, speed=1.0, real_time_factor=0.0, fault=None)

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
