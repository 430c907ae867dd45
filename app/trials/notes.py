"""What the experimenter writes down: moments, places that are tagged, and how visits ended."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

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
