"""A session taken through the steps of a protocol, and what the experimenter writes down on the way: moments, tagged places,
how visits ended. Trials, lessons, headless runs and deliveries are such courses.

The experimenter sees where the robot truly is; the robot is given nothing but drives, goals and new surroundings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from app.protocol.steps import Step, Where, check_steps, place_of
from app.session import Session

MomentKind = Literal["tagged", "kidnap", "packet", "recovered", "reached", "failed", "step", "end"]
Progress = Callable[[float, str], None]  # simulated seconds since the last call, what is being done
REPORT_AFTER = 10  # ticks between two calls of it


@dataclass(frozen=True, slots=True)
class Moment:
    """Something that happened in a course. ok: whether it went as it should; None if it is neither good nor bad."""

    time_s: float
    words: str
    ok: bool | None = None
    kind: MomentKind = "step"


@dataclass(slots=True)
class Tagged:
    """A place that is tagged when the robot comes near it: the experience at the nearest point of the first good approach.

    An approach is good if it comes within half of `within_m`; until there was one, the nearest so far counts.
    """

    x: float
    y: float
    within_m: float
    experience: int | None = None
    away_m: float = math.inf
    passed: bool = False

    def note(self, here: tuple[float, float], experience: int) -> bool:
        """The robot is here. Whether the first approach is over now."""
        away = math.dist(here, (self.x, self.y))
        if self.passed:
            return False
        if away > self.within_m:
            self.passed = self.away_m <= self.within_m / 2
            return self.passed
        if away < self.away_m:
            self.away_m, self.experience = away, experience
        return False


@dataclass(frozen=True, slots=True)
class Visited:
    """How a visit ended. why: empty if the goal was reached."""

    name: str
    experience: int | None  # that the robot was sent to; None: there was none
    reached: bool
    began_s: float
    time_s: float
    path_m: float
    shortest_m: float  # of all ways from where it began; inf if there is none
    miss_m: float  # between the robot and where the goal was made
    why: str


class Course:
    """Take `ticks()` one by one, and run one tick of the session after each; `run_ticks` does that to the end."""

    def __init__(self, session: Session, steps: Sequence[Step] = ()) -> None:
        """ValueError names a place, door or parameter that does not exist."""
        self.session, self.steps = session, tuple(steps)
        self.tags: dict[str, Tagged] = {}
        self.visits: list[Visited] = []
        self.moments: list[Moment] = []
        self.met_at_s = math.inf  # when what was waited for happened
        self._reported = 0
        check_steps(session, self.steps)

    def ticks(self) -> Iterator[str]:
        """What is being done, before each tick."""
        yield from self.ticks_of(self.steps)
        self.mark("the end", kind="end")

    def ticks_of(self, steps: Sequence[Step]) -> Iterator[str]:
        """The same for some steps, without an end."""
        for step in steps:
            yield from step.carry_out(self)

    def new_moments(self) -> list[Moment]:
        """Those noted since the last call."""
        new, self._reported = self.moments[self._reported :], len(self.moments)
        return new

    @property
    def deciding(self) -> Moment:
        """The moment that decided the course: what failed first, else what succeeded last, else the end."""
        failed = [moment for moment in self.moments if moment.ok is False]
        succeeded = [moment for moment in self.moments if moment.ok]
        return failed[0] if failed else (succeeded or self.moments)[-1]

    # ------------------------------------------------------------ what steps are made of

    def tick(self, what: str) -> Iterator[str]:
        """One tick."""
        yield what
        here, experience = self.here, self.session.brain.experience_map.active
        for name, tag in self.tags.items():
            if tag.note(here, experience):
                self.mark(f"{name} is tagged, {tag.away_m:.2f} m from it", kind="tagged")

    def ticks_in(self, seconds: float) -> int:
        """At least one."""
        return max(1, round(seconds / self.session.frame.dt))

    def ticks_for(self, seconds: float, what: str) -> Iterator[str]:
        for _ in range(self.ticks_in(seconds)):
            yield from self.tick(what)

    def mark(self, words: str, ok: bool | None = None, kind: MomentKind | None = None) -> None:
        """Write down that something happens now."""
        judged: MomentKind = "step" if ok is None else "reached" if ok else "failed"
        self.moments.append(Moment(self.session.time_s, words, ok, kind or judged))

    def tag(self, name: str, place: tuple[float, float], within_m: float = 0.0, experience: int | None = None) -> None:
        """experience: what stands for the place, if that is known already."""
        known = experience is not None
        self.tags[name] = Tagged(*place, within_m, experience, 0.0 if known else math.inf, passed=known)

    def go(
        self, name: str, experience: int | None, place: tuple[float, float], timeout_s: float, near_m: float,
        *, is_sent: bool = False,
    ) -> Iterator[str]:  # fmt: skip
        """Send the robot to an experience that was made at this place (m, office frame), unless it has just been sent there:
        until it says that it has come to its goal, or the time is over. The experimenter sees whether it has."""
        visit = _Visit(self, name, experience, place)
        if experience is None:
            visit.over("never approached while exploring")
            return
        if not is_sent:
            self.session.go_to(experience)
        while (state := self.session.pilot.goal_state) is None or state[1] != "arrived":
            if visit.time_s >= timeout_s - 1e-9:
                unknown = " and says that it knows no way" if state is not None and state[1] == "unreachable" else ""
                visit.over(f"not reached in {timeout_s:g} s: it is {visit.miss_m:.2f} m away{unknown}")
                return
            yield from self.tick(f"on the way to {name}")
        visit.over("" if visit.miss_m <= near_m else f"arrived {visit.miss_m:.2f} m away")

    def judge_kidnap(self) -> None:
        """Write down whether the robot has found itself again after the last kidnap."""
        kidnap = self.session.evaluation.kidnaps[-1]
        if kidnap.after_s is None:
            self.mark("not recovered from the kidnap", False)
        else:
            words = f"recovered {kidnap.after_s:.1f} s and {kidnap.after_m or 0:.1f} m after the kidnap"
            self.mark(words, True, "recovered")

    @property
    def here(self) -> tuple[float, float]:
        """Where the robot truly is, m, office frame."""
        truth = self.session.simulator.truth
        return truth.x, truth.y

    def place(self, where: Where) -> tuple[float, float]:
        return place_of(self.session.world, where)


class _Visit:
    """One that has just begun."""

    def __init__(self, course: Course, name: str, experience: int | None, place: tuple[float, float]) -> None:
        session = course.session
        self._course, self._name, self._experience, self._place = course, name, experience, place
        self._began_s, self._began_m = session.time_s, session.evaluation.path_m
        self._shortest_m = session.simulator.free_space.shortest_m(course.here, place)

    @property
    def time_s(self) -> float:
        return self._course.session.time_s - self._began_s

    @property
    def miss_m(self) -> float:
        return math.dist(self._course.here, self._place)

    def over(self, why: str) -> None:
        path_m = self._course.session.evaluation.path_m - self._began_m
        self._course.visits.append(
            Visited(
                self._name, self._experience, not why, self._began_s, self.time_s, path_m, self._shortest_m,
                self.miss_m, why,
            )
        )  # fmt: skip
        self._course.mark(f"{self._name}: {why or 'reached'}", not why)


def run_ticks(
    course: Course,
    ticks: Iterable[str],
    watchers: Sequence[Callable[[], object]] = (),
    progress: Progress | None = None,
) -> None:
    """Run a tick of the session after each of these, and call all watchers after it."""
    session, since_s = course.session, course.session.time_s
    for what in ticks:
        session.tick()
        for watch in watchers:
            watch()
        if progress is not None and session.tick_count % REPORT_AFTER == 0:
            progress(session.time_s - since_s, what)
            since_s = session.time_s
