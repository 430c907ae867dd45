"""[ours] Closing loops: known ground that lies near on the map, but far by the links, is driven to and along.

A view is recognised where it was seen before, from the same side. So the robot drives along the old road in the
direction in which it drove there before, in the middle between the walls, until it is recognised or the road ends. The
map may be off by metres there: the direction of the road counts more than its place.
test_loop_closing.py::{test_known_ground_that_is_far_by_the_links_is_driven_along,
test_it_is_not_tried_again_at_once, test_what_the_sonars_do_not_see_is_no_loop}.
"""

from __future__ import annotations

import math
from bisect import bisect

import numpy as np
from numpy.typing import NDArray

from app.pilot.known_ground import FAR_M, OPENING_GAP_M, placed
from app.pilot.params import PilotParams
from disk import kind
from ratslam_core import ExperienceMap, Pose2

LOOP_M = 30.0  # known ground at least this far by the links closes a loop, if it is near: `loop_share` of that way ...
LOOP_MOST_M = 150.0  # ... of which no more counts than this
LOOP_DRIVE_M = 25.0  # it is followed for this far, so that it is recognised
LOOP_AGAIN_S = 300.0  # from the same place it is tried again after this time
MIDDLE_M, MIDDLE_AHEAD_M = 0.5, 1.5  # it keeps to the middle, steering aside by at most this, at a point so far ahead

_Array = NDArray[np.float64]


@kind("loop closer/1")
class LoopCloser:
    """The known road that the robot drives along, and where it has tried to close a loop."""

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
        turn = np.abs(wrapped(poses[near, 2] - robot.heading_rad))
        near = near[np.argsort(away[near] / p.cruise_speed + turn / p.turn_rate, kind="stable")]
        bearing = wrapped(np.arctan2(dy[near], dx[near]) - robot.heading_rad)
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


def wrapped(angles: _Array) -> _Array:
    """Angles (rad) between -pi and pi."""
    return np.remainder(angles + math.pi, 2 * math.pi) - math.pi
