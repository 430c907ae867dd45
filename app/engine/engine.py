"""What commands act on: the run that is open with its branches, whether it plays, and who waits for its ticks. It depends
on neither queue nor page."""

from __future__ import annotations

import contextlib
import math
import time
import traceback
from collections.abc import Callable

from app.config import Config
from app.engine.lesson_supervisor import LessonSupervisor, Teaching
from app.engine.library import Library
from app.engine.pace import Pace
from app.engine.run import Before, Run
from app.engine.situation_replay import SituationReplay
from app.engine.time_travel import TimeTravel
from app.engine.waiting import Steps
from app.engine.watchdog import Watchdog, words_of
from app.engine.watched_trial import WatchedTrial
from app.engine.work import Slices, Work
from app.protocol.lesson_round import session_of
from app.protocol.trial import Trial
from app.recordings.playing import Player
from app.run_record.bookmarks import read_bookmarks
from app.run_record.header import Beginning, beginning_of, recorded_beginning
from app.run_record.keyframes import PastRoom
from app.run_record.reader import KeptRun
from app.run_record.situation import Situation
from app.run_record.writer import Fork, RunFeed, RunKeeper
from app.session import Session, played_session
from app.views.snapshots import PairChoices
from app.views.tick_stages import TickRecorder
from app.world_editor import WorldEditor
from disk import copy_state
from ratslam_core import RatSlam
from sim2d import World
from web import messages as m


class Engine:
    """To be used from one thread only; which one does not matter. If another run cannot take the place of the one that is
    open, that one is left as it is."""

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
        return self.run.session.source.world or self.editor.world

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

    # ------------------------------------------------------------ ticks

    def tick(self, recorder: TickRecorder | None = None) -> bool:
        """Run one tick. True if something happened that has to be shown at once.

        An exception pauses the session and is shown as a fault. A tick that hung but ended is noted in the event log.
        """
        if self.run.session.source.over and self.time.past is None:
            return self._pause_at_end()
        lesson = self.run.lesson
        if lesson is not None and lesson.round_over and self.time.past is None:
            self.begin_lesson(lesson.next_round(), at_once=True)
            return True
        playing, live = self.trial_plays, self.time.past is None
        self._watchdog.begin()
        try:
            if self.time.past is None:
                self.run.tick(recorder)
            elif self.time.play(recorder):
                self.running = False  # it has come to the present
                self.break_off()
        except BaseException as error:
            self._watchdog.end()
            if self.time.past is None:
                self.fail(error)
            else:
                self._leave_past(error)
            return True
        self._pause_after_trial(playing)
        pauses = live and self.run.take_pause_request()
        if pauses:
            self.running = False
            self.break_off()
        over = live and self.run.session.source.over and self._pause_at_end()
        hung = self._watchdog.end()
        if hung:
            self.run.event_log.note("fault", f"a tick took more than {self._watchdog.limit_s:g} s", "slow tick")
        return hung or over or pauses or self.trial_plays != playing

    def step(self) -> bool:
        """Run one of the ticks that were asked for. Returns the same as `tick`."""
        to_show = self.tick()
        if self.fault is None and self.steps:
            self._accept(self.steps.ticked())
        return to_show

    @property
    def runs_ahead(self) -> bool:
        """Whether the run is to go on, as fast as possible, to some moment."""
        return self.run.runs_ahead and self.time.past is None

    def run_ahead(self, for_s: float) -> bool:
        """Run ticks for so long (wall time), or until the moment has come; from there a trial plays in real time.

        True if something has to be shown at once.
        """
        until_s, to_show = time.perf_counter() + for_s, False
        while self.runs_ahead and not to_show and time.perf_counter() < until_s:
            to_show = self.tick()
        if self.runs_ahead:
            return to_show
        if self.run.trial is not None and self.run.until is None:
            self.pace.speed = 1.0
        self.pace.hurry()
        self.run.snapshots.refresh()
        return True

    def _pause_after_trial(self, played: bool) -> None:
        """Pause once when a trial has just ended; the user may go on from there."""
        trial = self.run.trial
        if played and trial is not None and trial.state == "over":
            self.running = False
            self.break_off()

    # ------------------------------------------------------------ stopping

    def _pause_at_end(self) -> bool:
        """The recording has ended. True, since that has to be shown."""
        self.running = False
        self.run.event_log.note("recording", "the recording has ended")
        self.break_off()
        return True

    def pause_for(self, kind: str) -> m.Refused | None:
        """Pause, to carry out a command of this kind. Refused after a fault."""
        if self.fault is not None and self.time.past is None:
            return m.Refused("type", kind, f"the session stopped at a fault ({self.fault}); reset it")
        if self.run.session.source.over and self.time.past is None:
            return m.Refused("type", kind, "the recording has ended; restart it to see it from its beginning")
        self.running = False
        self.slices.drop(self.shown.session.tick_count, unless_still=True)
        self.run.stop_running_ahead()
        return None

    def leave(self) -> None:
        """The program ends: nothing runs the session any more."""
        self.break_off()
        if self._run is not None and self._run.feed is not None:
            self._run.feed.leave(self._run.session)

    def fail(self, error: BaseException) -> None:
        """Stop at a fault. A fault that repeats is reported once."""
        words = words_of(error)
        new, self.fault, self.running = words != self.fault, words, False
        if new:
            with contextlib.suppress(Exception):  # there may be nobody to print to
                traceback.print_exception(error)
        self.break_off()
        if self._run is not None and self._run.feed is not None:
            self._run.feed.end(f"it stopped at a fault: {words}")
        if new and self._run is not None:
            self._run.event_log.note("fault", words)

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

    # ------------------------------------------------------------ another run in its place

    def begin(self, world: World, seed: int, config: Config, brain: RatSlam | None = None) -> Run:
        """Begin another run. If that fails, the old run is left as it is. ValueError says why."""
        old = self._run
        before = None if old is None or self.fault is not None else old.session  # after a fault it may be half changed
        kept = None if brain is None else copy_state(brain)  # the session will go on with the brain itself
        session = Session(world, seed, config, brain, before)
        run = self._make_run(session, beginning_of(session, brain=kept))
        if brain is not None:  # a foreign brain must be one that can be shown: try it before it is accepted
            run.require_showable()
        return self._change_to(run, world)

    def begin_trial(self, trial: Trial, title: str, moment_s: float | None = None) -> Run:
        """Begin a run that carries out the trial of an experiment, and play it.

        title: of the experiment. moment_s: simulated time of a moment; the trial is first run ahead to shortly before it.
        If that fails, the old run is left as it is. ValueError says why.
        """
        course = trial.begin()
        run = self._make_run(course.session, beginning_of(course.session, trial=title))
        run.trial = WatchedTrial(trial, title, course, run.event_log, moment_s)
        run.config_before, run.before = None if self._run is None else self.next_config, self._let_wait()
        world = course.session.world
        if world.name not in dict(self.library.titles):
            self.library.add(world)
        self._change_to(run, world)
        self.running = True
        return run

    def begin_lesson(self, teaching: Teaching, at_once: bool = False) -> Run:
        """Begin the run of the lesson's round: its scene is run ahead. at_once: it then happens without waiting.

        If that fails, the old run is left as it is. ValueError says why.
        """
        session = session_of(teaching.lesson, teaching.number, teaching.seed)
        run = self._make_run(session, beginning_of(session, trial=f"the lesson {teaching.lesson.title}"))
        run.lesson = LessonSupervisor(teaching, session, run.history, at_once=at_once)
        run.config_before, run.before = teaching.config_before, self._let_wait()
        if session.world.name not in dict(self.library.titles):
            self.library.add(session.world)
        self._change_to(run, session.world)
        self.pace.speed, self.running = run.lesson.speed, True
        return run

    def go_on(self, kept: KeptRun, session: Session) -> Run:
        """Go on with a run that was kept, in this session: the one where it was left. ValueError says why that fails."""
        run = self._make_run(session, kept)
        run.bookmarks = read_bookmarks(kept.folder)
        world = session.source.world
        if world is None:
            run.config_before = Config() if self._run is None else self.next_config
        run.require_showable()
        run.event_log.note("brain", f"the run goes on where it was left, {session.time_s:.1f} s after its beginning")
        if kept.header.trial:
            run.event_log.note(
                "warning", f"{kept.header.trial} does not go on with the run: the robot has no orders of it"
            )
        if world is not None and world.name not in dict(self.library.titles):
            self.library.add(world)
        return self._change_to(run, world or self.editor.world)

    def begin_recording(self, player: Player, seed: int | None = None) -> Run:
        """Begin a run that plays a recording from its beginning. If that fails, the old run is left as it is. ValueError
        says why."""
        session = played_session(player, seed)
        run = self._make_run(session, recorded_beginning(session, player))
        run.config_before = Config() if self._run is None else self.next_config
        run.require_showable()
        return self._change_to(run, self.editor.world)

    def open_situation(self, situation: Situation) -> Run:
        """Begin a run that plays a situation up to its moment, as fast as possible. The run before waits: if that is
        stopped, it goes on. ValueError says why it cannot begin; then the old run is left as it is."""
        brain = situation.first_brain()
        kept = None if brain is None else copy_state(brain)
        session = situation.begin(brain)
        run = self._make_run(session, beginning_of(session, brain=kept, trial=situation.header.trial))
        run.require_showable()
        run.before = self._let_wait()
        if session.world.name not in dict(self.library.titles):
            self.library.add(session.world)
        self._change_to(run, session.world)
        self.running = False
        run.replay = SituationReplay(situation, session, run.event_log)
        run.replay.after_tick()
        return run

    def _let_wait(self) -> Before | None:
        """The run that waits while another has its place; after a fault there is none to go back to."""
        run = self._run
        if run is None or self.fault is not None:
            return None
        if run.lesson or run.trial or (run.replay and run.replay.state == "playing"):
            return run.before
        run.before = None  # no run waits for one that waits
        return Before(run, self.time, self.editor.world, self.running, self.pace.speed)

    def go_back(self) -> None:
        """Leave a lesson, a trial or a situation: the run before goes on as it was. ValueError: there is none."""
        before = self.run.before
        if before is None:
            raise ValueError("no run waits: this one took the place of none")
        run = before.run
        if run.feed is not None:
            run.feed = self._feed(run.session, Fork(run.feed))
        run.snapshots.refresh()
        self._time = before.time
        self._go_on_with(run, before.world)
        self.running, self.pace.speed = before.running, before.speed

    def go_on_from_here(self) -> Run:
        """Make the moment that is shown the present of a new branch, paused. ValueError says why that cannot be."""
        before, marks, lesson, waiting = self.run.feed, self.run.bookmarks, self.run.lesson, self.run.before
        run = self.time.go_on_from_here(self._next_number)
        run.before = waiting
        if run.session.source.world is None:
            run.config_before = self.next_config
        if before is not None:
            run.feed = self._feed(run.session, Fork(before, run.session.tick_count))
        run.bookmarks = marks.until(run.session.tick_count)
        run.keep_bookmarks()
        run.lesson = (
            None if lesson is None else LessonSupervisor(lesson.teaching, run.session, run.history, branch=True)
        )
        return self._go_on_paused(run)

    def change_branch(self, number: int) -> Run:
        """Go on with another branch, paused. ValueError names those that there are."""
        run = self.time.change_to(number)
        if run.feed is not None:
            run.feed = self._feed(run.session, Fork(run.feed))
        return self._go_on_paused(run)

    def _go_on_paused(self, run: Run) -> Run:
        self._go_on_with(run, run.session.source.world or self.world)
        self.running = False
        return run

    def _make_run(self, session: Session, beginning: Beginning | KeptRun | None) -> Run:
        run = Run(self._next_number, session, self.library.titles)
        run.feed, run.beginning = self._feed(session, beginning), beginning
        return run

    def _feed(self, session: Session, beginning: Beginning | KeptRun | Fork | None) -> RunFeed | None:
        return None if self._keeper is None or beginning is None else self._keeper.feed(session, beginning)

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
        if self._keeper is not None and run.feed is not None:
            self._keeper.begin(run.feed)
        self.pace.begin()
        return run

    # ------------------------------------------------------------ looking

    def snapshot(self) -> m.Snapshot:
        """The session as it is now."""
        run, speed = self.run, self.pace.speed if self.pace.speed > 0 else math.inf
        worlds = run.session.source.worlds
        if worlds:
            self.editor.follow(worlds[-1])
        snapshots = self.shown.snapshots
        if not (self.running or self.steps or self.runs_ahead):
            snapshots.settle()
        snapshots.office = self.editor.edition if worlds else None
        snapshots.trial = None if run.trial is None else run.trial.view()
        snapshots.situation = None if run.replay is None else run.replay.view()
        snapshots.lesson = None if run.lesson is None else run.lesson.view()
        snapshots.back, snapshots.stepping = run.before is not None, bool(self.steps)
        snapshots.until = None if run.until is None else run.until.view()
        snapshots.time = self.time.view(self.slices.work)
        snapshots.pairs, snapshots.additions_off = self._pairs.of(self.config_to_begin, run.session.config)
        return snapshots.build(running=self.running, speed=speed, real_time_factor=self.pace.factor, fault=self.fault)
