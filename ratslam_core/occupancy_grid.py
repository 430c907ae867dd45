"""Occupancy: a picture for people of where the sonars met something. ACRA 2004 section 6.1, IROS 2005 section V.A.

A simplified wide sonar beam after Moravec and Elfes and a Bayesian update in log odds. SLAM and navigation do not read it.
`OccupancyGrid` is the papers' picture, in the pose cells' own frame. `MapGrid` bends with the experience map.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from ratslam_core.types import Floats, Packet, Pose2, Singles, grown, require_finite, wrap_angle

HALF_BEAM_RAD = math.radians(15) / 2  # of a sonar; Moravec and Elfes
DEPTH_M = 0.1  # how far off an echo may be; Moravec and Elfes
FARTHEST_M = 5.0  # a range of this or more means no echo
FREE, OCCUPIED = 0.4, 0.6  # how certain one echo makes it that the floor before it is free, that something stands there
BOUND = 5.0  # log odds stay within +- this, so that the picture can change
SAME_M, SAME_RAD = 0.1, math.radians(10)  # a scan no farther from the newest of its experience replaces it
KEPT = 6  # scans of each experience; a new one replaces the oldest
MOST_CELLS = 1024  # along one side of a metric picture; a larger map is drawn with larger cells


@kind("occupancy grid/2")
class OccupancyGrid:
    """The picture in the frame of the pose cells: it wraps as they do and jumps when they relocalise."""

    def __init__(self, shape: tuple[int, int, int], cell_m: float, sonar_angles_rad: Sequence[float] | Floats) -> None:
        """shape: (n_theta, n_y, n_x) of the pose cells; sonar_angles_rad: from straight ahead, left is positive."""
        if len(shape) != 3 or min(shape) < 1:
            raise ValueError(f"shape must be (n_theta, n_y, n_x), each at least 1 cell, got {shape!r}")
        self.cell_m = _positive("cell_m", cell_m)
        self._angles = _angles(sonar_angles_rad)
        self._log_odds = np.zeros(shape[1:], np.float32)

    @property
    def log_odds(self) -> Singles:
        """log p / (1 - p), shape (n_y, n_x), within +-BOUND; 0 where nothing is known. A view."""
        return self._log_odds

    @property
    def probability(self) -> Singles:
        """That something stands in a cell, shape (n_y, n_x); 0.5 where nothing is known. A copy."""
        return _probability(self._log_odds)

    def require(self, ranges_m: NDArray[np.floating]) -> Floats:
        """The scan as numbers of double precision; ValueError when it cannot be one."""
        return _ranges(ranges_m, self._angles)

    def update(self, packet: Packet, ranges_m: NDArray[np.floating]) -> None:
        """One scan, shape (n_sonars,), m from the robot's middle, taken at the packet's place. No echo: FARTHEST_M or more."""
        ranges = _ranges(ranges_m, self._angles)
        x, y = require_finite("packet.x", packet.x), require_finite("packet.y", packet.y)
        heading = require_finite("packet.heading_rad", packet.heading_rad)
        _scan(self._log_odds, x, y, heading, self._angles, ranges, self.cell_m)


@dataclass(frozen=True, slots=True, eq=False)
class MetricPicture:
    """Occupancy in the frame of the experience map."""

    probability: Singles  # shape (n_y, n_x), 0.5 where nothing is known
    origin_xy_m: tuple[float, float]  # the middle of cell [0, 0]
    cell_m: float


@kind("map grid/2")
class MapGrid:
    """[ours] The picture that bends with the experience map. Each scan is kept in the frame of the experience that was
    active, and drawn where that experience is now. test_occupancy_grid.py::test_the_picture_bends_with_the_map.
    """

    def __init__(self, sonar_angles_rad: Sequence[float] | Floats) -> None:
        self._angles = _angles(sonar_angles_rad)
        self._scans = np.zeros((256, KEPT, 3 + self._angles.size), np.float32)  # x, y, heading, ranges
        self._count = np.zeros(256, np.int64)  # scans ever kept of each experience; the newest is at (count - 1) % kept
        self._known = 0  # 1 + the last experience with a scan

    def __len__(self) -> int:
        """How many scans are kept."""
        return int(np.minimum(self._count, KEPT).sum())

    @property
    def memory_bytes(self) -> int:
        return self._scans.nbytes + self._count.nbytes

    def add(self, experience: int, local: Pose2, ranges_m: NDArray[np.floating]) -> None:
        """Keep one scan. local: the robot in the frame of this experience (`ExperienceMap.local_pose`)."""
        if experience < 0:
            raise ValueError(f"experience must be 0 or more, got {experience!r}")
        ranges = _ranges(ranges_m, self._angles)
        x, y = require_finite("local.x", local.x), require_finite("local.y", local.y)
        heading = require_finite("local.heading_rad", local.heading_rad)
        while experience >= len(self._count):
            self._scans, self._count = grown(self._scans), grown(self._count)
        count = int(self._count[experience])
        newest = self._scans[experience, (count - 1) % KEPT]
        moved = math.hypot(x - newest[0], y - newest[1]) > SAME_M
        if count == 0 or moved or abs(wrap_angle(heading - newest[2])) > SAME_RAD:
            newest = self._scans[experience, count % KEPT]
            self._count[experience] += 1
        newest[:3] = x, y, heading
        newest[3:] = ranges
        self._known = max(self._known, experience + 1)

    def draw(self, poses: Floats, cell_m: float = 0.25) -> MetricPicture:
        """Draw all kept scans at these poses of the experiences, shape (n, 3): x, y (m), heading (rad). Not called every step.

        The picture reaches as far as the beams do. A map too large for MOST_CELLS a side is drawn with larger cells.
        """
        if poses.ndim != 2 or poses.shape[1] != 3 or len(poses) < self._known:
            raise ValueError(f"poses must have shape (n, 3) with n at least {self._known}, got {poses.shape}")
        if not np.isfinite(poses[: self._known]).all():
            raise ValueError("poses must be finite numbers; at least one is not")
        cell_m = _positive("cell_m", cell_m)
        count = np.minimum(self._count[: self._known], KEPT)
        scans = self._scans[: self._known][np.arange(KEPT) < count[:, None]]
        at = np.repeat(np.asarray(poses[: self._known], np.float64), count, axis=0)
        if len(at) == 0:
            return MetricPicture(np.full((1, 1), 0.5, np.float32), (0.0, 0.0), cell_m)
        c, s = np.cos(at[:, 2]), np.sin(at[:, 2])
        x, y = at[:, 0] + c * scans[:, 0] - s * scans[:, 1], at[:, 1] + s * scans[:, 0] + c * scans[:, 1]
        ranges = scans[:, 3:].astype(np.float64)
        reach = min(float(ranges.max()), FARTHEST_M) + DEPTH_M
        size = max(float(np.ptp(x)), float(np.ptp(y))) + 2 * reach
        while size / cell_m + 5 > MOST_CELLS:
            cell_m *= 2
        left, low = (math.floor((float(v.min()) - reach) / cell_m) - 1 for v in (x, y))
        right, high = (math.ceil((float(v.max()) + reach) / cell_m) + 1 for v in (x, y))
        log_odds = np.zeros((high - low + 1, right - left + 1), np.float32)
        x, y = x / cell_m - left, y / cell_m - low
        _scans(log_odds, x, y, at[:, 2] + scans[:, 2], self._angles, ranges, cell_m)
        return MetricPicture(_probability(log_odds), (left * cell_m, low * cell_m), cell_m)


def _probability(log_odds: Singles) -> Singles:
    return (1 / (1 + np.exp(-log_odds))).astype(np.float32)


def _positive(name: str, value: float) -> float:
    if not (math.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be a positive number of metres, got {value!r}")
    return float(value)


def _angles(sonar_angles_rad: Sequence[float] | Floats) -> Floats:
    angles = np.array(sonar_angles_rad, np.float64)
    if angles.ndim != 1 or angles.size == 0 or not np.isfinite(angles).all():
        raise ValueError(f"sonar_angles_rad must be a row of at least one finite angle, got {sonar_angles_rad!r}")
    return angles


def _ranges(ranges_m: NDArray[np.floating], angles: Floats) -> Floats:
    ranges = np.asarray(ranges_m, np.float64)
    if ranges.shape != angles.shape:
        raise ValueError(f"ranges_m must have shape {angles.shape}, one for each sonar, got {ranges.shape}")
    if not _none_negative(ranges):
        raise ValueError(f"ranges_m must be 0 m or more, got {ranges.tolist()}")
    return ranges


@njit(cache=True, nogil=True)
def _none_negative(ranges: Floats) -> bool:
    bad = 0
    for r in ranges:
        bad += not r >= 0.0  # so that nan is bad, too
    return bad == 0


@njit(cache=True, nogil=True)
def _scans(
    log_odds: Singles, x: Floats, y: Floats, heading: Floats, angles: Floats, ranges: Floats, cell_m: float
) -> None:
    for k in range(len(x)):
        _scan(log_odds, x[k], y[k], heading[k], angles, ranges[k], cell_m)


@njit(cache=True, nogil=True)
def _scan(log_odds: Singles, x: float, y: float, heading: float, angles: Floats, ranges: Floats, cell_m: float) -> None:
    """l <- clip(l + log p / (1 - p)) for one beam after the other, on a grid that wraps. x, y in cells, the rest SI.

    p = (1 - FREE E) / 2 before the echo at R, E = (1 - (d / (R - eps))^2) (1 - (theta / w)^2)
    p = (1 + OCCUPIED O) / 2 around it,       O = (1 - ((d - R) / eps)^2) (1 - (theta / w)^2)
    d, theta: distance and angle of a cell's middle from the sonar's axis. After Moravec and Elfes 1985.

    [ours] eps and w, half the beam's width, are widened by half a cell as seen from the robot. Near the robot, where
    the beam is narrower than a cell, it is then not lost between two cells.
    test_occupancy_grid.py::test_a_beam_is_never_lost_between_cells.
    """
    n_y, n_x = log_odds.shape
    half = 0.5 * cell_m
    sine = np.sin(HALF_BEAM_RAD)
    eps = DEPTH_M + half
    for k in range(angles.size):
        echo = ranges[k] < FARTHEST_M
        R = min(ranges[k], FARTHEST_M)
        near = max(R - eps, 0.0)  # the floor before it is free
        far = R + eps if echo else near
        c, s = np.cos(heading + angles[k]), np.sin(heading + angles[k])
        wide = far * sine + half
        x_low = int(np.ceil(x + (min(0.0, far * c) - wide) / cell_m))
        x_high = int(np.floor(x + (max(0.0, far * c) + wide) / cell_m))
        y_low = int(np.ceil(y + (min(0.0, far * s) - wide) / cell_m))
        y_high = int(np.floor(y + (max(0.0, far * s) + wide) / cell_m))
        for at_y in range(y_low, y_high + 1):
            dy = (at_y - y) * cell_m
            first, last = x_low, x_high
            if abs(s) > 0.01:  # only that part of the row where the beam crosses it
                middle, aside = x + c * dy / s / cell_m, wide / abs(s) / cell_m
                first, last = max(first, int(np.ceil(middle - aside))), min(last, int(np.floor(middle + aside)))
            for at_x in range(first, last + 1):
                dx = (at_x - x) * cell_m
                d = np.sqrt(dx * dx + dy * dy)
                across = c * dy - s * dx
                if d >= far or abs(across) > d * sine + half:  # the second test spares most cells the angle below
                    continue
                w = HALF_BEAM_RAD + (np.arcsin(half / d) if d > half else 0.5 * np.pi)
                off = np.arctan2(across, c * dx + s * dy) / w if d > 0.0 else 0.0
                if abs(off) >= 1.0:
                    continue
                sure = 1.0 - off * off
                if d < near:
                    sure *= -FREE * (1.0 - (d / near) ** 2)
                else:
                    sure *= OCCUPIED * (1.0 - ((d - R) / eps) ** 2)
                row, column = at_y % n_y, at_x % n_x
                odds = log_odds[row, column] + np.log((1.0 + sure) / (1.0 - sure))
                log_odds[row, column] = min(max(odds, -BOUND), BOUND)
