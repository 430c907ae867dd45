"""What the experimenter writes down (moments, places that are tagged, how visits ended), and the scores that every trial has
of it."""

from __future__ import annotations

import difflib
import math
import re
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from app.trials.measures import SCORES

if TYPE_CHECKING:
    from app.trials.course import Course


MomentKind = Literal["tagged", "kidnap", "packet", "recovered", "reached", "failed", "step", "end"]


@dataclass(frozen=True, slots=True)
class Moment:
    """Something that happened in a trial. ok: whether it went as it should; None if it is neither good nor bad."""

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
    miss_m: float
    why: str


_ALWAYS = (
    "error_m", "odometry_m", "path_m", "simulated_s", "old_ground", "views", "experiences", "links", "snaps",
    "false_positives", "consistent",
)  # fmt: skip
_OF_VISITS = ("goals", "reached")
_OF_KIDNAPS = ("kidnaps", "recovered", "wrong", "wrong_long", "joined", "consistent", "kidnap_median_s")
_OF_A_KIDNAP = ("s", "m", "wrong_s", "joined_s", "consistent_s")
_NUMBER = "([1-9][0-9]{0,6})"
_OF_ONE = re.compile(f"goal_{_NUMBER}_(?:s|m|miss_m)|kidnap_{_NUMBER}_(?:{'|'.join(_OF_A_KIDNAP)})")
WRONG_S, WRONG_LONG_S = 0.5, 3.0


@dataclass(frozen=True, slots=True)
class Counted:
    """How often a protocol sends the robot somewhere, and carries it away."""

    visits: int
    kidnaps: int


def unknown_score(name: str, measures: Sequence[str], counted: Counted) -> str:
    """Why no trial can have this score; empty if one can."""
    one = _OF_ONE.fullmatch(name)
    if one is not None:
        what, number, most = ("visit", one[1], counted.visits) if one[1] else ("kidnap", one[2], counted.kidnaps)
        return "" if int(number) <= most else f"{name!r} is of {what} {number}; the protocol has {most}"
    known = [*_ALWAYS, *(score for measure in measures for score in SCORES[measure])]
    known += [*_OF_VISITS, "goal_1_s", "goal_1_m", "goal_1_miss_m"] if counted.visits else []
    known += [*_OF_KIDNAPS, *(f"kidnap_1_{what}" for what in _OF_A_KIDNAP)] if counted.kidnaps else []
    if name in known:
        return ""
    by = next((measure for measure, scores in SCORES.items() if name in scores), None)
    if by is not None:
        return f"{name!r} is measured by {by!r}: put that into measures"
    near = difflib.get_close_matches(name, known, 1)
    meant = f"did you mean {near[0]!r}? " if near else ""
    return f"no trial of this protocol has the score {name!r}; {meant}expected one of: {', '.join(sorted(known))}"


def scores_of(course: Course) -> dict[str, float]:
    """The scores of a trial that has ended, by name; what does not apply to it is left out."""
    session, map_ = course.session, course.session.brain.experience_map
    evaluation = session.evaluation
    error_m, odometry_m = evaluation.errors(map_)
    scores = {
        "error_m": error_m,
        "odometry_m": odometry_m,
        "path_m": evaluation.path_m,
        "simulated_s": session.time_s,
        "old_ground": evaluation.revisit_share,
        "views": len(session.brain.local_view),
        "experiences": len(map_),
        "links": map_.link_count,
        "snaps": session.brain.relocalisations,
        "false_positives": session.brain.local_view.false_positives,
        **_visits(course),
        **_kidnaps(course),
    }
    consistency = evaluation.revisit_consistency
    if consistency is not None:
        scores["consistent"] = consistency
    return {name: float(value) for name, value in scores.items() if math.isfinite(value)}


def _visits(course: Course) -> dict[str, float]:
    if not course.visits:
        return {}
    scores = {"goals": float(len(course.visits)), "reached": float(sum(visit.reached for visit in course.visits))}
    for number, visit in enumerate(course.visits, start=1):
        scores[f"goal_{number}_s"] = visit.time_s
        scores[f"goal_{number}_m"] = visit.path_m
        scores[f"goal_{number}_miss_m"] = visit.miss_m
    return scores


def _kidnaps(course: Course) -> dict[str, float]:
    kidnaps = course.session.evaluation.kidnaps
    if not kidnaps:
        return {}
    scores = {
        "kidnaps": float(len(kidnaps)),
        "recovered": float(sum(k.after_s is not None for k in kidnaps)),
        "wrong": float(sum(k.wrong.most_s > WRONG_S for k in kidnaps)),
        "wrong_long": float(sum(k.wrong.most_s > WRONG_LONG_S for k in kidnaps)),
        "joined": float(sum(k.joined_s is not None for k in kidnaps)),
        "consistent": float(sum(k.consistent_s is not None for k in kidnaps)),
    }
    after = [kidnap.after_s for kidnap in kidnaps if kidnap.after_s is not None]
    if after:
        scores["kidnap_median_s"] = statistics.median(after)
    for number, kidnap in enumerate(kidnaps, start=1):
        found = {
            "s": kidnap.after_s,
            "m": kidnap.after_m,
            "joined_s": kidnap.joined_s,
            "consistent_s": kidnap.consistent_s,
            "wrong_s": kidnap.wrong.most_s,
        }
        scores |= {f"kidnap_{number}_{name}": value for name, value in found.items() if value is not None}
    return scores
