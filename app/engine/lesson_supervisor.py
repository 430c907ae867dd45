"""One round of a lesson in the engine: its scene, what is shown, and the free play afterwards. `Teaching` is one for all rounds
of a lesson that is being given: which round it is, the predictions, the outcome."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from app.config import Config
from app.engine.supervisor import Supervisor
from app.protocol.lesson import Lesson, Measured, fill_in
from app.protocol.lesson_round import LessonRound
from app.session import Session
from app.views.history import History
from web.messages import Inspect, LessonOutcome, LessonPrediction, LessonState, LessonView, LessonVotes


class LessonSupervisor(Supervisor):
    """Call `before_tick` before each tick and `after_tick` after it. What is shown is the same, bit for bit, without a page."""

    def __init__(
        self, teaching: Teaching, session: Session, history: History, *, at_once: bool = False, branch: bool = False
    ) -> None:
        """at_once: show it as soon as the scene is set, as in a second round. branch: the run leaves another of the lesson in
        its past, and is played freely. ValueError: the lesson does not fit its world.
        """
        self.teaching, self._session, self._history = teaching, session, history
        self._round = None if branch else LessonRound(teaching.lesson, teaching.number, session, history)
        self.state: LessonState = "sandbox" if branch else "scene"
        self.altered, self._ahead = branch, not branch
        self.inspects: Inspect | None = None  # what is to be inspected now
        self._at_once, self._doing = at_once, "another branch: play freely" if branch else ""
        if branch:
            return
        if teaching.number == 0:
            history.log.note("lesson", f"{teaching.lesson.title}: the scene is set")
        self.after_tick()

    @property
    def runs_ahead(self) -> bool:
        return self._ahead

    @property
    def speed(self) -> float:
        return self.teaching.lesson.scene.speed

    @property
    def round_over(self) -> bool:
        """Whether it is over, and another round follows."""
        return self.state == "predict" and self._round is not None and self._round.phase == "over"

    def next_round(self) -> Teaching:
        self.teaching.number += 1
        return self.teaching

    # ------------------------------------------------------------ ticks

    def before_tick(self) -> None:
        """Whoever lets time go on lets it happen, or plays freely when it is over."""
        if self.state == "predict" and not self.round_over:
            self.show()
        elif self.state == "compared":
            self._play_freely()
            if self._session.pilot.mode == "manual":
                self._session.set_mode("explore")

    def after_tick(self) -> None:
        round_ = self._round
        if round_ is None or self.state not in ("scene", "showing"):
            return
        try:
            round_.advance()
        except ValueError as error:  # what it needs is no longer there
            self._break_off(f"it cannot go on: {error}")
            return
        if round_.phase == "ready" and self.state == "scene":
            self._ahead, self.state = False, "predict"
            if self._at_once:
                self.show()
            else:
                self.pause_requested = True
        elif round_.phase == "over":
            self._over(round_)

    def show(self) -> None:
        """Let it happen. ValueError says why that cannot be now."""
        if self.state != "predict" or self._round is None:
            raise ValueError(f"the lesson is in the state {self.state!r}: what it shows begins from 'predict'")
        label = f" ({self._round.label})" if self._round.label else ""
        self.state = "showing"
        self._history.log.note("lesson", f"{self.teaching.lesson.title}: it happens{label}")
        try:
            self._round.show()
        except ValueError as error:
            self._break_off(f"it cannot go on: {error}")

    def stop_running_ahead(self) -> None:
        self._ahead = False

    # ------------------------------------------------------------ what others do

    def ordered(self, why: str) -> None:
        """A user has given the robot orders: nothing more is shown."""
        if self.state in ("scene", "showing", "predict"):
            self.altered = True
            self._break_off(why)
        elif self.state == "compared":
            self._play_freely()

    def alter(self) -> None:
        """Somebody has changed office or parameters: it goes on, but need not keep what it promises."""
        if self.state == "compared":
            self._play_freely()
        elif self.state != "sandbox":
            self.altered = True

    # ------------------------------------------------------------ looking

    def view(self) -> LessonView:
        teaching, round_ = self.teaching, self._round
        lesson = teaching.lesson
        marks = round_.marks.view() if round_ is not None and round_.marks is not None else ()
        return LessonView(
            lesson.name, lesson.title, self.state, self._what, None if round_ is None else round_.progress,
            teaching.number + 1, lesson.round_count, lesson.rounds[teaching.number].label if lesson.rounds else "",
            teaching.seed, teaching.prediction, teaching.votes, teaching.outcome, marks, self.altered,
            None if lesson.predict.draw is None else lesson.predict.plate,
        )  # fmt: skip

    @property
    def _what(self) -> str:
        if self._round is None or self._doing:
            return self._doing
        if self.round_over:
            following = self.teaching.lesson.rounds[self.teaching.number + 1].label
            return f"{self._round.label} is over; next: {following}"
        return {
            "scene": f"the scene is set: {self._round.doing}",
            "predict": "waits for a prediction",
            "showing": self._round.doing,
            "compared": "prediction and outcome are compared",
            "sandbox": "play freely",
        }[self.state]

    # ------------------------------------------------------------ inside

    def _over(self, round_: LessonRound) -> None:
        teaching, log = self.teaching, self._history.log
        teaching.over(round_)
        self.pause_requested = True
        if teaching.outcome is None:
            self.state = "predict"
            log.note("lesson", f"{teaching.lesson.title}: {round_.label} is over")
            return
        self.state = "compared"
        log.note("lesson", teaching.outcome.words)
        kind, marks = teaching.lesson.show.explain, round_.marks
        event = None if kind is None or marks is None else marks.last_event(kind)
        self.inspects = None if event is None else Inspect(type="inspect", event=event)

    def _break_off(self, why: str) -> None:
        self.state, self._ahead, self._doing = "sandbox", False, f"broken off: {why}"
        self._history.log.note("lesson", f"{self.teaching.lesson.title} is broken off: {why}")

    def _play_freely(self) -> None:
        self.state = "sandbox"


MOST_VOTERS = 500
MOST_FROM_ONE = 60  # of an address, behind which a whole class may be; one phone alone cannot take all places


@dataclass(slots=True)
class Teaching:
    """config_before: that of the run before the lesson, which a reset brings back."""

    lesson: Lesson
    seed: int
    config_before: Config | None
    number: int = 0  # of the round, from 0
    prediction: LessonPrediction | None = None
    outcome: LessonOutcome | None = None
    _votes: dict[str, LessonPrediction] = field(default_factory=dict[str, LessonPrediction])
    _senders: dict[str, str] = field(default_factory=dict[str, str])  # the address of each voter
    _found: list[tuple[str, Measured]] = field(default_factory=list[tuple[str, Measured]])

    @property
    def is_last(self) -> bool:
        return self.number == self.lesson.round_count - 1

    def predict(self, prediction: LessonPrediction) -> None:
        """ValueError: it is not what the lesson asks for."""
        self._check(prediction)
        self.prediction = prediction

    def vote(self, voter: str, prediction: LessonPrediction, sender: str = "") -> None:
        """sender: the address it comes from. ValueError: it is not what the lesson asks for, or there is no place left."""
        self._check(prediction)
        if voter not in self._votes:
            if len(self._votes) >= MOST_VOTERS:
                raise ValueError(f"{MOST_VOTERS} have voted already")
            if sum(other == sender for other in self._senders.values()) >= MOST_FROM_ONE:
                raise ValueError(f"{MOST_FROM_ONE} have voted from this address already")
            self._senders[voter] = sender
        self._votes[voter] = prediction

    @property
    def votes(self) -> LessonVotes:
        counts = [0] * len(self.lesson.predict.options)
        points: list[tuple[float, float]] = []
        for vote in self._votes.values():
            if vote.choice is not None:
                counts[vote.choice] += 1
            elif vote.x is not None and vote.y is not None:
                points.append((vote.x, vote.y))
        return LessonVotes(tuple(counts), tuple(points))

    def over(self, round_: LessonRound) -> None:
        """A round is over; after the last one, prediction and outcome are compared."""
        assert round_.values is not None
        self._found += round_.found
        if self.is_last:
            self.outcome = self._compared(round_)

    def _compared(self, round_: LessonRound) -> LessonOutcome:
        lesson, ask, said = self.lesson, self.lesson.predict, self.prediction
        words = fill_in(lesson.outcome, self._found)
        if ask.finding is not None and ask.options:
            value = ask.finding.of(self._found)
            choice = next((k for k, option in enumerate(ask.options) if option.holds(value)), None)
            right = None if said is None else said.choice == choice
            return LessonOutcome(words, lesson.because, right, choice=choice)
        x, y = round_.place_of(ask.draw or "the robot", ask.plate)
        if said is None or said.x is None or said.y is None:
            return LessonOutcome(words, lesson.because, None, x=x, y=y)
        away_m = math.dist((said.x, said.y), (x, y))
        return LessonOutcome(words, lesson.because, away_m <= ask.near_m, x=x, y=y, distance_m=away_m)

    def _check(self, prediction: LessonPrediction) -> None:
        options = self.lesson.predict.options
        if options and (prediction.choice is None or prediction.choice >= len(options)):
            raise ValueError(f"the lesson asks for a choice, from 0 to {len(options) - 1}")
        if not options and (prediction.x is None or prediction.y is None):
            raise ValueError(f"the lesson asks for a place on the {self.lesson.predict.plate}: x and y, in metres")
        if (prediction.x, prediction.y) != (None, None) and prediction.choice is not None:
            raise ValueError("give either a choice or x and y")
