"""[ours] A laser measures where the robot is to experiences near it in the map, by laying its scan over theirs.

A view says that a place is known; only the pose cells say where in it the robot is, to a cell, and many places look alike.
A scan says it to centimetres. So a new experience is tied to old ones, and a look counts only where the scans agree: it is
then as precise as they are. Each of the two scans must say the same when it is laid over the other. What a scan says
wrongly all the same, the exact correction gives up like any other closure.
test_scan_ties.py::{test_a_scan_ties_an_experience_to_an_old_one_where_it_belongs,test_a_look_alike_is_found_out_by_its_scan}.
`ScanRules` has the plain twins.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.recordings.recording import About
from app.recordings.scan_odometry import FARTHEST_M, Points, ScanRules, Walls, alike, points_of
from disk import kind
from ratslam_core import ExperienceMap, Pose2

RECENT = 15  # experiences: those made just before are tied by odometry already
MOST = 3  # experiences that a new one is tied to
TRIED = 6  # experiences whose scans are laid under it
REACH_M, MOST_REACH_M = 1.0, 3.0  # in the map: who knows little of its place looks farther
TURNED_RAD = math.radians(70)  # scans that look elsewhere show no common walls
FITS = 0.35  # share of the points that must lie on walls, either way
LEAST_OFF_M, MOST_OFF_M = 0.5, 2.0  # how far a scan is looked for around where it should lie
NEAR_TIMES = 3.0  # so many times the error of a match is near
RIVAL = 0.05  # by so much it must fit better than in any other place near there
SIGMA_M = 0.05  # of what a scan says where there are walls on all sides
HOLDS = 0.02  # less of the walls across a direction says nothing of it: a bare corridor


@kind("scan ties/2")
class ScanTies:
    """Keeps the scan of each experience."""

    def __init__(self, about: About, rules: ScanRules | None = None) -> None:
        self._rules = rules or ScanRules()
        self._angles = np.array(about.beam_angles_rad)
        self._limit_m = min(FARTHEST_M, about.range_limit_m or FARTHEST_M)
        self._scans: dict[int, Points] = {}
        self._now: Points | None = None

    def see(self, ranges_m: NDArray[np.float64] | None) -> None:
        """What the robot sees now."""
        self._now = None if ranges_m is None else points_of(ranges_m, self._angles, self._limit_m)

    def made(self, map_: ExperienceMap) -> None:
        """An experience was just made, where this scan was taken: tie it to those whose scans agree with it."""
        if self._now is None:
            return
        new = map_.here
        self._scans[new] = self._now.copy()  # a state holds each array once
        tied = 0
        for old in self._near(map_, new):
            found = self._laid(map_, old, map_.pose(old).inverse().compose(map_.pose(new)), _off(map_))
            if found is not None:
                self._tie(map_, old, *found)
                tied += 1
            if tied == MOST:
                return

    def confirms(self, map_: ExperienceMap, experience: int, look: Pose2) -> tuple[Pose2, float] | None:
        """Where the robot is in the frame of an experience, and give or take what (m); None if the scans do not agree.

        look: what the view and the pose cells say.
        """
        if not self._rules.confirmed or self._now is None or experience not in self._scans:
            return look, math.inf
        believed = map_.pose(experience).inverse().compose(map_.robot_here)
        return self._laid(map_, experience, believed, LEAST_OFF_M) or self._laid(map_, experience, look, LEAST_OFF_M)

    def _tie(self, map_: ExperienceMap, old: int, found: Pose2, sigma_m: float) -> None:
        map_.tie(old, map_.here, found, sigma_m)
        at = map_.pose(old).compose(found)
        off = math.hypot(at.x - map_.robot_here.x, at.y - map_.robot_here.y)
        map_.pose_filter.sigma_m = min(map_.pose_filter.sigma_m, off + sigma_m)  # until the map has followed

    def _laid(self, map_: ExperienceMap, old: int, told: Pose2, off_m: float) -> tuple[Pose2, float] | None:
        """The scan of now over an old one: its pose there and how precise that is; None if that is not sure.

        off_m: how far off `told` may be.
        """
        now, before = self._now, self._scans[old]
        found = None if now is None else Walls(before).match(now, told, FITS, reach_m=off_m)
        if now is None or found is None:
            return None
        sigma = SIGMA_M
        if self._rules.weighed:
            if found.holds < HOLDS:
                return None
            sigma /= math.sqrt(2 * found.holds)
        if self._rules.mutual and not (found.fits - found.rival >= RIVAL and _back(found.pose, now, before)):
            return None
        if self._rules.neighbours and not self._agreed(map_, now, old, found.pose):
            return None
        return found.pose, sigma

    def _agreed(self, map_: ExperienceMap, now: Points, old: int, found: Pose2) -> bool:
        """Whether that is about where the robot believes to be, or else the scans made next to the old one say the same."""
        there = map_.pose(old).compose(found)
        if alike(there, map_.robot_here, NEAR_TIMES):
            return True
        for other in (old - 1, old + 1, old - 2, old + 2):
            if other in self._scans and other != map_.here:
                told = map_.pose(other).inverse().compose(there)
                also = Walls(self._scans[other]).match(now, told, FITS)
                if also is not None and alike(also.pose, told, 2.0):
                    return True
        return False

    def _near(self, map_: ExperienceMap, new: int) -> list[int]:
        """The old experiences nearest to the new one in the map that look about the same way."""
        poses, here = map_.poses[: max(new - RECENT, 0)], map_.pose(new)
        away = np.hypot(poses[:, 0] - here.x, poses[:, 1] - here.y)
        turned = np.abs(np.remainder(poses[:, 2] - here.heading_rad + math.pi, math.tau) - math.pi)
        reach = min(max(REACH_M, 3 * map_.pose_filter.sigma_m), MOST_REACH_M)
        near = np.flatnonzero((away < reach) & (turned < TURNED_RAD))
        nearest = near[np.argsort(away[near], kind="stable")][:TRIED]
        return [int(i) for i in nearest if int(i) in self._scans]


def _off(map_: ExperienceMap) -> float:
    """How far (m) the robot may be off in the map."""
    return min(max(LEAST_OFF_M, 2 * map_.pose_filter.sigma_m), MOST_OFF_M)


def _back(found: Pose2, now: Points, before: Points) -> bool:
    """Whether the old scan, laid over that of now, says the same."""
    back = Walls(now).match(before, found.inverse(), FITS)
    return back is not None and alike(back.pose.inverse(), found)
