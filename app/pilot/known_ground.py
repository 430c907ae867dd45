"""[ours] What the robot remembers of the ground it drove on: when it was last at each experience, and how far its
sonars saw from there. Where they saw open floor that it never drove on, the map is thin.

test_known_ground.py::{test_open_floor_that_was_never_driven_on_is_an_opening, test_what_was_driven_on_is_no_opening,
test_an_opening_is_tried_again_later, test_what_lies_on_another_submap_hides_no_opening}.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core import ExperienceMap

OLD_AFTER_S = 60.0  # an experience is old ground when it was made so long ago
PLACE_REACH_M = 1.5  # a visit to a place counts for all experiences this near
OPENING_M = 2.0  # sonars that see as far as this see open floor ...
OPENING_GAP_M, OPENING_MOST_M = 0.7, 2.5  # ... whose place is so much before the echo, and at most so far away
OPENING_BEAMS = 3  # must have seen an opening
OPENING_AGAIN_S = 120.0  # one that has been tried is tried again after this time, after twice as long the next time
THIN_M = 0.8  # the map is thin where no experience is about this near
UNSEEN_M2 = 5.0  # so much new ground is expected behind each opening, beside what is seen of it
BEYOND_M = (1.7, 3.3, 4.1)  # so far along a beam it is looked whether that ground is new, too ...
ABOUT = 2  # ... which counts for places within so many times THIN_M

_Array = NDArray[np.float64]


@kind("known ground/3")
class KnownGround:
    """Rows belong to the experiences, by number."""

    def __init__(self, sonar_angles_rad: _Array) -> None:
        """sonar_angles_rad: (8,), positive to the left."""
        self._angles = np.array(sonar_angles_rad, np.float64)
        self.count = 0
        self._last_s = np.zeros(0)  # when the robot was last there
        self._made_s = np.zeros(0)
        self._seen_m = np.zeros((0, len(self._angles)), np.float32)  # sonar ranges where the experience was made
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
            self._seen_m[experiences.active] = ranges_m
            self.count = len(experiences)
        elif self.now_s - self._made_s[experiences.active] > OLD_AFTER_S:
            self.new_m = 0.0
        self._last_s[experiences.active] = self.now_s

    def _grow(self, count: int) -> None:
        """Room for twice as many experiences, when there are more than rows."""
        if count <= len(self._last_s):
            return
        for name in ("_last_s", "_made_s", "_seen_m"):
            array = getattr(self, name)
            more = np.zeros((2 * count - len(array), *array.shape[1:]), array.dtype)
            setattr(self, name, np.concatenate([array, more]))

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

    def openings(self, experiences: ExperienceMap, least: int) -> tuple[NDArray[np.int64], _Array, _Array]:
        """Experiences (k,), the places (k, 2), m, map frame, that were seen from there and never driven on, and how much
        new ground is expected about each, (k,), m².

        least: so many beams must have seen a place; a single one may be a false echo. Only what lies on the robot's own
        submap counts: where the others lie to it is unknown.
        """
        poses, submaps = experiences.poses[: self.count], experiences.submap_of[: self.count]
        own = submaps == submaps[experiences.active]
        rows, beams = np.nonzero((self._seen_m[: self.count] >= OPENING_M) & own[:, None])
        free_m = self._seen_m[rows, beams].astype(np.float64) - OPENING_GAP_M
        heading = poses[rows, 2] + self._angles[beams]
        way = np.stack([np.cos(heading), np.sin(heading)], axis=1)
        places = poses[rows, :2] + np.minimum(free_m, OPENING_MOST_M)[:, None] * way
        beyond = [poses[rows[far], :2] + metres * way[far] for metres in BEYOND_M for far in [free_m >= metres]]
        done = [tried[:3] for tried in self._done if own[tried[0]] and tried[3] > self.now_s]
        known = np.concatenate([poses[own, :2], placed(done, poses)])
        often, area = _new_ground(np.concatenate([places, *beyond]), known, least)
        often, area = often[: len(places)], area[: len(places)]
        return rows[often].astype(np.int64), places[often], area[often] + UNSEEN_M2


def placed(points: list[tuple[int, float, float]], poses: _Array) -> _Array:
    """The places (n, 2), m, map frame, of points in the frames of experiences."""
    if not points:
        return np.zeros((0, 2))
    rows = np.array(points)
    x, y, heading = poses[rows[:, 0].astype(np.int64)].T
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([x + c * rows[:, 1] - s * rows[:, 2], y + s * rows[:, 1] + c * rows[:, 2]], axis=1)


def _new_ground(places: _Array, known: _Array, least: int) -> tuple[NDArray[np.bool_], _Array]:
    """Which of the places (k, 2) lie farther than THIN_M (to twice that) from all known ones (n, 2), where at least so many
    do; and how much of such ground, m², lies within `ABOUT` cells of each."""
    if not len(places):
        return np.zeros(0, np.bool_), np.zeros(0)
    both = np.concatenate([places, known])
    low = both.min(axis=0) - (ABOUT + 1) * THIN_M
    size = np.ceil((both.max(axis=0) - low) / THIN_M).astype(np.int64) + ABOUT + 1
    old, seen = np.zeros(size, np.bool_), np.zeros(size, np.int64)
    cells = np.floor((both - low) / THIN_M).astype(np.int64)
    mine, theirs = tuple(cells[: len(places)].T), tuple(cells[len(places) :].T)
    old[theirs] = True
    np.add.at(seen, mine, 1)
    new = ~_spread(old, 1) & (seen >= least)
    area = THIN_M**2 * _summed(new.astype(np.float64), ABOUT)
    return new[mine], area[mine]


def _spread(marked: NDArray[np.bool_], cells: int) -> NDArray[np.bool_]:
    for axis in (0, 1):
        marked = np.logical_or.reduce([np.roll(marked, shift, axis) for shift in range(-cells, cells + 1)])
    return marked


def _summed(values: _Array, cells: int) -> _Array:
    for axis in (0, 1):
        values = np.sum([np.roll(values, shift, axis) for shift in range(-cells, cells + 1)], axis=0)
    return values
