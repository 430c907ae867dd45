"""[ours] Loop closures by echoes: what the eyes do not recognise, since the robot comes from the other side, the sonars do.

A view is recognised from where it was seen, by a robot that faces as it did then. So who comes back along a corridor closes no
loop, and maps it a second time. Walls sound the same from either side. Where the map has old ground near the robot, and nothing
but odometry between then and now, the echoes of the last metres are laid over those of then. Once they may agree by chance;
if they do so again some way on, and say the same of where the robot is, the two places are tied.
test_echo_closures.py::{test_who_comes_back_the_other_way_closes_the_loop, test_one_match_is_no_closure,
test_what_is_tied_already_is_not_tied_again}.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from disk import kind
from ratslam_core.extensions import scan_matching
from ratslam_core.extensions.odometry_edges import open_way_m
from ratslam_core.extensions.scan_matching import ScanMatching
from ratslam_core.extensions.submaps import Submaps
from ratslam_core.pose_graph.transitions import Transitions
from ratslam_core.types import Pose2, wrap_angle

NEAR_M = 1.0  # on the map; an old experience this near may be beside the robot
OPEN_M = 3.0  # of odometry that no closure bridges make a new one worth while
POINTS = 60  # echoes that either scan must have
APART_M, SIGMA_M = 0.13, 0.13  # and how well the two must agree
ALIKE_M, ALIKE_RAD = 0.3, 0.15  # two matches say the same if what they make of the robot's pose differs by no more
LEAST, MOST = 10, 60  # scans kept on the way from one match to the other: a metre, and as much as is matched at once


class Map(scan_matching.Map, Protocol):
    """What has to be known of an experience map, and done to it."""

    here: int
    carried: bool
    submaps: Submaps
    transitions: Transitions

    @property
    def robot_here(self) -> Pose2: ...
    def pose(self, experience: int, /) -> Pose2: ...
    def tie(self, i: int, j: int, moved: Pose2, sigma_m: float, *, way: bool) -> None: ...


@kind("echo closures/1")
class EchoClosures:
    """Remembers the first of two matches."""

    def __init__(self) -> None:
        self._moved: Pose2 | None = (
            None  # what that match made of the robot's pose: from where the map has it to where it is
        )
        self._at = 0  # how many scans had been kept then
        self.count = 0  # of ties so far
        self.last = -1, -1  # the two experiences of the last one, the old one first

    def made(self, map_: Map, scans: ScanMatching) -> None:
        """An experience was just made where the robot is: tie it to an old one, if echoes say twice that this is beside it."""
        if map_.carried:
            self._moved = None
            return
        old = _old_beside(map_, scans)
        if old < 0:
            return
        robot = map_.robot_here
        found = scans.match(map_, old, map_.pose(old).inverse().compose(robot))
        if found is None or found.points < POINTS or found.apart_m > APART_M or found.sigma_m > SIGMA_M:
            return
        there = map_.pose(old).compose(found.pose)
        if self._again(robot, there, scans.count):
            new = map_.pose(map_.here)
            map_.tie(old, map_.here, found.pose.compose(robot.inverse().compose(new)), found.sigma_m, way=True)
            self._moved, self.count, self.last = None, self.count + 1, (old, map_.here)

    def _again(self, robot: Pose2, there: Pose2, count: int) -> bool:
        """Whether an earlier match, some way back, has said the same; if none has, this one is remembered."""
        if self._moved is not None and count - self._at <= MOST and _alike(self._moved.compose(robot), there):
            return count - self._at >= LEAST
        self._moved, self._at = there.compose(robot.inverse()), count
        return False


def _alike(a: Pose2, b: Pose2) -> bool:
    return math.hypot(a.x - b.x, a.y - b.y) < ALIKE_M and abs(wrap_angle(a.heading_rad - b.heading_rad)) < ALIKE_RAD


def _old_beside(map_: Map, scans: ScanMatching) -> int:
    """The nearest old experience that lies beside the robot and is tied to it by odometry alone; -1 for none."""
    robot = map_.robot_here
    away = np.hypot(map_.poses[:, 0] - robot.x, map_.poses[:, 1] - robot.y)
    old = (map_.submap_of == map_.submaps.current) & scans.before(len(map_)) & (away < NEAR_M)
    if not old.any():
        return -1
    nearest = int(np.argmin(np.where(old, away, np.inf)))
    return nearest if open_way_m(map_.transitions, nearest, len(map_)) >= OPEN_M else -1
