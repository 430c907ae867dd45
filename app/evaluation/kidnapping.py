"""One kidnap, and how long and how far it took the robot to know again where it is."""

from __future__ import annotations

from dataclasses import dataclass

from disk import kind
from ratslam_core import Pose2

STAY_S = 0.5  # so long it has to know


@kind("kidnapping/1")
@dataclass(slots=True)
class Kidnapping:
    """One kidnap and, later, how long and how far it took until the robot knew again where it was.

    It knows when for half a second an experience from before the kidnap is active and its pose in the map, which is laid
    over the office as it was before, is within 1 m and 0.6 rad of the truth.
    """

    at_s: float
    map_in_office: Pose2
    known: int  # experiences from before it
    after_s: float | None = None
    after_m: float | None = None
    _way_m: float = 0.0
    _right_since_s: float | None = None
    _right_since_m: float = 0.0

    def note(self, time_s: float, way_m: float, knows: bool) -> None:
        """One tick of it. knows: whether the robot knows where it is now; way_m: that it drove in this tick."""
        self._way_m += way_m
        if not knows:
            self._right_since_s = None
        elif self._right_since_s is None:
            self._right_since_s, self._right_since_m = time_s, self._way_m
        elif time_s - self._right_since_s >= STAY_S - 1e-9:
            self.after_s, self.after_m = self._right_since_s - self.at_s, self._right_since_m
