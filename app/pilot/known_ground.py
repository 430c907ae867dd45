"""[ours] What the robot remembers of the ground it drove on: when it was last at each experience, and how far its
sonars saw from there. Where they saw open floor that it never drove on, the map is thin.

test_known_ground.py::{test_open_floor_that_was_never_driven_on_is_an_opening, test_what_was_driven_on_is_no_opening}.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.pilot.params import SeekingParams
from disk import kind
from ratslam_core import ExperienceMap

_Array = NDArray[np.float64]


@kind("known ground/1")
class KnownGround:
    """Rows belong to the experiences, by number."""

    def __init__(self, sonar_angles_rad: _Array) -> None:
        """sonar_angles_rad: (8,), positive to the left."""
        self._angles = np.array(sonar_angles_rad, np.float64)
        self.count = 0
        self._last_s = np.zeros(0)  # when the robot was last there
        self._made_s = np.zeros(0)
        self._seen_m = np.zeros((0, len(self._angles)), np.float32)  # sonar ranges where the experience was made
        self._done: list[tuple[float, float]] = []  # openings that have been tried, m, map frame
        self.now_s = self.new_m = 0.0  # time; distance driven since the robot was last on old ground

    @property
    def last_s(self) -> _Array:
        return self._last_s[: self.count]

    @property
    def made_s(self) -> _Array:
        return self._made_s[: self.count]

    def step(
        self, experiences: ExperienceMap, ranges_m: NDArray[np.float32], way_m: float, dt: float, p: SeekingParams
    ) -> None:
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
        elif self.now_s - self._made_s[experiences.active] > p.old_after_s:
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

    def been_at(self, x: float, y: float, poses: _Array, p: SeekingParams) -> None:
        """The robot was at this place of the map, whichever way it faced."""
        near = np.hypot(poses[: self.count, 0] - x, poses[: self.count, 1] - y) < p.place_reach_m
        self.last_s[near] = self.now_s

    def tried(self, x: float, y: float) -> None:
        """An opening is done with, whether the robot could drive there or not."""
        self._done.append((x, y))

    def openings(self, poses: _Array, p: SeekingParams) -> tuple[NDArray[np.int64], _Array]:
        """Experiences (k,) and the places (k, 2), m, map frame, that were seen from there and never driven on."""
        n = self.count
        seen = self._seen_m[:n]
        rows, beams = np.nonzero(seen >= p.opening_m)
        heading = poses[rows, 2] + self._angles[beams]
        away = np.minimum(seen[rows, beams] - p.opening_gap_m, p.opening_most_m)
        places = poses[rows, :2] + away[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
        thin = _far_from(places, np.concatenate([poses[:n, :2], np.array(self._done).reshape(-1, 2)]), p.thin_m)
        rows, places = rows[thin], places[thin]
        cells = np.floor(places / p.thin_m).astype(np.int64)
        _, which, count = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
        often = count[which.ravel()] >= p.opening_beams  # a single beam may be a false echo
        return rows[often].astype(np.int64), places[often]


def _far_from(places: _Array, others: _Array, reach: float) -> NDArray[np.bool_]:
    """Which of the places (k, 2) are farther than about `reach` (1 to 2 times) from all others (n, 2)."""
    if not len(places):
        return np.zeros(0, np.bool_)
    low = np.minimum(places.min(axis=0), others.min(axis=0)) - 2 * reach
    high = np.maximum(places.max(axis=0), others.max(axis=0)) + 2 * reach
    size = np.ceil((high - low) / reach).astype(np.int64)
    taken = np.zeros((int(size[0]), int(size[1])), np.bool_)
    at = np.floor((others - low) / reach).astype(np.int64)
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            taken[at[:, 0] + dx, at[:, 1] + dy] = True
    mine = np.floor((places - low) / reach).astype(np.int64)
    free: NDArray[np.bool_] = ~taken[mine[:, 0], mine[:, 1]]
    return free
