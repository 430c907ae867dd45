"""One kidnap: how soon the robot was right again about where it is, what it believed before, and when its map was whole."""

from __future__ import annotations

from dataclasses import dataclass, field

from disk import kind
from ratslam_core import Pose2

STAY_S = 0.5  # how long something must be so before it counts


@kind("stretch/1")
@dataclass(slots=True)
class Stretch:
    """Since when something has been so, and how long it was at most."""

    since_s: float | None = None
    way_m: float = 0.0  # driven when it began
    most_s: float = 0.0

    def note(self, time_s: float, way_m: float, holds: bool) -> bool:
        """Note one tick. Returns whether it has been so for STAY_S."""
        if not holds:
            self.since_s = None
            return False
        if self.since_s is None:
            self.since_s, self.way_m = time_s, way_m
        self.most_s = max(self.most_s, time_s - self.since_s)
        return time_s - self.since_s >= STAY_S - 1e-9


@kind("kidnapping/2")
@dataclass(slots=True)
class Kidnapping:
    """One kidnap, judged for all engines alike by what the robot believes, from which it acts.

    It is right again (`after_s`, `after_m`) when for half a second it believes itself to be at a known place, and truly is
    within 1 m and 0.6 rad of there. Until then it may have believed itself to be where it was not for as long as `wrong`
    says. `joined_s`: its map was one again, which only an engine can tell that notices a kidnap. `consistent_s`: what
    ACRA 2004 would call relocalised, the estimate agrees with those of earlier passes through here.
    """

    at_s: float
    map_in_office: Pose2
    known: int  # experiences that existed before the kidnap
    ticks: int  # before it
    after_s: float | None = None
    after_m: float | None = None
    joined_s: float | None = None
    consistent_s: float | None = None
    wrong: Stretch = field(default_factory=Stretch)
    _right: Stretch = field(default_factory=Stretch)
    _agrees: Stretch = field(default_factory=Stretch)
    _noticed: bool = False
    _way_m: float = 0.0

    @property
    def judged(self) -> bool:
        """Whether nothing of it is open any more."""
        return None not in (self.after_s, self.joined_s, self.consistent_s)

    def drive(self, way_m: float) -> None:
        self._way_m += way_m

    def believes(self, time_s: float, right: bool | None) -> None:
        """Whether the known place is right where the robot believes itself to be; None: it is lost, or at a new place."""
        if self.after_s is None:
            self.wrong.note(time_s, self._way_m, right is False)
            if self._right.note(time_s, self._way_m, right is True):
                self.after_s, self.after_m = (self._right.since_s or 0.0) - self.at_s, self._right.way_m

    def carried(self, time_s: float, carried: bool) -> None:
        """Whether the brain knows that it was carried, and has not joined its map again."""
        if self._noticed and not carried and self.joined_s is None:
            self.joined_s = time_s - self.at_s
        self._noticed |= carried

    def agrees(self, time_s: float, agrees: bool) -> None:
        """Whether the estimate agrees with those of earlier passes through here."""
        if self.consistent_s is None and self._agrees.note(time_s, self._way_m, agrees):
            self.consistent_s = (self._agrees.since_s or 0.0) - self.at_s
