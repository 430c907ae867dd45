"""[ours] What the robot remembers of the ground it drove on: when it was last at each experience, and how far its
sonars saw from there. Where they saw open floor that it never drove on, the map is thin.

test_known_ground.py::{test_open_floor_that_was_never_driven_on_is_an_opening, test_what_was_driven_on_is_no_opening,
test_what_it_sees_ahead_look_after_look_is_an_opening, test_a_way_that_led_nowhere_counts_for_what_lies_near,
test_what_lies_on_another_submap_hides_no_opening}.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from app.pilot.tried import Tried
from disk import kind
from ratslam_core import ExperienceMap
from ratslam_core.types import grown

OLD_AFTER_S = 60.0  # an experience is old ground when it was made so long ago
PLACE_REACH_M = 1.5  # a visit to a place counts for all experiences this near
OPENING_M = 2.0  # sonars that see as far as this see open floor ...
OPENING_GAP_M, OPENING_MOST_M = 0.7, 2.5  # ... whose place is so much before the echo, and at most so far away
LOOKS = 3  # in a row must have seen it: a single echo may be false
MISSED_M = 4.0  # where a trip did not get to a place, it would not get to others this near
AGAIN_S = 120.0  # an opening that was tried is tried again after this time
THIN_M = 0.8  # the map is thin where no experience is about this near
UNSEEN_M2 = 5.0  # so much new ground is expected behind each opening, beside what is seen of it
BEYOND_M = (1.7, 3.3, 4.1)  # so far along a beam it is looked whether that ground is new, too ...
ABOUT = 2  # ... which counts for places within so many times THIN_M

_Array = NDArray[np.float64]
_Cells = NDArray[np.int64]


@kind("known ground/7")
class KnownGround:
    """Rows belong to the experiences, by number."""

    def __init__(self, sonar_angles_rad: _Array) -> None:
        """sonar_angles_rad: (8,), positive to the left."""
        self._angles = np.array(sonar_angles_rad, np.float64)
        self.count = 0
        self._last_s = np.zeros(0)  # when the robot was last there
        self._made_s = np.zeros(0)
        self._seen_m = np.zeros((0, len(self._angles)), np.float32)  # sonar ranges where the experience was made
        self._latest = np.zeros((LOOKS, len(self._angles)), np.float32)  # sonar ranges, the newest last
        self.tried = Tried(THIN_M, AGAIN_S)  # openings that it drove into
        self.missed = Tried(MISSED_M, AGAIN_S)  # experiences that trips to openings did not get to
        self.now_s = self.new_m = 0.0  # time; distance driven since the robot was last on old ground

    @property
    def last_s(self) -> _Array:
        return self._last_s[: self.count]

    @property
    def made_s(self) -> _Array:
        return self._made_s[: self.count]

    def step(self, experiences: ExperienceMap, ranges_m: NDArray[np.float32], way_m: float, dt: float) -> None:
        """The robot drove `way_m` and is at the active experience."""
        self.now_s += dt
        self.new_m += way_m
        self._latest[:-1], self._latest[-1] = self._latest[1:], ranges_m
        if len(experiences) == 0:
            return
        if len(experiences) < self.count:  # another map
            self.count = 0
        new = len(experiences) - self.count
        if new > 0:
            self._grow(len(experiences))
            rows = slice(self.count, len(experiences))
            self._made_s[rows] = self._last_s[rows] = self.now_s
            self._seen_m[rows] = 0.0
            self._seen_m[experiences.active] = self._latest.min(axis=0)
            self.count = len(experiences)
        elif self.now_s - self._made_s[experiences.active] > OLD_AFTER_S:
            self.new_m = 0.0
        self._last_s[experiences.active] = self.now_s

    def _grow(self, count: int) -> None:
        """Room for twice as many experiences, when there are more than rows."""
        if count <= len(self._last_s):
            return
        for name in ("_last_s", "_made_s", "_seen_m"):
            setattr(self, name, grown(getattr(self, name), 2 * count))

    def been_at(self, x: float, y: float, poses: _Array) -> None:
        """The robot was at this place of the map, whichever way it faced."""
        near = np.hypot(poses[: self.count, 0] - x, poses[: self.count, 1] - y) < PLACE_REACH_M
        self.last_s[near] = self.now_s

    def openings(self, experiences: ExperienceMap) -> tuple[_Cells, _Array, NDArray[np.floating[Any]]]:
        """Experiences (k,), the places (k, 2), m, map frame, that were seen from there and never driven on, and how much
        new ground is expected about each, (k,), m².

        Only what lies on the robot's own submap counts: where the others lie to it is unknown.
        """
        submaps = experiences.submap_of[: self.count]
        own = submaps == submaps[experiences.active]
        rows, begin, heading, free_m = self._beams(experiences, own)
        known = np.concatenate(
            [experiences.poses[: self.count][own, :2], self.tried.left_alone(experiences, self.now_s)]
        )
        seen = _seen(begin, np.column_stack([np.cos(heading), np.sin(heading)]), free_m)
        cells, size = _cells(np.concatenate([seen.reshape(-1, 2), known]))
        about = _new_cells(cells[: -len(known)].reshape(seen.shape), cells[-len(known) :], size)
        new = (about > 0) & ~self.missed.near(experiences, begin[:, :2], self.now_s)
        return rows[new], seen[new, 0], THIN_M**2 * about[new] + UNSEEN_M2

    def _beams(
        self, experiences: ExperienceMap, own: NDArray[np.bool_]
    ) -> tuple[NDArray[np.int64], _Array, _Array, _Array]:
        """The beams that see open floor, from the experiences and from where the robot is: from which experience, (k,), and
        pose, (k, 3), m and rad; where to (rad) and how far (m). Map frame."""
        rows, beams = np.nonzero((self._seen_m[: self.count] >= OPENING_M) & own[:, None])
        now_m, robot = self._latest.min(axis=0), experiences.robot
        now = np.flatnonzero(now_m >= OPENING_M)
        here = np.broadcast_to((robot.x, robot.y, robot.heading_rad), (len(now), 3))
        seen_m = np.concatenate([self._seen_m[rows, beams], now_m[now]]).astype(np.float64)
        begin = np.concatenate([experiences.poses[rows], here])
        return (
            np.concatenate([rows, np.full(len(now), experiences.active)]).astype(np.int64),
            begin,
            begin[:, 2] + self._angles[np.concatenate([beams, now])],
            seen_m - OPENING_GAP_M,
        )


@njit(cache=True, nogil=True)
def _seen(begin: _Array, along: _Array, free_m: _Array) -> _Array:
    """Floor that each of k beams sees, (k, 1 + len(BEYOND_M), 2), m: first the place of the opening, then what lies BEYOND_M
    along it, or that place again where the beam ends before. begin: (k, 3); along, its direction: (k, 2)."""
    seen = np.empty((len(begin), 1 + len(BEYOND_M), 2))
    for k in range(len(begin)):
        opening_m = min(free_m[k], OPENING_MOST_M)
        for b in range(1 + len(BEYOND_M)):
            m = opening_m if b == 0 or BEYOND_M[b - 1] > free_m[k] else BEYOND_M[b - 1]
            for a in range(2):
                seen[k, b, a] = begin[k, a] + m * along[k, a]
    return seen


@njit(cache=True, nogil=True)
def _cells(points: _Array) -> tuple[_Cells, tuple[int, int]]:
    """The cells of THIN_M in which points, (n, 2) m, lie, on a grid that reaches past all of them, and its size."""
    low, high = points[0].copy(), points[0].copy()
    for p in points:
        for a in range(2):
            low[a], high[a] = min(low[a], p[a]), max(high[a], p[a])
    low -= (ABOUT + 1) * THIN_M
    cells = np.empty(points.shape, np.int64)
    for k in range(len(points)):
        for a in range(2):
            cells[k, a] = math.floor((points[k, a] - low[a]) / THIN_M)
    width, depth = np.ceil((high - low) / THIN_M) + ABOUT + 1
    return cells, (int(width), int(depth))


@njit(cache=True, nogil=True)
def _new_cells(seen: _Cells, known: _Cells, size: tuple[int, int]) -> _Cells:
    """For each of k beams that saw these cells of a grid, (k, m, 2): 0 where the first of them is a known one, (n, 2), or
    beside one; else how many new ones were seen within `ABOUT` cells of it, (k,)."""
    new, about = np.zeros(size, np.bool_), np.zeros(len(seen), np.int64)
    for k in range(len(seen)):
        for b in range(seen.shape[1]):
            new[seen[k, b, 0], seen[k, b, 1]] = True
    for k in range(len(known)):
        for x in range(known[k, 0] - 1, known[k, 0] + 2):
            for y in range(known[k, 1] - 1, known[k, 1] + 2):
                new[x, y] = False
    for k in range(len(seen)):
        at_x, at_y = seen[k, 0]
        if new[at_x, at_y]:
            for x in range(at_x - ABOUT, at_x + ABOUT + 1):
                for y in range(at_y - ABOUT, at_y + ABOUT + 1):
                    about[k] += new[x, y]
    return about
