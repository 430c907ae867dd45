"""[ours] What the robot remembers of the ground it drove on: when it was last at each experience, and how far its
sonars saw from there. Where they saw open floor that it never drove on, the map is thin.

test_known_ground.py::{test_open_floor_that_was_never_driven_on_is_an_opening, test_what_was_driven_on_is_no_opening,
test_what_it_sees_ahead_look_after_look_is_an_opening, test_an_opening_is_tried_again_later,
test_what_lies_on_another_submap_hides_no_opening}.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core import ExperienceMap
from ratslam_core.types import grown

OLD_AFTER_S = 60.0  # an experience is old ground when it was made so long ago
PLACE_REACH_M = 1.5  # a visit to a place counts for all experiences this near
OPENING_M = 2.0  # sonars that see as far as this see open floor ...
OPENING_GAP_M, OPENING_MOST_M = 0.7, 2.5  # ... whose place is so much before the echo, and at most so far away
LOOKS = 3  # in a row must have seen it: a single echo may be false
OPENING_AGAIN_S = 120.0  # one that has been tried is tried again after this time, after twice as long the next time
THIN_M = 0.8  # the map is thin where no experience is about this near
UNSEEN_M2 = 5.0  # so much new ground is expected behind each opening, beside what is seen of it
BEYOND_M = (1.7, 3.3, 4.1)  # so far along a beam it is looked whether that ground is new, too ...
ABOUT = 2  # ... which counts for places within so many times THIN_M

_Array = NDArray[np.float64]


@kind("known ground/5")
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
        # Openings that have been tried: m, in an experience's frame; and until when they are left alone, s.
        self._done: list[tuple[int, float, float, float]] = []
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
        self._latest = np.concatenate([self._latest[1:], ranges_m[None]])
        if len(experiences) == 0:
            return
        if len(experiences) < self.count:  # another map
            self.count, self._done = 0, []
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

    def tried(self, experience: int, x: float, y: float, poses: _Array) -> None:
        """The robot tried to drive into an opening; m, in the frame of the experience.

        It may have been turned away by somebody who stood there, so it may try again, after twice as long each time.
        """
        here = placed([(experience, x, y)], poses)
        before = np.hypot(*(placed([done[:3] for done in self._done], poses) - here).T) < THIN_M
        self._done.append((experience, x, y, self.now_s + OPENING_AGAIN_S * 2.0 ** int(before.sum())))

    def openings(self, experiences: ExperienceMap) -> tuple[NDArray[np.int64], _Array, _Array]:
        """Experiences (k,), the places (k, 2), m, map frame, that were seen from there and never driven on, and how much
        new ground is expected about each, (k,), m².

        Only what lies on the robot's own submap counts: where the others lie to it is unknown.
        """
        submaps = experiences.submap_of[: self.count]
        own = submaps == submaps[experiences.active]
        rows, begin, bearing, free_m = self._beams(experiences, own)
        along = np.column_stack([np.minimum(free_m, OPENING_MOST_M), np.tile(BEYOND_M, (len(rows), 1))])
        k, at = np.nonzero(along <= free_m[:, None])
        heading = begin[:, 2] + bearing
        places = begin[k, :2] + along[k, at, None] * np.column_stack([np.cos(heading), np.sin(heading)])[k]
        done = [tried[:3] for tried in self._done if own[tried[0]] and tried[3] > self.now_s]
        known = np.concatenate([experiences.poses[: self.count][own, :2], placed(done, experiences.poses)])
        new, area = _new_ground(places, known)
        new &= at == 0
        return rows[k[new]], places[new], area[new] + UNSEEN_M2

    def _beams(
        self, experiences: ExperienceMap, own: NDArray[np.bool_]
    ) -> tuple[NDArray[np.int64], _Array, _Array, _Array]:
        """The beams that see open floor, from the experiences and from where the robot is: from which experience, (k,), and
        place, (k, 3); where to (rad, left positive) and how far (m)."""
        rows, beams = np.nonzero((self._seen_m[: self.count] >= OPENING_M) & own[:, None])
        now_m, robot = self._latest.min(axis=0), experiences.robot
        now = np.flatnonzero(now_m >= OPENING_M)
        here = np.tile((robot.x, robot.y, robot.heading_rad), (len(now), 1))
        seen_m = np.concatenate([self._seen_m[rows, beams], now_m[now]]).astype(np.float64)
        return (
            np.concatenate([rows, np.full(len(now), experiences.active)]).astype(np.int64),
            np.concatenate([experiences.poses[rows], here]),
            self._angles[np.concatenate([beams, now])],
            seen_m - OPENING_GAP_M,
        )


def placed(points: list[tuple[int, float, float]], poses: _Array) -> _Array:
    """The places (n, 2), m, map frame, of points in the frames of experiences."""
    if not points:
        return np.zeros((0, 2))
    rows = np.array(points)
    x, y, heading = poses[rows[:, 0].astype(np.int64)].T
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([x + c * rows[:, 1] - s * rows[:, 2], y + s * rows[:, 1] + c * rows[:, 2]], axis=1)


def _new_ground(places: _Array, known: _Array) -> tuple[NDArray[np.bool_], _Array]:
    """Which of the places (k, 2) lie farther than THIN_M (to twice that) from all known ones (n, 2), and how much of such
    ground, m², lies within `ABOUT` cells of each."""
    if not len(places):
        return np.zeros(0, np.bool_), np.zeros(0)
    both = np.concatenate([places, known])
    low = both.min(axis=0) - (ABOUT + 1) * THIN_M
    size = np.ceil((both.max(axis=0) - low) / THIN_M).astype(np.int64) + ABOUT + 1
    old, new = np.zeros(size, np.uint8), np.zeros(size, np.uint8)
    cells = np.floor((both - low) / THIN_M).astype(np.int64)
    mine, theirs = tuple(cells[: len(places)].T), tuple(cells[len(places) :].T)
    old[theirs] = new[mine] = 1
    new[cv2.dilate(old, np.ones((3, 3))) > 0] = 0
    area = THIN_M**2 * cv2.boxFilter(new, cv2.CV_64F, (2 * ABOUT + 1, 2 * ABOUT + 1), normalize=False)
    return new[mine] > 0, area[mine].astype(np.float64)
