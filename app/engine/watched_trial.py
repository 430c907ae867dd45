"""The trial of an experiment that a run carries out, step by step, until it is over or somebody gives the robot orders."""

from __future__ import annotations

from app.engine.supervisor import Supervisor
from app.protocol.course import Course
from app.protocol.trial import Trial
from app.views.events import EventLog
from web.messages import TrialState, TrialView

BEFORE_S = 10.0  # a trial that is run ahead to a moment stops so long before it
CHANGED = "the program has changed since this trial was run: what it does today may differ from its scores"
_NOT_LOGGED = ("recovered", "end")  # the log has the first anyway, and the second together with the outcome


class WatchedTrial(Supervisor):
    """Call `after_tick` after each tick. The run is the same, bit for bit, as that of the trial by itself."""

    def __init__(self, trial: Trial, title: str, course: Course, log: EventLog, moment_s: float | None = None) -> None:
        """title: of the experiment. moment_s: simulated time of the moment that is to be seen."""
        self.trial, self.title, self.course = trial, title, course
        self.state: TrialState = "running"
        self.doing = self.outcome = ""
        self.altered = False
        self._log = log
        self._about_s = trial.about_s
        self._ahead_s = None if moment_s is None or moment_s <= BEFORE_S else moment_s - BEFORE_S
        self._ticks = course.ticks()
        where = ", ".join([trial.engine, *trial.levels, f"seed {trial.seed}"])
        log.note("trial", f"{trial.experiment} begins: {where}")
        self.after_tick()  # what it does first: its tags, its first order

    @property
    def runs_ahead(self) -> bool:
        """Whether it still has to be run, as fast as possible, to shortly before its moment."""
        return self._ahead_s is not None

    def after_tick(self) -> None:
        """Give the robot its orders for the next tick, and note what has happened."""
        if self.state != "running":
            return
        over = False
        try:
            self.doing = next(self._ticks)
        except StopIteration:
            over = True
        except ValueError as error:  # what it needs is no longer there
            self.ordered(f"it cannot go on: {error}")
        self._note_moments()
        if over:
            self.state, self.outcome, self._ahead_s = "over", outcome_of(self.course), None
            self._log.note("trial", f"{self.trial.experiment} is over: {self.outcome}")
        elif self._ahead_s is not None and self.course.session.time_s >= self._ahead_s - 1e-9:
            self._ahead_s = None

    def stop_running_ahead(self) -> None:
        self._ahead_s = None

    def ordered(self, why: str) -> None:
        """It ends before it is over; the robot goes on."""
        if self.state == "running":
            self.state, self.outcome = "ended", why
            self._ahead_s = None
            self._log.note("trial", f"{self.trial.experiment} ends: {why}")

    def alter(self) -> None:
        if self.state == "running" and not self.altered:
            self.altered = True
            self._log.note("trial", f"{self.trial.experiment} was changed by hand: from here on it is another run")

    def view(self) -> TrialView:
        trial, ahead = self.trial, None
        if self._ahead_s is not None:
            ahead = min(1.0, self.course.session.time_s / self._ahead_s)
        return TrialView(
            trial.experiment, self.title, trial.engine, trial.levels, trial.seed, trial.id, self.state, self.doing,
            self._about_s, ahead, self.altered, self.outcome,
        )  # fmt: skip

    def _note_moments(self) -> None:
        for moment in self.course.new_moments():
            if moment.kind not in _NOT_LOGGED:
                self._log.note("trial" if moment.kind == "step" else moment.kind, moment.words)


def outcome_of(course: Course) -> str:
    """What came of a trial, in words."""
    if course.visits:
        reached, goals = sum(visit.reached for visit in course.visits), len(course.visits)
        return f"{reached} of {goals} {'goal' if goals == 1 else 'goals'} reached"
    judged = [moment for moment in course.moments if moment.ok is not None]
    return judged[-1].words if judged else f"{course.session.time_s / 60:.1f} minutes were driven"
