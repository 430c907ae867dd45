"""[ours] Exploring on purpose: where to drive next, over its own map, and why.

Wandering follows walls and crosses at random, as in IROS 2005; nothing in it seeks what the map lacks. The robot goes, in
this order: back to old ground when its odometry may be off by too much since it was last there; along known ground that is
near but far by the links, which closes a loop; into the opening with the most new ground for the time. Only where nothing is
new does it wander, and between whiles visit the place where it has not been for longest. On a submap, as after a kidnap, it
looks for the rest of its map: it does not go back, any beam makes an opening, and those near where the submap began come
first: perhaps it was not carried at all, and then the rest lies there. Its input is map, sonars and odometry only.
test_seeking.py::{test_it_goes_where_open_floor_was_seen, test_on_new_ground_for_long_it_goes_back,
test_before_it_came_to_anything_again_it_goes_back_to_where_it_began,
test_with_nothing_new_it_goes_where_it_has_not_been_for_longest, test_while_there_is_an_opening_it_does_not_wander,
test_on_a_submap_it_does_not_go_back, test_on_a_submap_it_begins_where_that_began}.
"""

from __future__ import annotations

import math
from bisect import bisect

import numpy as np
from numpy.typing import NDArray

from app.pilot.bars import Bars
from app.pilot.known_ground import OLD_AFTER_S, OPENING_BEAMS, OPENING_GAP_M, PLACE_REACH_M, KnownGround, placed
from app.pilot.local_movement import LocalMovement
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
SEARCH_BEAMS = 1  # ... and an opening is what so many beams have seen
BEGIN_S = 10.0  # added to the time of each way: small ground near by is not worth a start
INTO_S, INTO_REACH_M = 25.0, 0.4  # driving into an opening ends after this time, or this near to its place ...
INTO_STILL_S, INTO_STEP_M = 4.0, 0.1  # ... or when for so long it came no such step nearer
INTO_FREE_M = 0.2  # it is seen from here if so much is free towards it

_Point = tuple[float, float]


@kind("seeker/5")
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
        self._opening: Pose2 | None = None  # what to drive into at the end of the trip, in the frame of its experience
        self._closer = LoopCloser(sonar_angles_rad)
        self._into_s = -1.0  # time of driving into it, below 0 on the way there
        self._nearest_m, self._nearer_s = math.inf, 0.0  # how near to the opening it came, and when, as `_into_s`
        self._trip_s = self._trip_most_s = 0.0
        self._wander_s = 0.0  # time since the last trip
        self._wait_s = 0.0  # time before it chooses again

    @property
    def failed(self) -> bool:
        """In this tick: the robot could not get on, and should back out."""
        return self.follower is not None and self.follower.failed

    @property
    def on_new_ground(self) -> bool:
        """Whether it drives into an opening, or along a road that may close a loop."""
        return self.follower is not None and self._into_s >= 0.0

    @property
    def rests(self) -> bool:
        """Whether to stop it would change nothing."""
        return self.follower is None and self._wander_s == self._wait_s == 0.0 and self._closer.rests

    def target(self, experiences: ExperienceMap) -> _Point | None:
        """Where the trip leads, m, map frame; None while it wanders."""
        if self.follower is None:
            return None
        place = experiences.pose(self.follower.goal)
        place = place if self._opening is None else place.compose(self._opening)
        return place.x, place.y

    def stop(self) -> None:
        """Something else is wanted of the robot."""
        self.follower, self._opening, self._wander_s, self._wait_s, self.reason = None, None, 0.0, 0.0, ""
        self._closer.stop()

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
        return aim if aim is None or not self._closer.road else _in_the_middle(aim, ranges_m)

    def _aim(
        self, follower: RouteFollower, experiences: ExperienceMap, local: LocalMovement, dt: float, p: PilotParams
    ) -> _Point | None:
        if self._trip_s > self._trip_most_s or (self.returning and self.ground.new_m == 0.0):
            return None
        if self._into_s < 0.0:
            aim = follower.step(experiences, local, dt, p)
            if aim is not None or follower.state != "arrived" or self._opening is None:
                return aim
        self._into_s += dt
        if self._into_s > INTO_S:
            return None
        if self._closer.road:
            aim, passed = self._closer.aim(experiences, p)
            self._into_s = 0.0 if passed else self._into_s
            return aim
        if self._opening is None:
            return None
        place = experiences.pose(follower.goal).compose(self._opening)
        here = experiences.robot.inverse().compose(place)
        away_m = math.hypot(here.x, here.y)
        if away_m < self._nearest_m - INTO_STEP_M:
            self._nearest_m, self._nearer_s = away_m, self._into_s
        still = self._into_s - self._nearer_s > INTO_STILL_S
        return None if away_m < INTO_REACH_M or still else (here.x, here.y)

    def _end(self, experiences: ExperienceMap) -> None:
        assert self.follower is not None
        goal = experiences.pose(self.follower.goal)
        self.ground.been_at(goal.x, goal.y, experiences.poses)
        if self._opening is not None:
            self.ground.tried(self.follower.goal, self._opening.x, self._opening.y, experiences.poses)
        barred = self.follower.state == "exploring"
        self.stop()
        self._wait_s = AFTER_BARRED_S if barred else 0.0

    def _choose(
        self, experiences: ExperienceMap, local: LocalMovement, ranges_m: NDArray[np.float32], p: PilotParams
    ) -> None:
        """Old ground if odometry may be far off; else a loop to close; else the best opening; else, after wandering,
        the place that was not visited for longest."""
        times, searching = experiences.temporal_map.times_to(experiences.active), _searching(experiences)
        self._trip_s, self._into_s = 0.0, -1.0
        self._nearest_m, self._nearer_s = math.inf, 0.0
        off_m = experiences.params.odometry_drift * self.ground.new_m
        goal = self._old_ground(times) if off_m > p.return_sigma_m and not searching else None
        self.returning = goal is not None
        if self.returning:
            self.reason = f"back to known ground: off by up to {off_m:.1f} m"
        if goal is None and self._closer.choose(experiences, ranges_m, times, self.ground.now_s, p):
            goal, self._into_s = self._closer.road[0], 0.0
            self.reason = f"to close a loop: {times[goal]:.0f} s away by the links"
        if goal is None:
            goal = self._best_opening(experiences, local, times, p, SEARCH_BEAMS if searching else OPENING_BEAMS)
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
        self, experiences: ExperienceMap, local: LocalMovement, times: NDArray[np.float64], p: PilotParams, least: int
    ) -> int | None:
        """The one with the most new ground for the time: over the links to where it was seen from, or straight if near."""
        rows, places, area = self.ground.openings(experiences, least)
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
        if near[best] and local.free_way(float(bearing[best]), p) > INTO_FREE_M:
            self._into_s = 0.0  # it sees it from here
        away = math.hypot(places[best, 0] - robot.x, places[best, 1] - robot.y)
        self.reason = f"new ground, {away:.0f} m away"
        return self._into(experiences, int(rows[best]), places[best])

    def _into(self, experiences: ExperienceMap, goal: int, place: NDArray[np.float64]) -> int:
        """Drive into this place (2,), m, map frame, from where it was seen."""
        self._opening = experiences.pose(goal).inverse().compose(Pose2(float(place[0]), float(place[1]), 0.0))
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


def _in_the_middle(aim: _Point, ranges_m: NDArray[np.float32]) -> _Point:
    """The aim, nearer, and moved towards the side where more is free."""
    away = math.hypot(*aim)
    share = min(1.0, MIDDLE_AHEAD_M / away) if away > 0 else 1.0
    aside = (float(ranges_m[0]) - float(ranges_m[-1])) / 2
    return aim[0] * share, aim[1] * share + max(-MIDDLE_M, min(MIDDLE_M, aside))


FAR_M = 2.8  # experiences of a road are about so far apart, and the robot is on it when it is as near
LOOP_M = 30.0  # known ground at least this far by the links closes a loop, if it is near: `loop_share` of that way ...
LOOP_MOST_M = 150.0  # ... of which no more counts than this
LOOP_DRIVE_M = 25.0  # it is followed for this far, so that it is recognised
LOOP_AGAIN_S = 300.0  # from the same place it is tried again after this time
MIDDLE_M, MIDDLE_AHEAD_M = 0.5, 1.5  # it keeps to the middle, steering aside by at most this, at a point so far ahead

_Array = NDArray[np.float64]


@kind("loop closer/1")
class LoopCloser:
    """[ours] Closing loops: known ground that lies near on the map, but far by the links, is driven to and along.

    A view is recognised where it was seen before, from the same side. So the robot drives along the old road in the
    direction in which it drove there before, in the middle between the walls, until it is recognised or the road ends. The
    map may be off by metres there: the direction of the road counts more than its place.
    test_loop_closing.py::{test_known_ground_that_is_far_by_the_links_is_driven_along,
    test_it_is_not_tried_again_at_once, test_what_the_sonars_do_not_see_is_no_loop}.
    """

    def __init__(self, sonar_angles_rad: _Array) -> None:
        """sonar_angles_rad: (8,), positive to the left."""
        self._angles = np.array(sonar_angles_rad, np.float64)
        self.road: list[int] = []  # experiences to come to, one after the other
        self._there = False  # whether it has come to the first
        self._tried: list[tuple[int, float, float]] = []  # where it set out: m, in the frame of an experience
        self._tried_s: list[float] = []  # and when

    @property
    def rests(self) -> bool:
        """Whether to stop it would change nothing."""
        return not (self.road or self._there)

    def stop(self) -> None:
        """Something else is wanted of the robot."""
        self.road, self._there = [], False

    def choose(
        self, experiences: ExperienceMap, ranges_m: NDArray[np.float32], times: _Array, now_s: float, p: PilotParams
    ) -> bool:
        """Whether there is a loop to close; then `road` is set. times: (n,) s, to each experience by the links."""
        poses, robot = experiences.poses, experiences.robot
        if self._tried_near(robot, experiences, now_s):
            return False
        dx, dy = poses[:, 0] - robot.x, poses[:, 1] - robot.y
        away, way = np.hypot(dx, dy), times * p.cruise_speed
        near = np.flatnonzero((away < p.loop_share * np.minimum(way, LOOP_MOST_M)) & (way > LOOP_M))
        turn = np.abs(wrap_angles(poses[near, 2] - robot.heading_rad))
        near = near[np.argsort(away[near] / p.cruise_speed + turn / p.turn_rate, kind="stable")]
        bearing = wrap_angles(np.arctan2(dy[near], dx[near]) - robot.heading_rad)
        beams = np.argmin(np.abs(self._angles - bearing[:, None]), axis=1)
        seen = ranges_m[beams] >= np.minimum(away[near], FAR_M + OPENING_GAP_M)
        for row in near[seen & (np.abs(bearing) <= abs(self._angles[0]))].tolist():
            road = _road(poses, row)
            if len(road) > 1:
                here = experiences.pose(experiences.active).inverse().compose(robot)
                self._tried.append((experiences.active, here.x, here.y))
                self._tried_s.append(now_s)
                self.road, self._there = road, False
                return True
        return False

    def _tried_near(self, robot: Pose2, experiences: ExperienceMap, now_s: float) -> bool:
        """Whether it was tried near here, and not long ago."""
        if self._tried and max(row for row, _, _ in self._tried) >= len(experiences):  # another map
            self._tried, self._tried_s = [], []
        x, y = placed(self._tried[bisect(self._tried_s, now_s - LOOP_AGAIN_S) :], experiences.poses).T
        return bool(np.any(np.hypot(x - robot.x, y - robot.y) < FAR_M))

    def aim(self, experiences: ExperienceMap, p: PilotParams) -> tuple[tuple[float, float] | None, bool]:
        """The next point to head for, m, robot's frame, None at the end of the road or when the loop is closed; and
        whether the robot has just come to the next experience of the road."""
        pose, passed = experiences.pose(self.road[0]), False
        here = pose.inverse().compose(experiences.robot)
        if not self._there:
            self._there = math.hypot(here.x, here.y) < FAR_M
        elif here.x > -FAR_M / 2:
            del self.road[0]
            if not self.road or self._closed(experiences, p):
                return None, False
            pose, passed = experiences.pose(self.road[0]), True
            here = pose.inverse().compose(experiences.robot)
        aside = here.y - max(-MIDDLE_M, min(MIDDLE_M, here.y)) if self._there else 0.0
        ahead = max(here.x + MIDDLE_AHEAD_M, 0.0) if self._there else 0.0
        point = experiences.robot.inverse().compose(pose.compose(Pose2(ahead, aside, 0.0)))
        return (point.x, point.y), passed

    def _closed(self, experiences: ExperienceMap, p: PilotParams) -> bool:
        """Whether links lead to the road by now."""
        times = experiences.temporal_map.times_to(experiences.active)
        return bool(times[self.road[0]] * p.cruise_speed < LOOP_M)


def _road(poses: _Array, start: int) -> list[int]:
    """Experiences from this one on in the direction it faces, some metres apart, as far as `LOOP_DRIVE_M`."""
    road, way = [start], 0.0
    while way < LOOP_DRIVE_M:
        x, y, heading = poses[road[-1]]
        c, s = math.cos(heading), math.sin(heading)
        ahead, aside = c * (poses[:, 0] - x) + s * (poses[:, 1] - y), -s * (poses[:, 0] - x) + c * (poses[:, 1] - y)
        on = (ahead > FAR_M) & (ahead < 2 * FAR_M) & (np.abs(aside) < FAR_M / 2)
        turn = poses[:, 2] - heading  # on the road is what faces along it rather than across
        on = np.flatnonzero(on & (np.cos(turn) > np.abs(np.sin(turn))))
        if not len(on):
            break
        road.append(int(on[np.argmin(np.abs(aside[on]))]))
        way += float(ahead[road[-1]])
    return road
