"""Every way in which another run takes the place of the one that is open. If one fails, that one is left as it is."""

from __future__ import annotations

from app.config import Config
from app.engine.current_run import CurrentRun
from app.engine.lesson_run import LessonRun, Teaching
from app.engine.played_ahead import PlayedAhead
from app.engine.run import Run
from app.engine.watched_trial import WatchedTrial
from app.lessons.performance import session_of
from app.played_session import PlayedSession
from app.recordings.playing import Player
from app.runs.book import Fork
from app.runs.bookmarks import read_bookmarks
from app.runs.header import beginning_of, recorded_beginning
from app.runs.run_file import KeptRun
from app.session import Session
from app.situations import Situation
from app.trials.trial import Trial
from disk import copy_state
from ratslam_core import RatSlam
from sim2d import World


class OtherRuns(CurrentRun):
    """What can be opened: a world, a trial, a lesson, a run that was kept, a recording, a situation, a moment of the past."""

    def begin(self, world: World, seed: int, config: Config, brain: RatSlam | None = None) -> Run:
        """Begin another run. If that fails, the old run is left as it is. ValueError says why."""
        old = self._run
        before = None if old is None or self.fault is not None else old.session  # after a fault it may be half changed
        before = None if before is None or before.recording is not None else before
        kept = None if brain is None else copy_state(brain)  # the session will go on with the brain itself
        session = Session(world, seed, config, brain, before)
        run = self._make_run(session, beginning_of(session, brain=brain is not None), kept)
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
        run.config_before = None if self._run is None else self.next_config
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
        run.lesson = LessonRun(teaching, session, run.history, at_once=at_once)
        run.config_before = teaching.config_before
        if session.world.name not in dict(self.library.titles):
            self.library.add(session.world)
        self._change_to(run, session.world)
        self.pace.speed, self.running = run.lesson.speed, True
        return run

    def go_on(self, kept: KeptRun, session: Session) -> Run:
        """Go on with a run that was kept, in this session: the one where it was left. ValueError says why that fails."""
        run = self._make_run(session, kept)
        run.bookmarks = read_bookmarks(kept.folder)
        recorded = session.recording is not None
        if recorded:
            run.config_before = Config() if self._run is None else self.next_config
        run.require_showable()
        run.event_log.note("brain", f"the run goes on where it was left, {session.time_s:.1f} s after its beginning")
        if kept.header.trial:
            run.event_log.note(
                "warning", f"{kept.header.trial} does not go on with the run: the robot has no orders of it"
            )
        if not recorded and session.world.name not in dict(self.library.titles):
            self.library.add(session.world)
        return self._change_to(run, self.editor.world if recorded else session.world)

    def begin_recording(self, player: Player, seed: int | None = None) -> Run:
        """Begin a run that plays a recording from its beginning. If that fails, the old run is left as it is. ValueError
        says why."""
        session = PlayedSession(player, seed)
        run = self._make_run(session, recorded_beginning(session))
        run.config_before = Config() if self._run is None else self.next_config
        run.require_showable()
        return self._change_to(run, self.editor.world)

    def open_situation(self, situation: Situation) -> Run:
        """Begin a run that plays a situation up to its moment, as fast as possible. The run before waits: if that is
        stopped, it goes on. ValueError says why it cannot begin; then the old run is left as it is."""
        brain = situation.first_brain()
        kept = None if brain is None else copy_state(brain)
        session = situation.begin(brain)
        run = self._make_run(
            session, beginning_of(session, brain=brain is not None, trial=situation.header.trial), kept
        )
        run.require_showable()
        before = None if self._run is None or self.fault is not None else (self._run, self.time, self.editor.world)
        if session.world.name not in dict(self.library.titles):
            self.library.add(session.world)
        self._change_to(run, session.world)
        self.running = False
        run.ahead = PlayedAhead(situation, session, run.event_log, before)
        run.ahead.advance()
        return run

    def leave_situation(self) -> None:
        """Stop playing what was opened; the run before goes on from where it was, paused."""
        before = self.run.ahead and self.run.ahead.before
        if before is None:
            self.run.stop_running_ahead()
            return
        run, time, world = before
        if run.book is not None:
            run.book = self._book(run.session, Fork(run.book))
        run.snapshots.refresh()
        self._time = time
        self._go_on_with(run, world)
        self.running = False

    def go_on_from_here(self) -> Run:
        """Make the moment that is shown the present of a new branch, paused. ValueError says why that cannot be."""
        before, marks, lesson = self.run.book, self.run.bookmarks, self.run.lesson
        run = self.time.go_on_from_here(self._next_number)
        if run.session.recording is not None:
            run.config_before = self.next_config
        if before is not None:
            run.book = self._book(run.session, Fork(before, run.session.tick_count))
        run.bookmarks = marks.until(run.session.tick_count)
        run.keep_bookmarks()
        run.lesson = None if lesson is None else LessonRun(lesson.teaching, run.session, run.history, branch=True)
        return self._go_on_paused(run)

    def change_branch(self, number: int) -> Run:
        """Go on with another branch, paused. ValueError names those that there are."""
        run = self.time.change_to(number)
        if run.book is not None:
            run.book = self._book(run.session, Fork(run.book))
        return self._go_on_paused(run)

    def _go_on_paused(self, run: Run) -> Run:
        self._go_on_with(run, self.world if run.session.recording else run.session.world)
        self.running = False
        return run
