"""One kidnap, and the time and distance until the robot knew again where it was."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core import Pose2

STAY_S = 0.5  # how long the robot must be right before it counts as recovered


@kind("kidnapping/1")
@dataclass(slots=True)
class Kidnapping:
    """One kidnap and, once the robot has recovered, the time (s) and distance (m) that this took.

    It has recovered when, for half a second, an experience from before the kidnap is active and the robot truly is
    within 1 m and 0.6 rad of where it believes itself to be beside that experience. The experience counts as being where
    it was truly made: the map may be bent, or move after the kidnap. Of an experience that the brain brought with it
    that place is unknown; then the map counts, laid over the office as it fitted before the kidnap.
    """

    at_s: float
    map_in_office: Pose2
    known: int  # experiences that existed before the kidnap
    after_s: float | None = None
    after_m: float | None = None
    _way_m: float = 0.0
    _right_since_s: float | None = None
    _right_since_m: float = 0.0

    def note(self, time_s: float, way_m: float, knows: bool) -> None:
        """Note one tick. way_m: distance driven in it; knows: whether the robot knows where it is."""
        self._way_m += way_m
        if not knows:
            self._right_since_s = None
        elif self._right_since_s is None:
            self._right_since_s, self._right_since_m = time_s, self._way_m
        elif time_s - self._right_since_s >= STAY_S - 1e-9:
            self.after_s, self.after_m = self._right_since_s - self.at_s, self._right_since_m
