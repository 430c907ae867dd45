"""[ours] Seeking: now and then the robot leaves off wandering and drives somewhere on purpose, over its own map.

Wandering follows walls and crosses at random, as in IROS 2005; nothing in it seeks what the map lacks. So from time to
time the robot goes where open floor was seen but never driven on; if it has been on new ground for long, it first goes
back to old ground, so that its error cannot grow without bound; and if nothing is new, it goes to where it has not
been for longest, which closes loops and shows it each place from the other side. It knows map, sonars and odometry
only. test_seeking.py::{test_it_goes_where_open_floor_was_seen, test_on_new_ground_for_long_it_goes_back,
test_with_nothing_new_it_goes_where_it_has_not_been_for_longest}.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.pilot.bars import Bars
from app.pilot.known_ground import KnownGround
from app.pilot.local_movement import LocalMovement
from app.pilot.params import PilotParams
from app.pilot.route_following import RouteFollower
from disk import kind
from ratslam_core import ExperienceMap, Odometry, Pose2

_Point = tuple[float, float]


@kind("seeker/1")
class Seeker:
    """Decides when and where to drive on purpose, and drives there. `follower` is set on the way."""

    def __init__(self, sonar_angles_rad: NDArray[np.float64], bars: Bars) -> None:
        self.ground = KnownGround(sonar_angles_rad)
        self.follower: RouteFollower | None = None
        self.returning = False
        self._bars = bars
        self._opening: Pose2 | None = None  # what to drive into at the end of the trip, in the frame of its experience
        self._into_s = 0.0  # time of driving into it
        self._trip_s = 0.0
        self._wander_s = 0.0  # time since the last trip
        self._trips = 0

    @property
    def failed(self) -> bool:
        """In this tick: the robot could not get on, and should back out."""
        return self.follower is not None and self.follower.failed

    def stop(self) -> None:
        """Something else is wanted of the robot."""
        self.follower, self._opening, self._wander_s = None, None, 0.0

    def step(
        self, experiences: ExperienceMap, local: LocalMovement, odometry: Odometry, p: PilotParams
    ) -> _Point | None:
        """The next point to head for, metres in the robot's frame; None: wander."""
        if not p.seek:
            return None
        if self.follower is None:
            self._wander_s += odometry.dt
            if self._wander_s > p.seek_after_s:
                self._wander_s = 0.0
                self._choose(experiences, p)
            if self.follower is None:
                return None
        self._trip_s += odometry.dt
        aim = self._aim(self.follower, experiences, local, odometry.dt, p)
        if aim is None:
            self._end(experiences, p)
        return aim

    def _aim(
        self, follower: RouteFollower, experiences: ExperienceMap, local: LocalMovement, dt: float, p: PilotParams
    ) -> _Point | None:
        if self._trip_s > p.trip_most_s or (self.returning and self.ground.new_m == 0.0):
            return None
        if self._into_s == 0.0:
            aim = follower.step(experiences, local, dt, p)
            if aim is not None or follower.state != "arrived" or self._opening is None:
                return aim
        self._into_s += dt
        if self._opening is None or self._into_s > p.into_s:
            return None
        place = experiences.pose(follower.goal).compose(self._opening)
        here = experiences.robot.inverse().compose(place)
        there = math.hypot(here.x, here.y) < p.into_reach_m
        return None if there or local.free_way(math.atan2(here.y, here.x), p) < p.into_free_m else (here.x, here.y)

    def _end(self, experiences: ExperienceMap, p: PilotParams) -> None:
        assert self.follower is not None
        goal = experiences.pose(self.follower.goal)
        self.ground.been_at(goal.x, goal.y, experiences.poses, p)
        if self._opening is not None:
            place = goal.compose(self._opening)
            self.ground.tried(place.x, place.y)
        self.stop()

    def _choose(self, experiences: ExperienceMap, p: PilotParams) -> None:
        """Old ground if the robot has been on new ground for long; else by turns an opening near by and the place that
        was not visited for longest."""
        times = experiences.temporal_map.times_to(experiences.active)
        self._trips += 1
        self.returning = self.ground.new_m > p.return_after_m
        goal = self._old_ground(times, p) if self.returning else None
        if goal is None and self._trips % p.openings_every == 0:
            goal = self._nearest_opening(experiences, times, p)
        if goal is None:
            goal = self._long_ago(times, p)
        if goal is not None:
            self.follower = RouteFollower(goal, self._bars)
            self._trip_s = self._into_s = 0.0

    def _old_ground(self, times: NDArray[np.float64], p: PilotParams) -> int | None:
        old = np.flatnonzero(np.isfinite(times) & (self.ground.now_s - self.ground.made_s > p.old_after_s))
        old = old[self.ground.last_s[old] - self.ground.made_s[old] > p.old_after_s] if len(old) else old
        return int(old[np.argmin(times[old])]) if len(old) else None

    def _nearest_opening(self, experiences: ExperienceMap, times: NDArray[np.float64], p: PilotParams) -> int | None:
        rows, places = self.ground.openings(experiences.poses, p)
        reached = np.isfinite(times[rows])
        rows, places = rows[reached], places[reached]
        if not len(rows):
            return None
        best = int(np.argmin(times[rows]))
        goal = int(rows[best])
        place = Pose2(float(places[best, 0]), float(places[best, 1]), 0.0)
        self._opening = experiences.pose(goal).inverse().compose(place)
        return goal

    def _long_ago(self, times: NDArray[np.float64], p: PilotParams) -> int | None:
        known = np.flatnonzero(np.isfinite(times) & (times < p.trip_most_s))
        if not len(known):
            return None
        goal = int(known[np.argmin(self.ground.last_s[known])])
        return goal if self.ground.now_s - self.ground.last_s[goal] > p.long_ago_s else None
