"""One round of a lesson: its scene is set, what is shown is measured, and the outcome is put into words. The same lesson
and seed is the same run, bit for bit, on the page and in a test."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from app.protocol.conditions import Waiting
from app.protocol.course import Course, run_ticks
from app.protocol.lesson import Lesson, Measured, Plate, fill_in
from app.protocol.marks import Marks
from app.protocol.measures import Measuring, reading_of
from app.session import Session
from app.views.history import History
from ratslam_core import Pose2
from sim2d.importers import open_world

Phase = Literal["scene", "ready", "showing", "over"]


def session_of(lesson: Lesson, number: int, seed: int | None = None) -> Session:
    """The session of a round before its first tick. seed: instead of the lesson's. ValueError says what does not fit."""
    scene = lesson.scene
    config = scene.config
    if lesson.rounds:
        config = config.with_values(lesson.rounds[number].set)
    world = open_world(scene.world, robot_radius_m=config.robot.robot_radius_m)
    return Session(world, scene.seed if seed is None else seed, config)


class LessonRound:
    """Call `advance` before the first tick and after each; `show` when the scene is set and it is to go on."""

    def __init__(self, lesson: Lesson, number: int, session: Session, history: History) -> None:
        """number: of the round, from 0. ValueError names a place, door or parameter that does not exist."""
        self.lesson, self.number, self.session, self.history = lesson, number, session, history
        self.phase: Phase = "scene"
        self.doing = "the scene is set"
        self._shown = [*(lesson.rounds[number].steps if lesson.rounds else []), *lesson.show.steps]
        self.course = Course(session, [*lesson.scene.steps, *self._shown])
        self._ticks: Iterator[str] = self.course.ticks_of(lesson.scene.steps)
        self._scene_s = max(0.1, sum(step.about_s() for step in lesson.scene.steps))
        self._waiting: Waiting | None = None
        self._until_s = self._began_s = 0.0
        self.scene_ticks = 0
        self._map_in_office = Pose2(0.0, 0.0, 0.0)  # as it fitted when the showing began
        self.marks: Marks | None = None
        self.values: Measured | None = None
        self._second_values: Measured | None = None
        self._measuring: list[Measuring] = []  # of the robot's brain, and of a second one
        if lesson.scene.compare:
            self._begin_second(anew=True)

    @property
    def label(self) -> str:
        """Of the round; empty if there is only one."""
        return self.lesson.rounds[self.number].label if self.lesson.rounds else ""

    @property
    def found(self) -> list[tuple[str, Measured]]:
        """What was measured, when it is over, by the label of the round; of two brains, by their names, the first one's last."""
        if self.values is None:
            return []
        pair = self.lesson.pair
        if pair is None or self._second_values is None:
            return [(self.label, self.values)]
        return [(pair.second, self._second_values), (pair.first, self.values)]

    @property
    def progress(self) -> float | None:
        """The share done of the scene, or of what is shown, about."""
        if self.phase == "scene":
            return min(0.99, self.session.time_s / self._scene_s)
        if self.phase == "showing":
            return min(0.99, (self.session.time_s - self._began_s) / max(0.1, self._most_s))
        return None

    def advance(self) -> None:
        """Give the orders for the next tick; note what has happened in the one before."""
        if self.phase == "scene":
            self.phase = "scene" if self._next() else "ready"
        elif self.phase == "showing":
            assert self.marks is not None
            for measuring in self._measuring:
                measuring.note()
            self.marks.note()
            if self._is_over() or not self._next():
                self.stop()

    def show(self) -> None:
        """Begin what is shown, from the tick that the scene ended at. ValueError: what is waited for cannot happen."""
        session, show, kinds = self.session, self.lesson.show, self.lesson.measures
        if show.compare:
            self._begin_second(anew=False)
        self._map_in_office = session.evaluation.map_in_office(session.brain.experience_map)
        self._measuring = [Measuring(self.course, kinds, self.history)]
        if self.lesson.pair is not None:
            self._measuring.append(Measuring(self.course, [k for k in kinds if k.of_any_brain], second=True))
        self.marks = Marks(self.lesson, session, self.history)
        self._began_s, self._until_s = session.time_s, session.time_s + show.limit_s
        self.scene_ticks = session.tick_count
        self.phase, self._ticks = "showing", self.course.ticks_of(self._shown)
        self._next()
        if show.until is not None:
            self._waiting = Waiting(show.until, session, self.history)

    def stop(self) -> None:
        """It is over: what was measured is final."""
        assert self.marks is not None
        values = [measuring.values() for measuring in self._measuring]
        self.phase, self.values, self._second_values = "over", values[0], values[1] if len(values) > 1 else None
        self.marks.end("it ended here")

    def place_of(self, what: Literal["the robot", "the belief"], plate: Plate) -> tuple[float, float]:
        """The true position or the estimate of it: m, in the frame of the plate. On the office the estimate is
        drawn as the map lay over the office when the showing began."""
        truth, robot = self.session.simulator.truth, self.session.brain.experience_map.robot
        if what == "the robot":
            return truth.x, truth.y
        believed = robot if plate == "map" else self._map_in_office.compose(robot)
        return believed.x, believed.y

    def _begin_second(self, *, anew: bool) -> None:
        """Give a second brain the same sensor input. anew: both begin; otherwise it is a copy. ValueError says why it cannot."""
        pair = self.lesson.pair
        assert pair is not None
        self.session.begin_companion(pair.first, pair.second, pair.values, anew)
        self.history.watch_companion()
        self.history.log.note("brain", f"two brains on the same senses: {pair.first} and {pair.second}")

    @property
    def _most_s(self) -> float:
        about = sum(step.about_s() for step in self._shown)
        return min(self.lesson.show.limit_s, about) if about > 0 else self.lesson.show.limit_s

    def _is_over(self) -> bool:
        now_s = self.session.time_s
        if self._waiting is not None and self._waiting.met():
            self._waiting, self.course.met_at_s = None, now_s
            self._until_s = min(self._until_s, now_s + self.lesson.show.then_s)
        return now_s >= self._until_s - 1e-9

    def _next(self) -> bool:
        """Give the orders for the next tick. False if there are none any more."""
        doing = next(self._ticks, None)
        for moment in self.course.new_moments():
            if moment.kind != "recovered":  # which is in the log already
                self.history.log.note("lesson" if moment.kind in ("step", "end") else moment.kind, moment.words)
        self.doing = self.doing if doing is None else doing
        return doing is not None


def shown_s(lesson: Lesson) -> float:
    """About how long what is shown takes in all its rounds, in simulated seconds."""
    each = sum(step.about_s() for step in lesson.show.steps)
    own = sum(step.about_s() for one in lesson.rounds for step in one.steps)
    return min(lesson.show.limit_s, each) * lesson.round_count + own


def run_lesson(lesson: Lesson, seed: int | None = None) -> list[LessonRound]:
    """Every round of a lesson, without a page, to its end."""
    return [run_round(lesson, number, seed) for number in range(lesson.round_count)]


def run_round(lesson: Lesson, number: int, seed: int | None = None) -> LessonRound:
    return show_to_end(set_scene(lesson, number, seed))


def set_scene(lesson: Lesson, number: int = 0, seed: int | None = None) -> LessonRound:
    session = session_of(lesson, number, seed)
    round_ = LessonRound(lesson, number, session, History(session))
    round_.advance()
    _run_until(round_, "ready")
    return round_


def show_to_end(round_: LessonRound) -> LessonRound:
    """Show it to its end."""
    round_.show()
    _run_until(round_, "over")
    return round_


def _run_until(round_: LessonRound, phase: Phase) -> None:
    def ticks() -> Iterator[str]:
        while round_.phase != phase:
            yield round_.doing

    run_ticks(round_.course, ticks(), [round_.history.watch, round_.advance])


def measured_in(rounds: Sequence[LessonRound]) -> list[tuple[str, Measured]]:
    """Label and values of each round that is over, or of each of two brains."""
    return [found for each in rounds for found in each.found]


@dataclass(frozen=True, slots=True)
class LessonReport:
    """kept: whether every promise holds, and one of the options is right."""

    lines: tuple[str, ...]
    kept: bool
    rounds: tuple[LessonRound, ...]


def report_of(lesson: Lesson, seed: int | None = None) -> LessonReport:
    """Run a lesson and judge it."""
    rounds = run_lesson(lesson, seed)
    found = measured_in(rounds)
    lines, kept = (
        [f"{lesson.title}, seed {lesson.scene.seed if seed is None else seed}", fill_in(lesson.outcome, found)],
        True,
    )
    ask = lesson.predict
    if ask.finding is not None and ask.options:
        value = ask.finding.of(found)
        right = [option.words for option in ask.options if option.holds(value)]
        kept = len(right) == 1
        lines.append(f"right prediction ({ask.finding.text} = {value:g}): {'; '.join(right) or 'none of the options'}")
    elif ask.draw is not None:
        x, y = rounds[-1].place_of(ask.draw, ask.plate)
        lines.append(f"{ask.draw} ends at ({x:.2f}, {y:.2f}) on the {ask.plate}")
    for promise in lesson.promise:
        value = promise.finding.of(found)
        holds = promise.holds(value)
        kept = kept and holds
        bounds = f"[{promise.at_least:g}, {promise.below:g})"
        lines.append(f"{'kept' if holds else 'BROKEN'}: {promise.finding.text} = {value:g}, promised {bounds}")
    for round_ in rounds:
        assert round_.values is not None
        for label, values in round_.found:
            told_all = ", ".join(
                f"{name} {reading_of(name).shown(value)}" for name, value in values.items() if value == value
            )
            lines.append(f"{label or 'measured'}: {told_all}")
        lines.append(f"state hash {round_.session.state_hash()}")
    return LessonReport(tuple(lines), kept, tuple(rounds))
