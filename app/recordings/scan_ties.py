"""[ours] A laser measures where a new experience lies to old ones near it in the map, by laying its scan over theirs.

A view says that a place is known; only the pose cells say where in it the robot is, to a cell. A scan says it to centimetres.
What a scan says wrongly, the exact correction gives up like any other closure.
test_recorded_motion.py::test_a_scan_ties_an_experience_to_an_old_one_where_it_belongs.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.recordings.recording import About
from app.recordings.scan_matching import Points, Walls, points_of
from app.recordings.scan_odometry import FARTHEST_M
from disk import kind
from ratslam_core import ExperienceMap

RECENT = 15  # experiences: those made just before are tied by odometry already
MOST = 3  # experiences that a new one is tied to
TRIED = 6  # experiences whose scans are laid under it
REACH_M, MOST_REACH_M = 1.0, 3.0  # in the map: who knows little of its place looks farther
TURNED_RAD = math.radians(70)  # scans that look elsewhere show no common walls
FITS = 0.6  # share of the points that must lie on walls
SIGMA_M = 0.05  # of what a scan says


@kind("scan ties/1")
class ScanTies:
    """Keeps the scan of each experience."""

    def __init__(self, about: About) -> None:
        self._angles = np.array(about.beam_angles_rad)
        self._limit_m = min(FARTHEST_M, about.range_limit_m or FARTHEST_M)
        self._scans: dict[int, Points] = {}

    def made(self, map_: ExperienceMap, ranges_m: NDArray[np.float64]) -> None:
        """The active experience was just made, where this scan was taken: tie it to those whose scans agree with it."""
        new = map_.active
        now = self._scans[new] = points_of(ranges_m, self._angles, self._limit_m)
        tied = 0
        for old in self._near(map_, new):
            told = map_.pose(old).inverse().compose(map_.pose(new))
            found = Walls(self._scans[old]).match(now, told, FITS)
            if found is not None:
                map_.tie(old, new, found, SIGMA_M)
                tied += 1
            if tied == MOST:
                return

    def _near(self, map_: ExperienceMap, new: int) -> list[int]:
        """The old experiences nearest to the new one in the map that look about the same way."""
        poses, here = map_.poses[: max(new - RECENT, 0)], map_.pose(new)
        away = np.hypot(poses[:, 0] - here.x, poses[:, 1] - here.y)
        turned = np.abs(np.remainder(poses[:, 2] - here.heading_rad + math.pi, math.tau) - math.pi)
        reach = min(max(REACH_M, 3 * map_.pose_filter.sigma_m), MOST_REACH_M)
        near = np.flatnonzero((away < reach) & (turned < TURNED_RAD))
        nearest = near[np.argsort(away[near], kind="stable")][:TRIED]
        return [int(i) for i in nearest if int(i) in self._scans]
