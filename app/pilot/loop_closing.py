"""[ours] Closing loops: known ground that lies near on the map, but far by the links, is driven to and along.

A view is recognised where it was seen before, from the same side. So the robot drives along the old way as it drove there
before, in the middle between the walls, until it is recognised. The map may be off by metres there: the direction of the way
counts more than its place.
test_loop_closing.py::{test_known_ground_that_is_far_by_the_links_is_driven_along, test_it_is_not_tried_again_at_once,
test_from_elsewhere_it_does_not_head_for_the_same,
test_what_the_sonars_do_not_see_is_no_loop}.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.pilot.active_localisation import next_on, soonest
from app.pilot.known_ground import OPENING_GAP_M
from app.pilot.params import PilotParams
from app.pilot.tried import Tried
from disk import kind
from ratslam_core import ExperienceMap, Pose2, wrap_angles

FAR_M = 2.8  # so near to a way, its direction counts more than its place
LOOP_M = 30.0  # known ground at least this far by the links closes a loop, if it is near: `loop_share` of that way ...
LOOP_MOST_M = 150.0  # ... of which no more counts than this
LOOP_S = 40.0  # it is driven along for so long, so that it is recognised
ASK_S = 1.0  # it is looked so often whether links lead there by now
LOOP_AGAIN_S = 300.0  # from the same place, or to it, it is tried again after this time
MIDDLE_M, MIDDLE_AHEAD_M = 0.5, 1.5  # it keeps to the middle, steering aside by at most this, at a point so far ahead

_Array = NDArray[np.float64]
_Point = tuple[float, float]


@kind("loop closer/5")
class LoopCloser:
    """Chooses a loop to close, and drives until it is closed."""

    def __init__(self, sonar_angles_rad: _Array) -> None:
        """sonar_angles_rad: (8,), positive to the left."""
        self._angles = np.array(sonar_angles_rad, np.float64)
        self._goal = -1  # what it heads for first: the loop is closed when links lead there
        self._left_s = 0.0  # of driving along old ground
        self._times = np.zeros(0)  # s, to each experience by the links, ...
        self._ask_s = 0.0  # ... for so long still
        self._begun = Tried(FAR_M, LOOP_AGAIN_S)  # where it set out, ...
        self._sought = Tried(FAR_M, LOOP_AGAIN_S)  # ... and what it headed for

    def choose(
        self, experiences: ExperienceMap, ranges_m: NDArray[np.float32], times: _Array, now_s: float, p: PilotParams
    ) -> int | None:
        """The experience to head for, where there is a loop to close. times: (n,) s, to each experience by the links."""
        poses, robot = experiences.poses, experiences.robot
        if self._begun.near(experiences, np.array([(robot.x, robot.y)]), now_s).any():
            return None
        near = _near_but_far(poses, robot, times, p)
        near = near[~self._sought.near(experiences, poses[near, :2], now_s)]
        dx, dy = poses[near, 0] - robot.x, poses[near, 1] - robot.y
        bearing = wrap_angles(np.arctan2(dy, dx) - robot.heading_rad)
        beams = np.argmin(np.abs(self._angles - bearing[:, None]), axis=1)
        seen = ranges_m[beams] >= np.minimum(np.hypot(dx, dy), FAR_M + OPENING_GAP_M)
        ahead = near[seen & (np.abs(bearing) <= abs(self._angles[0]))]
        if not len(ahead):
            return None
        goal = int(ahead[soonest(robot, poses, ahead, p)])
        here = experiences.pose(experiences.active).inverse().compose(robot)
        self._begun.add(experiences, experiences.active, here.x, here.y, now_s)
        self._sought.add(experiences, goal, 0.0, 0.0, now_s)
        self._goal, self._left_s, self._ask_s = goal, LOOP_S, 0.0
        return goal

    def aim(self, experiences: ExperienceMap, dt: float, p: PilotParams) -> _Point | None:
        """The next point to head for, m, robot's frame; None when the loop is closed, or was not for too long."""
        self._left_s -= dt
        poses, robot = experiences.poses, experiences.robot
        near = _near_but_far(poses, robot, self._asked(experiences, dt), p)
        if self._left_s <= 0.0 or not len(near) or self._times[self._goal] * p.cruise_speed < LOOP_M:
            return None
        at = soonest(robot, poses, near, p)
        way = experiences.pose(int(near[at]))
        here = way.inverse().compose(robot)
        if math.hypot(here.x, here.y) < FAR_M:
            robot = way.compose(Pose2(here.x, max(-MIDDLE_M, min(MIDDLE_M, here.y)), here.heading_rad))
        return next_on(at, robot, poses, near)

    def _asked(self, experiences: ExperienceMap, dt: float) -> _Array:
        """Seconds to each experience by the links, as they were a moment ago."""
        self._ask_s -= dt
        if self._ask_s <= 0.0 or len(self._times) > len(experiences):
            self._times, self._ask_s = experiences.temporal_map.times_to(experiences.active), ASK_S
        return self._times


def _near_but_far(poses: _Array, robot: Pose2, times: _Array, p: PilotParams) -> NDArray[np.int64]:
    """Experiences (k,) that lie near on the map, but far by the links. times: s, of the first so many."""
    way = times * p.cruise_speed
    away = np.hypot(poses[: len(way), 0] - robot.x, poses[: len(way), 1] - robot.y)
    # Where no links lead, as on another submap, the map does not say what is near.
    far = np.isfinite(way) & (way > LOOP_M)
    return np.flatnonzero((away < p.loop_share * np.minimum(way, LOOP_MOST_M)) & far).astype(np.int64)


def in_the_middle(aim: _Point, ranges_m: NDArray[np.float32]) -> _Point:
    """The aim, nearer, and moved towards the side where more is free."""
    away = math.hypot(*aim)
    share = min(1.0, MIDDLE_AHEAD_M / away) if away > 0 else 1.0
    aside = (float(ranges_m[0]) - float(ranges_m[-1])) / 2
    return aim[0] * share, aim[1] * share + max(-MIDDLE_M, min(MIDDLE_M, aside))
