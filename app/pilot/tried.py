"""[ours] What was tried in vain is left alone for a while, and after each further trial there for twice as long.

An opening into which the robot could not drive, what was seen from about a place that a trip did not get to, a loop that
nothing closed: somebody may have stood there, or the map be wrong. So each is tried again, but ever more rarely: between two
passes of a street that lie apart on the map a robot would else set out for the same dozen openings for hours.
test_tried.py.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core import ExperienceMap

_Array = NDArray[np.float64]


@kind("tried/1")
class Tried:
    """Places that were tried. They move with the map."""

    def __init__(self, about_m: float, again_s: float) -> None:
        """about_m: what lies this near was tried, too. again_s: for so long it is left alone after the first trial."""
        self._about_m, self._again_s = about_m, again_s
        self._places: list[tuple[int, float, float]] = []  # m, in an experience's frame ...
        self._until_s: list[float] = []  # ... and until when each is left alone

    def add(self, experiences: ExperienceMap, experience: int, x: float, y: float, now_s: float) -> None:
        """It was tried at (x, y), m, in the frame of the experience."""
        self._forget_another_map(experiences)
        here = placed([(experience, x, y)], experiences.poses)
        before = int(self._about(here, placed(self._places, experiences.poses)).sum())
        self._places.append((experience, x, y))
        self._until_s.append(now_s + self._again_s * 2.0**before)

    def left_alone(self, experiences: ExperienceMap, now_s: float) -> _Array:
        """The places (k, 2) on the robot's submap that are not tried now, m, map frame."""
        self._forget_another_map(experiences)
        submaps = experiences.submap_of
        own = submaps[experiences.active]
        both = zip(self._places, self._until_s, strict=True)
        return placed([p for p, until_s in both if until_s > now_s and submaps[p[0]] == own], experiences.poses)

    def near(self, experiences: ExperienceMap, places: _Array, now_s: float) -> NDArray[np.bool_]:
        """Which of the places (n, 2), m, map frame, are left alone with what was tried beside them."""
        return np.asarray(self._about(places, self.left_alone(experiences, now_s)).any(axis=1))

    def _about(self, places: _Array, tried: _Array) -> NDArray[np.bool_]:
        dx, dy = (places[:, None] - tried).transpose(2, 0, 1)
        return np.hypot(dx, dy) < self._about_m

    def _forget_another_map(self, experiences: ExperienceMap) -> None:
        if any(experience >= len(experiences) for experience, _, _ in self._places):
            self._places, self._until_s = [], []


def placed(points: list[tuple[int, float, float]], poses: _Array) -> _Array:
    """The places (n, 2), m, map frame, of points in the frames of experiences."""
    if not points:
        return np.zeros((0, 2))
    rows = np.array(points)
    x, y, heading = poses[rows[:, 0].astype(np.int64)].T
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([x + c * rows[:, 1] - s * rows[:, 2], y + s * rows[:, 1] + c * rows[:, 2]], axis=1)
