"""A lesson that is being given: its rounds, what was predicted, what came of it. One for all the runs of the lesson."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from app.config import Config
from app.lessons.findings import Values, told
from app.lessons.performance import Performance
from app.lessons.schema import Lesson
from web.messages import LessonOutcome, LessonPrediction, LessonVotes

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
    _found: list[tuple[str, Values]] = field(default_factory=list[tuple[str, Values]])

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

    def over(self, performance: Performance) -> None:
        """A round is over; after the last one, prediction and outcome are compared."""
        assert performance.values is not None
        self._found += performance.found
        if self.is_last:
            self.outcome = self._compared(performance)

    def _compared(self, performance: Performance) -> LessonOutcome:
        lesson, ask, said = self.lesson, self.lesson.predict, self.prediction
        words = told(lesson.outcome, self._found)
        if ask.finding is not None and ask.options:
            value = ask.finding.of(self._found)
            choice = next((k for k, option in enumerate(ask.options) if option.holds(value)), None)
            right = None if said is None else said.choice == choice
            return LessonOutcome(words, lesson.because, right, choice=choice)
        x, y = performance.place_of(ask.draw or "the robot", ask.plate)
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
