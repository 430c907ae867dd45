"""[ours] Scan matching: the sonars measure where the robot is to a place that it recognises.

A view is much the same a metre farther on or aside, the more so the larger the room, and only the pose cells say where
in its zone the robot is. Walls say it to a decimetre: the echoes of the last metres, moved along by odometry, are laid over
those that were heard where the experience was made and around it, near where the observation puts the robot. What little walls
say of a direction, as along a bare corridor, the observation decides. Where the echoes agree nowhere near, it is not that place
(`parts.GeometricVerification`). In the middle of a hall, where few are heard, an observation is worth little: there views are
alike for metres. test_scan_matching.py::{test_echoes_say_where_in_a_room_the_robot_is,
test_along_a_corridor_the_observation_decides, test_another_room_is_not_confirmed, test_an_observation_in_a_hall_is_worth_little}.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.occupancy_grid import FARTHEST_M
from ratslam_core.parts import Matched
from ratslam_core.pose_graph.transitions import moved_by
from ratslam_core.types import IDENTITY, Flags, Floats, Ints32, Odometry, Pose2, Singles, grown, wrap_angle

RECENT = 60  # scans of the way here that are kept ...
STEP_M, STEP_RAD = 0.1, 0.3  # ... one for each way, or turn, of so much
BESIDE = 12  # experiences made before and after, with which a place is heard
AROUND_M = 2.5  # scans from farther away tell nothing of a place
LEAST_POINTS = 20  # with fewer echoes nothing can be said
SEARCH_M, SEARCH = 0.2, 5  # the observation may be off by so many steps to each side
FINER_M = (0.1, 0.05)  # and then more exactly
FINER_RAD = 0.5  # rad/m: turns are tried in steps of this times those
MOST_FINER = 3  # steps of each
CELL_M, ACROSS = 0.1, 152  # a picture of how far it is to the nearest old echo
NEAR = 4  # cells; an echo farther than this from any old one counts as this far
OFF_COST, TURN_COST = 0.12, 0.2  # m per m², and per rad², off the observation
ASIDE_M, DIRECTIONS = 0.4, 16  # a pose so far aside fits worse, in whichever direction ...
LEAST_RISE_M = 0.015  # ... but where it does by less than this, walls say nothing of that direction
SIGMA_M2 = 0.004  # m²: how far off a match may be, times by how much a pose aside fits worse
ALONG_M = 0.5  # how far off it may be along such a direction
UNHEARD_M = 1.0  # how far off an observation may be where nothing is heard
AGREES_M = 0.25  # mean distance between echoes above which this is another place


class Map(Protocol):
    """What has to be known of an experience map."""

    @property
    def poses(self) -> Floats: ...
    @property
    def submap_of(self) -> Ints32: ...
    def __len__(self) -> int: ...


@kind("scan matching/2")
class ScanMatching:
    """Keeps the scan of each experience, and those of the way here."""

    def __init__(self, sonar_angles_rad: Sequence[float] | Floats) -> None:
        self._angles = np.asarray(sonar_angles_rad, np.float64)
        n = len(self._angles)
        self._scans = np.zeros((256, n), np.float32)  # of each experience; 0 where there was none
        self._since = np.zeros(256, np.int64)  # the count of recent scans when it was made
        self._recent = np.zeros((RECENT, n))  # scans of the way here
        self._from = np.zeros((RECENT, 3))  # x, y, heading by odometry, where each was made
        self._count = self._begun = 0  # of recent scans ever, and when it was carried away
        self._at = IDENTITY  # by odometry
        self._scan: Floats | None = None  # the newest

    def sense(self, scan: Floats | None, moved: Odometry, beats: int) -> None:
        """The robot moved so in each of the beats, and then heard this, m from its middle."""
        for _ in range(beats):
            self._at = self._at.compose(moved_by(moved))
        self._scan, at = scan, self._at
        if scan is None:
            return
        x, y, heading = self._from[(self._count - 1) % RECENT].tolist()
        turned = abs(wrap_angle(at.heading_rad - heading))
        if self._count == self._begun or math.hypot(at.x - x, at.y - y) > STEP_M or turned > STEP_RAD:
            self._from[self._count % RECENT] = at.x, at.y, at.heading_rad
            self._recent[self._count % RECENT] = scan
            self._count += 1

    def forget(self) -> None:
        """The robot was carried away."""
        self._begun = self._count

    def made(self, experience: int) -> None:
        """An experience was just made here."""
        while experience >= len(self._scans):
            self._scans, self._since = grown(self._scans), grown(self._since)
        self._scans[experience] = 0.0 if self._scan is None else self._scan
        self._since[experience] = self._count

    def verified(self, map_: Map, experience: int, observation: Pose2) -> tuple[Pose2, float] | None:
        """The robot in the frame of an experience, and give or take what (m); None: echoes say that this is not there."""
        found = self.match(map_, experience, observation)
        if found is None:
            return observation, UNHEARD_M if self._in_a_hall(map_, experience) else math.inf
        return None if found.apart_m > AGREES_M else (found.pose, found.sigma_m)

    def match(self, map_: Map, experience: int, observation: Pose2) -> Matched | None:
        """The robot in the frame of an experience, as echoes have it near an observation; None where too few are heard."""
        new, old = self._on_the_way(), self._around(map_, experience)
        points = min(len(new), len(old))
        if points < LEAST_POINTS:
            return None
        told = observation.x, observation.y, observation.heading_rad
        x, y, heading, apart, rise, along = _matched(_picture(old), new, *told)
        if rise >= LEAST_RISE_M:
            return Matched(Pose2(x, y, wrap_angle(heading)), SIGMA_M2 / rise, apart, points)
        c, s = math.cos(along), math.sin(along)
        back = c * (observation.x - x) + s * (observation.y - y)
        return Matched(Pose2(x + back * c, y + back * s, wrap_angle(heading)), ALONG_M, apart, points)

    @property
    def count(self) -> int:
        """How many scans of its way it has kept so far, one for each step."""
        return self._count

    def before(self, experiences: int) -> Flags:
        """Which of the first so many experiences were made before all scans of the way here."""
        return self._since[:experiences] <= self._oldest

    @property
    def _oldest(self) -> int:
        """The oldest of the recent scans."""
        return max(self._begun, self._count - RECENT)

    def _on_the_way(self) -> Floats:
        """Echoes of the last metres, in the robot's frame."""
        recent = np.arange(self._oldest, self._count) % RECENT
        at = np.array([self._at.x, self._at.y, self._at.heading_rad])
        return _echoes(self._from[recent], self._recent[recent], at, self._angles)

    def _in_a_hall(self, map_: Map, experience: int) -> bool:
        """Whether it has listened, and few echoes were heard on the way here, or there."""
        there = self._around(map_, experience, again=True)
        return self._count > self._begun and min(len(self._on_the_way()), len(there)) < LEAST_POINTS

    def _around(self, map_: Map, experience: int, *, again: bool = False) -> Floats:
        """Echoes of an experience and those made just before and after it, in its frame; unless asked for again, none that
        was also heard on the way here, since that would agree with odometry whatever errors it has."""
        beside = slice(max(0, experience - BESIDE), min(len(map_), experience + BESIDE + 1))
        own = (map_.submap_of[beside] == map_.submap_of[experience]) & (self.before(len(map_))[beside] | again)
        poses, scans = map_.poses[beside][own], self._scans[beside][own].astype(np.float64)
        return _echoes(poses, scans, map_.poses[experience].copy(), self._angles)


@njit(cache=True, nogil=True)
def _echoes(poses: Floats, scans: Floats, at: Floats, angles: Floats) -> Floats:
    """Where echoes were heard, (k, 2) m, in the frame of the pose `at` (x, y, heading), from poses around it."""
    points = np.empty((scans.size, 2))
    k, c, s = 0, math.cos(at[2]), math.sin(at[2])
    for i in range(len(poses)):
        dx, dy = poses[i, 0] - at[0], poses[i, 1] - at[1]
        if dx * dx + dy * dy > AROUND_M * AROUND_M:
            continue
        x, y, turn = c * dx + s * dy, -s * dx + c * dy, poses[i, 2] - at[2]
        for beam in range(len(angles)):
            if 0 < scans[i, beam] < FARTHEST_M:
                points[k, 0] = x + scans[i, beam] * math.cos(turn + angles[beam])
                points[k, 1] = y + scans[i, beam] * math.sin(turn + angles[beam])
                k += 1
    return points[:k]


@njit(cache=True, nogil=True)
def _picture(points: Floats) -> Singles:
    """How far it is from each cell to the nearest point, m, and no farther than NEAR cells."""
    picture = np.full((ACROSS, ACROSS), np.float32(NEAR * CELL_M))
    for k in range(len(points)):
        x, y = points[k, 0] / CELL_M + ACROSS / 2, points[k, 1] / CELL_M + ACROSS / 2
        column, row = math.floor(x), math.floor(y)
        for r in range(max(0, row - NEAR), min(ACROSS, row + NEAR + 1)):
            for q in range(max(0, column - NEAR), min(ACROSS, column + NEAR + 1)):
                away = CELL_M * math.hypot(q + 0.5 - x, r + 0.5 - y)
                if away < picture[r, q]:
                    picture[r, q] = away
    return picture


@njit(cache=True, nogil=True)
def _apart(picture: Singles, points: Floats, every: int, x: float, y: float, heading: float) -> float:
    """Mean distance of every so-manieth point, seen from this pose, to the nearest of the picture."""
    c, s, total, n = math.cos(heading), math.sin(heading), 0.0, 0
    for k in range(0, len(points), every):
        column = math.floor((x + c * points[k, 0] - s * points[k, 1]) / CELL_M + ACROSS / 2)
        row = math.floor((y + s * points[k, 0] + c * points[k, 1]) / CELL_M + ACROSS / 2)
        inside = 0 <= column < ACROSS and 0 <= row < ACROSS
        total += float(picture[row, column]) if inside else NEAR * CELL_M
        n += 1
    return float(total / n)


@njit(cache=True, nogil=True)
def _matched(
    picture: Singles, points: Floats, x0: float, y0: float, heading0: float
) -> tuple[float, float, float, float, float, float]:
    """The pose near (x0, y0, heading0) from which the points lie best on those of the picture; how far apart they then
    are, by how much farther at least aside of it, and in which direction (rad) that is."""
    x, y, heading = _laid(picture, points, x0, y0, heading0)
    apart = _apart(picture, points, 1, x, y, heading)
    aside, along = _least_aside(picture, points, x, y, heading)
    return x, y, heading, apart, aside - apart, along


@njit(cache=True, nogil=True)
def _laid(picture: Singles, points: Floats, x0: float, y0: float, heading0: float) -> tuple[float, float, float]:
    """First in coarse steps with every other point, then in finer ones with all."""
    x, y, heading, least = x0, y0, heading0, np.inf
    for i in range(-SEARCH, SEARCH + 1):
        for j in range(-SEARCH, SEARCH + 1):
            dx, dy = SEARCH_M * i, SEARCH_M * j
            cost = _apart(picture, points, 2, x0 + dx, y0 + dy, heading0) + OFF_COST * (dx * dx + dy * dy)
            if cost < least:
                least, x, y = cost, x0 + dx, y0 + dy
    least = np.inf
    for step in FINER_M:
        for _ in range(MOST_FINER):
            at_x, at_y, at_heading, before = x, y, heading, least
            for i in range(-1, 2):
                for j in range(-1, 2):
                    for k in range(-1, 2):
                        px, py, ph = at_x + i * step, at_y + j * step, at_heading + k * step * FINER_RAD
                        cost = _apart(picture, points, 1, px, py, ph)
                        cost += OFF_COST * ((px - x0) ** 2 + (py - y0) ** 2) + TURN_COST * (ph - heading0) ** 2
                        if cost < least:
                            least, x, y, heading = cost, px, py, ph
            if least >= before:
                break
    return x, y, heading


@njit(cache=True, nogil=True)
def _least_aside(picture: Singles, points: Floats, x: float, y: float, heading: float) -> tuple[float, float]:
    """How far apart the points are at least once the pose is `ASIDE_M` off, and in which direction (rad) that is."""
    least, along = np.inf, 0.0
    for k in range(DIRECTIONS):
        angle = 2 * math.pi * k / DIRECTIONS
        apart = _apart(picture, points, 1, x + ASIDE_M * math.cos(angle), y + ASIDE_M * math.sin(angle), heading)
        if apart < least:
            least, along = apart, angle
    return least, along
