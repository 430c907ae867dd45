"""[ours] How a laser moved between two scans: the second is laid over the first. What wheels say is where to begin.

Wheels that slip turn a robot by degrees between two scans; a scan tells the turn to a fraction of one. Point to line, as
Censi 2008. test_recorded_motion.py::test_a_movement_in_a_room_is_found.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree  # pyright: ignore  # SciPy has no stubs

from ratslam_core import Pose2, wrap_angle

Points = NDArray[np.float64]  # (n, 2), m

STARTS_RAD = tuple(math.radians(d) for d in (0, -8, 8, -16, 16))  # added to the turn of the wheels
ROUNDS = 15
LEAST_POINTS = 30
LEAST, WELL = 0.15, 0.85  # share of the points on walls: to be believed, and to try no other start
NEAR = 0.4  # m to begin with; points farther from every line say nothing, and this shrinks to a quarter
TRUST_M, TRUST_RAD = 0.5, 0.4  # from what the wheels say; a match beyond is none
SPLIT = 0.3  # share of the range by which two beams side by side may differ and still show one wall


def points_of(ranges_m: NDArray[np.float64], angles_rad: NDArray[np.float64], limit_m: float) -> Points:
    """Where the beams end, in the frame of the laser; those that end nowhere are left out."""
    ends = np.isfinite(ranges_m) & (ranges_m > 0) & (ranges_m < limit_m)
    r, a = ranges_m[ends], angles_rad[ends]
    return np.stack([r * np.cos(a), r * np.sin(a)], axis=1)


def normals_of(points: Points) -> tuple[Points, Points]:
    """Points with the direction across the wall that they and their neighbours lie on, (n, 2) each."""
    kept: list[int] = []
    for k in range(1, len(points) - 1):
        gap = SPLIT * float(np.hypot(*points[k])) + 0.05
        if all(float(np.hypot(*(b - a))) < gap for a, b in pairwise(points[k - 1 : k + 2])):
            kept.append(k)
    along = points[[k + 1 for k in kept]] - points[[k - 1 for k in kept]]
    along = along / np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)[:, None]
    return points[kept], np.stack([-along[:, 1], along[:, 0]], axis=1)


class Walls:
    """A scan over which others are laid."""

    def __init__(self, points: Points) -> None:
        self.points, self.normals = normals_of(points)
        self._tree: Any = cKDTree(self.points) if len(self.points) >= LEAST_POINTS else None

    def nearest(self, points: Points) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """How far each point is from the nearest one of the walls, and which that is; (n,) each."""
        away, which = self._tree.query(points)
        return np.asarray(away, np.float64), np.asarray(which, np.int64)

    def match(self, now: Points, told: Pose2, least: float = LEAST) -> Pose2 | None:
        """The pose of the scan `now` in the frame of this one; None when no start near `told` fits well."""
        if self._tree is None or len(now) < LEAST_POINTS:
            return None
        fits, best = 0.0, told
        for turn in STARTS_RAD:
            fitted, pose = _settle(self, now, told, turn)
            if fitted > fits:
                fits, best = fitted, pose
            if fits > WELL:
                break
        far = math.hypot(best.x - told.x, best.y - told.y) > TRUST_M
        if fits < least or far or abs(wrap_angle(best.heading_rad - told.heading_rad)) > TRUST_RAD:
            return None
        return best


def _settle(walls: Walls, now: Points, told: Pose2, turn: float) -> tuple[float, Pose2]:
    """From one start to where it settles: (share of the points that lie on a wall, less how far off they are; pose)."""
    x, y, heading = told.x, told.y, told.heading_rad + turn
    fits = 0.0
    for k in range(ROUNDS):
        near = NEAR * (1 - 0.75 * k / (ROUNDS - 1))
        c, s = math.cos(heading), math.sin(heading)
        at = now @ np.array([[c, s], [-s, c]]) + (x, y)
        away, which = walls.nearest(at)
        on = away < near
        if on.sum() < LEAST_POINTS // 2:
            return 0.0, told
        n, p = walls.normals[which[on]], at[on]
        off = ((p - walls.points[which[on]]) * n).sum(axis=1)
        rows = np.stack([n[:, 0], n[:, 1], n[:, 1] * (p[:, 0] - x) - n[:, 0] * (p[:, 1] - y)], axis=1)
        doubt = np.diag([1e-2, 1e-2, 1e-3]) * len(
            rows
        )  # where all walls are parallel, it stays where the wheels put it
        step = np.asarray(np.linalg.solve(rows.T @ rows + doubt, -rows.T @ off), np.float64)
        x, y, heading = x + float(step[0]), y + float(step[1]), heading + float(step[2])
        fits = float(on.mean()) - float(np.abs(off).mean()) / near / 4
    return fits, Pose2(x, y, wrap_angle(heading))
