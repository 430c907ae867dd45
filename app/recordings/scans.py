"""[ours] Scan matching: the odometry of wheels is made better by a laser, and places are told by it.

Wheels that slip turn a robot by degrees between two scans; a scan tells the turn to a fraction of one. What wheels say
is where to begin: each scan is laid over what was seen shortly before (`ScanOdometry`).

A laser measures, too, where the robot is to experiences near it in the map, by laying its scan over theirs (`ScanTies`).
A view says that a place is known; only the pose cells say where in it the robot is, to a cell, and many places look alike.
A scan says it to centimetres. So a new experience is tied to old ones, and a look counts only where the scans agree: it is
then as precise as they are. Each of the two scans must say the same when it is laid over the other. What a scan says
wrongly all the same, the exact correction gives up like any other closure.
test_scan_ties.py::{test_a_scan_ties_an_experience_to_an_old_one_where_it_belongs,test_a_false_loop_closure_is_found_out_by_its_scan}.
`ScanRules` has the plain twins. Points are in m, in the frame of the laser.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from app.recordings.recording import About
from disk import kind
from ratslam_core import ExperienceMap, Odometry, Pose2, wrap_angle, wrap_angles
from ratslam_core.parts import Matched


@kind("scan rules/1")
@dataclass(frozen=True, slots=True)
class ScanRules:
    """[ours] What a laser adds to the wheels, each with a switch: off is the plain twin.

    Compared by `python -m benchmarks.recordings --without NAME variants`.
    """

    local_map: bool = True  # a scan is laid over several before it; off: over the one before
    confirmed: bool = True  # an observation counts where scans agree; off: every one does, as the gate lets it
    mutual: bool = True  # laid either way, scans must say the same, and no place near fit as well; off: laid one way
    weighed: bool = True  # a match weighs less where walls tell little of a direction; off: all weigh the same
    neighbours: bool = True  # a match far from the pose estimate needs a second one; off: one is enough


IDENTITY = Pose2(0.0, 0.0, 0.0)
LEAST_BEAMS = 60  # fewer are sonars
FARTHEST_M = 20.0  # two beams side by side are too far apart beyond
KEY_M, KEY_RAD = 0.4, 0.3  # a scan so far from the last one that was kept is kept
MOST_KEPT, KEPT_M = 8, 2.0  # scans that are kept, and along how much way; from farther off, walls look otherwise


def is_laser(about: About) -> bool:
    """Whether its ranges are a laser's."""
    return len(about.beam_angles_rad) >= LEAST_BEAMS


@kind("scan odometry/2")
class ScanOdometry:
    """Lays each scan over a local map of some scans before it: then errors grow with the way, not with the number of
    scans. `ScanRules.local_map` off, over the last one alone, is the plain twin.
    test_recorded_motion.py::{test_a_laser_makes_wheels_better,test_errors_do_not_grow_with_the_rate_of_scans}.
    """

    def __init__(self, about: About, rules: ScanRules | None = None) -> None:
        self._rules = rules or ScanRules()
        self._angles = np.array(about.beam_angles_rad)
        self._limit_m = min(FARTHEST_M, about.range_limit_m or FARTHEST_M)
        self._at = IDENTITY  # the robot in the frame of the newest scan that was kept
        self._kept: list[tuple[Pose2, Walls]] = []  # in that frame, the newest last
        self._walls: Walls | None = None  # all of them

    def better(self, told: Odometry, ranges_m: NDArray[np.float64]) -> Odometry:
        """The movement that lays this scan over those before, near what the wheels told; that itself where none does."""
        way, turn = told.speed * told.dt, told.yaw_rate * told.dt
        if self._walls is not None and way == 0 and turn == 0:
            return told
        now = points_of(ranges_m, self._angles, self._limit_m)
        before = self._at
        self._at = before.compose(_along(way, turn))
        found = None if self._walls is None else self._walls.match(now, self._at)
        if found is not None:
            moved = before.inverse().compose(found.pose)
            turn = moved.heading_rad
            way = moved.x * math.cos(turn / 2) + moved.y * math.sin(turn / 2)
            self._at = before.compose(_along(way, turn))  # wheels do not slip sideways
        if self._walls is None or self._is_new():
            self._keep(Walls(now))
        return told if found is None else Odometry(way / told.dt, turn / told.dt, told.dt)

    def _is_new(self) -> bool:
        far = math.hypot(self._at.x, self._at.y) > KEY_M or abs(self._at.heading_rad) > KEY_RAD
        return far or not self._rules.local_map

    def _keep(self, walls: Walls) -> None:
        back = self._at.inverse()
        kept = [(back.compose(at), each) for at, each in self._kept]
        near = [(at, each) for at, each in kept if math.hypot(at.x, at.y) < KEPT_M]
        self._kept = [*near[1 - MOST_KEPT :], (IDENTITY, walls)] if self._rules.local_map else [(IDENTITY, walls)]
        self._walls = Walls.joined(self._kept)
        self._at = IDENTITY


def _along(way: float, turn: float) -> Pose2:
    return Pose2(way * math.cos(turn / 2), way * math.sin(turn / 2), turn)


STARTS_RAD = tuple(math.radians(d) for d in (0, -8, 8, -16, 16))  # added to the turn of the wheels
SPACING_M = 0.5  # between the places from which it begins
ROUNDS = 15
ROUGH_ROUNDS, SPARSE, MOST_STARTS = 6, 3, 8  # every third point first; then the best places that are not the same
LEAST_POINTS = 30
LEAST, WELL = 0.15, 0.85  # share of the points on walls: to be believed, and to try no other start
NEAR = 0.4  # m to begin with; points farther from every line say nothing, and this shrinks to a quarter
TRUST_M, TRUST_RAD = 0.5, 0.4  # from what the wheels say; a match beyond is none
SPLIT = 0.3  # share of the range by which two beams side by side may differ and still show one wall
SAME_M, SAME_RAD = 0.15, 0.05  # of two matches that say the same
DOUBT = (1e-2, 1e-2, 1e-3)  # a point: where all walls are parallel, a scan stays where the wheels put it

Points = NDArray[np.float64]  # (n, 2), m


class Match(NamedTuple):
    """Where a scan lies over another."""

    pose: Pose2
    fits: float  # share of its points on walls, less how far off they are
    rival: float  # `fits` of the best place elsewhere, if it was looked for
    holds: float  # 0 (a bare corridor) to 0.5: how much of the walls lies across the direction they tell least of


def alike(a: Pose2, b: Pose2, times: float = 1.0) -> bool:
    """Whether two matches say the same, or so many times the error of that."""
    near = math.hypot(a.x - b.x, a.y - b.y) < times * SAME_M
    return near and abs(wrap_angle(a.heading_rad - b.heading_rad)) < times * SAME_RAD


@kind("walls/1")
class Walls:
    """Points on walls, with the directions across them, over which scans are laid: point to line, as Censi 2008.

    test_recorded_motion.py::test_a_movement_in_a_room_is_found.
    """

    def __init__(self, points: Points, normals: Points | None = None) -> None:
        """points: a scan, beam by beam; or with their normals, any points."""
        if normals is None:
            points, normals = _normals_of(points)
        self.points, self.normals = points, normals
        low = points.min(axis=0, initial=0.0) - NEAR
        columns, rows = (int(n) + 3 for n in (points.max(axis=0, initial=0.0) - low) // NEAR)
        square = ((points - low) // NEAR).astype(np.int64)
        which = square[:, 1] * columns + square[:, 0]
        order = np.argsort(which, kind="stable")
        self._order, self._low, self._columns = order, low, columns
        self._first = np.searchsorted(which[order], np.arange(columns * rows + 1))  # of each square

    @staticmethod
    def joined(scans: Iterable[tuple[Pose2, Walls]]) -> Walls:
        """Several as one, each at its pose."""
        parts = [
            (walls.points @ _turning(at.heading_rad) + (at.x, at.y), walls.normals @ _turning(at.heading_rad))
            for at, walls in scans
        ]
        points, normals = (np.concatenate(column) for column in zip(*parts, strict=True))
        return Walls(points, normals)

    def match(self, now: Points, told: Pose2, least: float = LEAST, *, reach_m: float = 0.0) -> Match | None:
        """The pose of the scan `now` in the frame of this; None when no start near `told` fits well.

        reach_m: how far off `told` may be; then it begins in all places so near, and looks for a rival, too.
        """
        if len(self.points) < LEAST_POINTS or len(now) < LEAST_POINTS:
            return None
        settled: list[Match] = []
        for start in self._starts(now, told, reach_m):
            if reach_m > 0 or not settled or settled[-1].fits <= WELL:
                settled.append(self._settle(now, start))
        best = max(settled, key=lambda each: each.fits)
        if reach_m > 0:
            best = best._replace(rival=max((s.fits for s in settled if not alike(s.pose, best.pose, 2.0)), default=0.0))
        far = math.hypot(best.pose.x - told.x, best.pose.y - told.y) > TRUST_M + reach_m
        if best.fits < least or far or abs(wrap_angle(best.pose.heading_rad - told.heading_rad)) > TRUST_RAD:
            return None
        return best

    def _starts(self, now: Points, told: Pose2, reach_m: float) -> list[Pose2]:
        """Where to begin. Of many places, those to which a part of the points settles best in a few rounds."""
        starts = [
            Pose2(told.x + dx, told.y + dy, told.heading_rad + turn)
            for dx, dy in _around(reach_m)
            for turn in STARTS_RAD
        ]
        if reach_m == 0:
            return starts
        roughly = [self._settle(now[::SPARSE], start, ROUGH_ROUNDS) for start in starts]
        chosen: list[Pose2] = []
        for each in sorted(roughly, key=lambda each: -each.fits):
            if len(chosen) < MOST_STARTS and not any(alike(each.pose, other, 2.0) for other in chosen):
                chosen.append(each.pose)
        return chosen

    def _settle(self, now: Points, start: Pose2, rounds: int = ROUNDS) -> Match:
        fits, holds, x, y, heading = _settle(
            self.points, self.normals, self._order, self._first, self._columns, self._low, now, start.x, start.y,
            start.heading_rad, rounds,
        )  # fmt: skip
        return Match(Pose2(x, y, wrap_angle(heading)), fits, 0.0, holds)


def points_of(ranges_m: NDArray[np.float64], angles_rad: NDArray[np.float64], limit_m: float) -> Points:
    """Where the beams end, in the frame of the laser; those that end nowhere are left out."""
    ends = np.isfinite(ranges_m) & (ranges_m > 0) & (ranges_m < limit_m)
    r, a = ranges_m[ends], angles_rad[ends]
    return np.stack([r * np.cos(a), r * np.sin(a)], axis=1)


def _normals_of(points: Points) -> tuple[Points, Points]:
    """Points with the direction across the wall that they and their neighbours lie on, (n, 2) each."""
    if len(points) < 3:
        return points[:0], points[:0]
    gap = SPLIT * np.hypot(points[:, 0], points[:, 1]) + 0.05
    step = np.hypot(*np.diff(points, axis=0).T)
    k = 1 + np.flatnonzero((step[:-1] < gap[1:-1]) & (step[1:] < gap[1:-1]))
    along = points[k + 1] - points[k - 1]
    along = along / np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)[:, None]
    return points[k], np.stack([-along[:, 1], along[:, 0]], axis=1)


def _around(reach_m: float) -> list[tuple[float, float]]:
    n = math.ceil(reach_m / SPACING_M)
    return [(SPACING_M * i, SPACING_M * j) for i in range(-n, n + 1) for j in range(-n, n + 1)]


def _turning(angle: float) -> NDArray[np.float64]:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s], [-s, c]])


@njit(cache=True, nogil=True, error_model="numpy")
def _settle(
    points: Points, normals: Points, order: NDArray[np.int64], first: NDArray[np.int64], columns: int, low: NDArray[np.float64],
    now: Points, x: float, y: float, heading: float, rounds: int,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """From one start to where it settles: fits and holds (`Match`), x, y, heading. order, first: the points by squares."""
    rows = (len(first) - 1) // columns
    fits = holds = 0.0
    for k in range(rounds):
        near = NEAR * (1 - 0.75 * k / (ROUNDS - 1))
        c, s = math.cos(heading), math.sin(heading)
        h, g = np.zeros((3, 3)), np.zeros(3)
        on, off = 0, 0.0
        for i in range(len(now)):
            px, py = c * now[i, 0] - s * now[i, 1], s * now[i, 0] + c * now[i, 1]
            qx, qy = px + x, py + y
            column, row = math.floor((qx - low[0]) / NEAR), math.floor((qy - low[1]) / NEAR)
            closest, which = near * near, -1
            for r in range(max(row - 1, 0), min(row + 2, rows)):
                for square in range(r * columns + max(column - 1, 0), r * columns + min(column + 2, columns)):
                    for at in range(first[square], first[square + 1]):
                        j = order[at]
                        away = (points[j, 0] - qx) ** 2 + (points[j, 1] - qy) ** 2
                        if away < closest:
                            closest, which = away, j
            if which < 0:
                continue
            n0, n1 = normals[which, 0], normals[which, 1]
            error = (qx - points[which, 0]) * n0 + (qy - points[which, 1]) * n1
            a = (n0, n1, n1 * px - n0 * py)
            for u in range(3):
                g[u] -= a[u] * error
                for v in range(3):
                    h[u, v] += a[u] * a[v]
            on += 1
            off += abs(error)
        if on < min(LEAST_POINTS // 2, len(now) / 4):
            return 0.0, 0.0, x, y, heading
        apart = math.hypot((h[0, 0] - h[1, 1]) / 2, h[0, 1])
        holds = ((h[0, 0] + h[1, 1]) / 2 - apart) / on
        fits = on / len(now) - off / on / near / 4
        for u in range(3):
            h[u, u] += DOUBT[u] * on
        step = np.linalg.solve(h, g)
        x, y, heading = x + step[0], y + step[1], heading + step[2]
    return fits, holds, x, y, heading


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
        """The newest scan."""
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

    def verified(self, map_: ExperienceMap, experience: int, observation: Pose2) -> tuple[Pose2, float] | None:
        """Where the robot is in the frame of an experience, and give or take what (m); None if the scans do not agree.

        observation: what the view and the pose cells say.
        """
        if not self._rules.confirmed or self._now is None or experience not in self._scans:
            return observation, math.inf
        believed = map_.pose(experience).inverse().compose(map_.robot_here)
        found = self._laid(map_, experience, believed, LEAST_OFF_M)
        return found or self._laid(map_, experience, observation, LEAST_OFF_M)

    def match(self, _map: ExperienceMap, _experience: int, _observation: Pose2) -> Matched | None:
        """A laser's scan is matched or not; how much that says for a place was not measured."""
        return None

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
        """Whether that is near the pose estimate, or else the scans made next to the old one say the same."""
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
        turned = np.abs(wrap_angles(poses[:, 2] - here.heading_rad))
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
