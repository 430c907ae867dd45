"""What commands act on: the current run, whether it plays, and who waits for ticks. It knows neither queue nor page."""

from __future__ import annotations

import contextlib
import math
import time
import traceback

from app.engine.other_runs import OtherRuns
from app.engine.watchdog import words_of
from app.views.tick_stages import TickRecorder
from web import messages as m


class Engine(OtherRuns):
    """To be used from one thread only; which one does not matter."""

    # ------------------------------------------------------------ ticks

    def tick(self, recorder: TickRecorder | None = None) -> bool:
        """Run one tick. True if something happened that has to be shown at once.

        An exception pauses the session and is shown as a fault. A tick that hung but ended is noted in the event log.
        """
        if self.run.session.over and self.time.past is None:
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
        pauses = live and self.run.takes_pause()
        if pauses:
            self.running = False
            self.break_off()
        over = live and self.run.session.over and self._pause_at_end()
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
        """A trial that has just come to its end is looked at in peace; whoever presses play goes on from there."""
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
        if self.run.session.over and self.time.past is None:
            return m.Refused("type", kind, "the recording has ended; restart it to see it from its beginning")
        self.running = False
        self.slices.drop(self.shown.session.tick_count, unless_still=True)
        self.run.stop_running_ahead()
        return None

    def fail(self, error: BaseException) -> None:
        """Stop at a fault. A fault that repeats is reported once."""
        words = words_of(error)
        new, self.fault, self.running = words != self.fault, words, False
        if new:
            with contextlib.suppress(Exception):  # there may be nobody to print to
                traceback.print_exception(error)
        self.break_off()
        if self._run is not None and self._run.book is not None:
            self._run.book.end(f"it stopped at a fault: {words}")
        if new and self._run is not None:
            self._run.event_log.note("fault", words)

    # ------------------------------------------------------------ looking

    def snapshot(self) -> m.Snapshot:
        """The session as it is now."""
        run, speed = self.run, self.pace.speed if self.pace.speed > 0 else math.inf
        if run.session.recording is None:
            self.editor.follow(run.session.simulator.world)
        snapshots = self.shown.snapshots
        if not (self.running or self.steps or self.runs_ahead):
            snapshots.settle()
        snapshots.office = None if run.session.recording is not None else self.editor.edition
        snapshots.trial = None if run.trial is None else run.trial.view()
        snapshots.situation = None if run.ahead is None else run.ahead.view()
        snapshots.lesson = None if run.lesson is None else run.lesson.view()
        snapshots.until = None if run.until is None else run.until.view()
        snapshots.time = self.time.view(self.slices.work)
        snapshots.pairs, snapshots.additions_off = self._pairs.of(self.config_to_begin, run.session.config)
        return snapshots.build(running=self.running, speed=speed, real_time_factor=self.pace.factor, fault=self.fault)
