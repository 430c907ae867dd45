"""[ours] Driving into an opening: to open floor that was seen from an experience.

test_seeking.py::{test_a_door_post_in_the_way_is_driven_round, test_what_it_comes_no_nearer_to_is_given_up}.
"""

from __future__ import annotations

import math

from app.pilot.params import PilotParams
from disk import kind
from ratslam_core import ExperienceMap, Pose2

MOST_S, REACH_M = 25.0, 0.4  # it ends after this time, or this near to its place ...
STILL_S, STEP_M = 4.0, 0.1  # ... or when for so long it came no such step nearer


@kind("opening/1")
class Opening:
    """The last leg of a trip, from the experience that saw it."""

    def __init__(self, experience: int, place: Pose2) -> None:
        """place: in the frame of the experience; its heading does not count."""
        self.experience, self.place = experience, place
        self._time_s, self._nearest_m, self._nearer_s = 0.0, math.inf, 0.0  # how near it came, and when

    def at(self, experiences: ExperienceMap) -> Pose2:
        """In the map as it is now."""
        return experiences.pose(self.experience).compose(self.place)

    def aim(self, experiences: ExperienceMap, dt: float, _p: PilotParams) -> tuple[float, float] | None:
        """The next point to head for, m, robot's frame; None: it was reached, or cannot be."""
        self._time_s += dt
        if self._time_s > MOST_S:
            return None
        here = experiences.robot.inverse().compose(self.at(experiences))
        away_m = math.hypot(here.x, here.y)
        if away_m < self._nearest_m - STEP_M:
            self._nearest_m, self._nearer_s = away_m, self._time_s
        still = self._time_s - self._nearer_s > STILL_S
        return None if away_m < REACH_M or still else (here.x, here.y)
