"""The run that is open, with its branches and what waits for its ticks; and how another run takes its place."""

from __future__ import annotations

import traceback
from collections.abc import Callable

from app.config import Config
from app.engine.library import Library
from app.engine.pace import Pace
from app.engine.run import Run
from app.engine.time_travel import TimeTravel
from app.engine.waiting import Steps
from app.engine.watchdog import Watchdog, words_of
from app.engine.work import Slices, Work
from app.runs.book import Book, Fork
from app.runs.header import Beginning
from app.runs.keeper import RunKeeper
from app.runs.run_file import KeptRun
from app.session import Session
from app.time_machine import PastRoom
from app.views.snapshots import PairChoices
from app.world_editor import WorldEditor
from ratslam_core import RatSlam
from sim2d import World
from web import messages as m


class CurrentRun:
    """To be used from one thread only."""

    def __init__(
        self,
        world: World,
        pace: Pace,
        watchdog: Watchdog,
        *,
        running: bool,
        answer: Callable[[m.Request, m.Accepted | m.Refused], None],
        keeper: RunKeeper | None = None,
        past_room: PastRoom | None = None,
    ) -> None:
        """answer: is called for each request whose ticks are done or were broken off. keeper: keeps each run on disk.

        past_room: for what looking back takes.
        """
        self.library, self.editor = Library(world), WorldEditor(world)
        self.pace, self.steps, self._pairs = pace, Steps(), PairChoices()
        self.slices = Slices(answer, self._leave_past)
        self.running = running
        self.fault: str | None = None
        self._run: Run | None = None
        self._time: TimeTravel | None = None
        self._watchdog, self._answer, self._keeper = watchdog, answer, keeper
        self._past_room = past_room

    @property
    def run(self) -> Run:
        """The live one."""
        assert self._run is not None
        return self._run

    @property
    def time(self) -> TimeTravel:
        assert self._time is not None
        return self._time

    @property
    def shown(self) -> Run:
        """The run as it is shown: the live one, or a moment of its past."""
        return self.run if self.time.past is None else self.time.past

    @property
    def world(self) -> World:
        """The office of the session; while a recording plays, the one that was open before."""
        session = self.run.session
        return session.world if session.recording is None else self.editor.world

    @property
    def next_config(self) -> Config:
        """For the next run: the parameters as they are now, or as they were before a trial set them."""
        return self.run.config_before or self.run.session.config

    @property
    def config_to_begin(self) -> Config:
        """That of a run that begins again as this one: what a trial has set goes with it when it is over."""
        return self.run.session.config if self.run.trial is None or self.trial_plays else self.next_config

    @property
    def trial_plays(self) -> bool:
        """Whether the run carries out a trial that is not over."""
        return self.run.trial is not None and self.run.trial.state == "running"

    # ------------------------------------------------------------ waiting for it

    def work(self, work: Work) -> bool:
        """Do this in slices, instead of any other work. True when all is done already."""
        return self.slices.begin(work, self.shown.session.tick_count)

    def work_on(self) -> None:
        self.slices.go_on(lambda: self.shown.session.tick_count)

    def break_off(self) -> None:
        """Drop the remaining ticks. Whoever waits for them is answered with the tick that was reached."""
        if self._run is not None:
            self.slices.drop(self.shown.session.tick_count, unless_still=True)
        self._accept(self.steps.end())
        if self._run is not None:
            self._run.stop_running_ahead()

    def _accept(self, requests: list[m.Request]) -> None:
        for request in requests:
            self._answer(request, m.Accepted(self.shown.session.tick_count))

    def _leave_past(self, error: BaseException) -> None:
        """A moment could not be played again. The present is not touched by that."""
        traceback.print_exception(error)
        self.running = False
        self.break_off()
        self.time.back_to_now()
        self.run.event_log.note("fault", f"the past could not be played again: {words_of(error)}")

    # ------------------------------------------------------------ another in its place

    def _make_run(self, session: Session, beginning: Beginning | KeptRun | None, brain: RatSlam | None = None) -> Run:
        run = Run(self._next_number, session, self.library.titles)
        run.book = self._book(session, beginning, brain)
        run.beginning, run.first_brain = beginning, brain
        return run

    def _book(
        self, session: Session, beginning: Beginning | KeptRun | Fork | None, brain: RatSlam | None = None
    ) -> Book | None:
        return None if self._keeper is None or beginning is None else self._keeper.book(session, beginning, brain)

    @property
    def _next_number(self) -> int:
        return self._time.last_number + 1 if self._time else 1

    def _change_to(self, run: Run, world: World) -> Run:
        self._time = TimeTravel(run, self._past_room)
        return self._go_on_with(run, world)

    def _go_on_with(self, run: Run, world: World) -> Run:
        if self._run is not None:
            self.slices.drop(self.run.session.tick_count)
        self.break_off()
        self.library.close(world.name)
        run.snapshots.worlds = self.library.titles
        self.editor.begin(world)
        self.running = self.running or self.fault is not None
        self._run, self.fault = run, None
        if self._keeper is not None and run.book is not None:
            self._keeper.begin(run.book)
        self.pace.begin()
        return run
