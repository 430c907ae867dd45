"""[ours] Exploring on purpose: where to drive next, over its own map, and why.

Wandering follows walls and crosses at random, as in IROS 2005; nothing in it seeks what the map lacks. The robot goes, in
this order: back to old ground when its odometry may be off by too much since it was last there; along known ground that is
near but far by the links, which closes a loop; into the opening with the most new ground for the time. Only where nothing is
new does it wander, and between whiles visit the place where it has not been for longest. On a submap, as after a kidnap, it
looks for the rest of its map: it does not go back, any beam makes an opening, and those near where the submap began come
first: perhaps it was not carried at all, and then the rest lies there. Its input is map, sonars and odometry only.
test_seeking.py::{test_it_goes_where_open_floor_was_seen, test_where_a_trip_did_not_get_to_the_next_does_not_go,
test_on_new_ground_for_long_it_goes_back, test_before_it_came_to_anything_again_it_goes_back_to_where_it_began,
test_with_nothing_new_it_goes_where_it_has_not_been_for_longest, test_while_there_is_an_opening_it_does_not_wander,
test_on_a_submap_it_does_not_go_back, test_on_a_submap_it_begins_where_that_began}.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.pilot.bars import Bars
from app.pilot.known_ground import OLD_AFTER_S, PLACE_REACH_M, KnownGround
from app.pilot.local_movement import LocalMovement
from app.pilot.loop_closing import LoopCloser, in_the_middle
from app.pilot.opening import Opening
from app.pilot.params import PilotParams
from app.pilot.route_following import RouteFollower
from disk import kind
from ratslam_core import ExperienceMap, Odometry, Pose2, wrap_angles

TRIP_SLOW, TRIP_MORE_S = 1.5, 60.0  # a trip may take so many times what its links say, and this time more
CHOOSE_S = 5.0  # while it wanders, it looks for something new as often ...
WANDER_S = 45.0  # ... and after this time it visits an old place
AFTER_BARRED_S = 10.0  # it wanders for so long where it found no way
LONG_AGO_S = 120.0  # places visited more lately than this are not sought again
SEARCH_SHARE = 0.1  # the rest of its map is looked for while another submap is larger than this share of its own ...
SEARCH_HOME = 2.0  # ... metres of the way there that a metre from where its submap began to an opening counts as ...
BEGIN_S = 10.0  # added to the time of each way: small ground near by is not worth a start
FREE_M = 0.2  # an opening is seen from here if so much is free towards it

_Point = tuple[float, float]


@kind("seeker/6")
class Seeker:
    """Decides when and where to drive on purpose, and drives there. `follower` is set on the way."""

    def __init__(self, sonar_angles_rad: NDArray[np.float64], bars: Bars) -> None:
        self.ground = KnownGround(sonar_angles_rad)
        self.follower: RouteFollower | None = None
        self.returning = False
        self.explored = False  # nothing new is in sight, and has not been for a while
        self.reason = ""  # of the trip, in words; "" while it wanders
        self.openings = np.zeros((0, 2))  # (k, 2) m, map frame: all that it knew of when it chose
        self._bars = bars
        self._closer = LoopCloser(sonar_angles_rad)
        self._last_leg: Opening | LoopCloser | None = None  # of the trip, where no links lead ...
        self._on_last_leg = False  # ... and whether it is on it
        self._trip_s = self._trip_most_s = 0.0
        self._wander_s = 0.0  # time since the last trip
        self._wait_s = 0.0  # time before it chooses again

    @property
    def failed(self) -> bool:
        """In this tick: the robot could not get on, and should back out."""
        return self.follower is not None and self.follower.failed

    @property
    def on_new_ground(self) -> bool:
        """Whether it drives into an opening, or along old ground that may close a loop."""
        return self.follower is not None and self._on_last_leg

    @property
    def rests(self) -> bool:
        """Whether to stop it would change nothing."""
        return self.follower is None and self._wander_s == self._wait_s == 0.0

    def target(self, experiences: ExperienceMap) -> _Point | None:
        """Where the trip leads, m, map frame; None while it wanders."""
        if self.follower is None:
            return None
        leg = self._last_leg
        place = leg.at(experiences) if isinstance(leg, Opening) else experiences.pose(self.follower.goal)
        return place.x, place.y

    def stop(self) -> None:
        """Something else is wanted of the robot."""
        self.follower, self._last_leg, self._wander_s, self._wait_s, self.reason = None, None, 0.0, 0.0, ""

    def step(
        self,
        experiences: ExperienceMap,
        local: LocalMovement,
        ranges_m: NDArray[np.float32],
        odometry: Odometry,
        p: PilotParams,
    ) -> _Point | None:
        """The next point to head for, metres in the robot's frame; None: wander. ranges_m: (8,) from left to right."""
        if not p.seek or len(experiences) == 0:
            return None
        if self.follower is not None and not _on_own_submap(experiences, self.follower.goal):
            self.stop()  # it was carried: where the trip led to, seen from here, nobody knows
        if self.follower is None:
            self._wander_s += odometry.dt
            self._wait_s -= odometry.dt
            if self._wait_s <= 0.0:
                self._wait_s = CHOOSE_S
                self._choose(experiences, local, ranges_m, p)
            if self.follower is None:
                return None
        self._trip_s += odometry.dt
        aim = self._aim(self.follower, experiences, local, odometry.dt, p)
        if aim is None:
            self._end(experiences)
        return aim if aim is None or self._last_leg is not self._closer else in_the_middle(aim, ranges_m)

    def _aim(
        self, follower: RouteFollower, experiences: ExperienceMap, local: LocalMovement, dt: float, p: PilotParams
    ) -> _Point | None:
        if self._trip_s > self._trip_most_s or (self.returning and self.ground.new_m == 0.0):
            return None
        if not self._on_last_leg:
            aim = follower.step(experiences, local, dt, p)
            if aim is not None or follower.state != "arrived":
                return aim
            self._on_last_leg = True
        return None if self._last_leg is None else self._last_leg.aim(experiences, dt, p)

    def _end(self, experiences: ExperienceMap) -> None:
        assert self.follower is not None
        goal = experiences.pose(self.follower.goal)
        self.ground.been_at(goal.x, goal.y, experiences.poses)
        if isinstance(self._last_leg, Opening):
            ground, place = self.ground, self._last_leg.place
            ground.tried.add(experiences, self.follower.goal, place.x, place.y, ground.now_s)
            if not self._on_last_leg:
                ground.missed.add(experiences, self.follower.goal, 0.0, 0.0, ground.now_s)
        barred = self.follower.state == "exploring"
        self.stop()
        self._wait_s = AFTER_BARRED_S if barred else 0.0

    def _choose(
        self, experiences: ExperienceMap, local: LocalMovement, ranges_m: NDArray[np.float32], p: PilotParams
    ) -> None:
        """Old ground if odometry may be far off; else a loop to close; else the best opening; else, after wandering,
        the place that was not visited for longest."""
        times, searching = experiences.temporal_map.times_to(experiences.active), _searching(experiences)
        self._trip_s, self._on_last_leg = 0.0, False
        off_m = experiences.params.odometry_drift * self.ground.new_m
        goal = self._old_ground(times) if off_m > p.return_sigma_m and not searching else None
        self.returning = goal is not None
        if self.returning:
            self.reason = f"back to known ground: off by up to {off_m:.1f} m"
        if goal is None:
            goal = self._closer.choose(experiences, ranges_m, times, self.ground.now_s, p)
            if goal is not None:
                self._last_leg, self._on_last_leg = self._closer, True
                self.reason = f"to close a loop: {times[goal]:.0f} s away by the links"
        if goal is None:
            goal = self._best_opening(experiences, local, times, p)
        self.explored = goal is None and (self.explored or (self._wander_s > WANDER_S and not searching))
        if goal is None and self.explored and self._wander_s > WANDER_S:
            goal = self._long_ago(times)
        if goal is not None:
            self._trip_most_s = TRIP_SLOW * float(times[goal]) + TRIP_MORE_S
            self.follower = RouteFollower(goal, self._bars)

    def _old_ground(self, times: NDArray[np.float64]) -> int | None:
        ground = self.ground
        old = np.flatnonzero(np.isfinite(times) & (ground.now_s - ground.made_s > OLD_AFTER_S))
        again = old[ground.last_s[old] - ground.made_s[old] > OLD_AFTER_S]
        known = again if len(again) else old[:1]  # at first only where it began
        return int(known[np.argmin(times[known])]) if len(known) else None

    def _best_opening(
        self, experiences: ExperienceMap, local: LocalMovement, times: NDArray[np.float64], p: PilotParams
    ) -> int | None:
        """The one with the most new ground for the time: over the links to where it was seen from, or straight if near."""
        rows, places, area = self.ground.openings(experiences)
        self.openings = places
        reached = np.isfinite(times[rows])
        rows, places, area = rows[reached], places[reached], area[reached]
        if not len(rows):
            return None
        poses, robot = experiences.poses, experiences.robot
        near = np.hypot(poses[rows, 0] - robot.x, poses[rows, 1] - robot.y) < PLACE_REACH_M
        begin = np.where(near[:, None], (robot.x, robot.y), poses[rows, :2])
        leg_s = np.hypot(*(places - begin).T) / p.cruise_speed
        bearing = wrap_angles(np.arctan2(places[:, 1] - robot.y, places[:, 0] - robot.x) - robot.heading_rad)
        cost = leg_s + np.where(near, np.abs(bearing) / p.turn_rate, times[rows])
        if _searching(experiences):
            x, y = poses[np.argmax(experiences.submap_of == experiences.submap_of[experiences.active]), :2]
            cost = cost + SEARCH_HOME * np.hypot(places[:, 0] - x, places[:, 1] - y) / p.cruise_speed
        best = int(np.argmax(area / (cost + BEGIN_S)))
        if near[best] and local.free_way(float(bearing[best]), p) > FREE_M:
            self._on_last_leg = True  # it sees it from here
        away = math.hypot(places[best, 0] - robot.x, places[best, 1] - robot.y)
        self.reason = f"new ground, {away:.0f} m away"
        goal, (x, y) = int(rows[best]), places[best].tolist()
        self._last_leg = Opening(goal, experiences.pose(goal).inverse().compose(Pose2(x, y, 0.0)))
        return goal

    def _long_ago(self, times: NDArray[np.float64]) -> int | None:
        known = np.flatnonzero(np.isfinite(times))
        if not len(known):
            return None
        goal = int(known[np.argmin(self.ground.last_s[known])])
        since_s = self.ground.now_s - self.ground.last_s[goal]
        self.reason = f"not seen for {since_s / 60:.0f} min"
        return goal if since_s > LONG_AGO_S else None


def _searching(experiences: ExperienceMap) -> bool:
    """Whether the robot looks for the rest of its map: another submap, no smaller than `SEARCH_SHARE` of its own."""
    sizes = np.bincount(experiences.submap_of)
    own = int(experiences.submap_of[experiences.active])
    return bool(np.delete(sizes, own).max(initial=0) > SEARCH_SHARE * sizes[own])


def _on_own_submap(experiences: ExperienceMap, experience: int) -> bool:
    return bool(experiences.submap_of[experience] == experiences.submap_of[experiences.active])
