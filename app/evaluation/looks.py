"""The links of a map compared with the truth: which of them join places that truly lie elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ratslam_core import ExperienceMap

FALSE_M = 1.0  # a link is false if it is farther off than this
BELIEVED = 0.5  # of its weight, from which on map correction counts as believing a link

Births = NDArray[np.float64]  # (n, 4): true x, y, heading and the time of making each experience


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """Links as rows: from and to, how far off (m), and whether map correction believes them."""

    ends: NDArray[np.int64]  # (m, 2)
    off_m: NDArray[np.float64]  # (m,)
    believed: NDArray[np.bool_]  # (m,)

    @property
    def false(self) -> NDArray[np.bool_]:
        return self.off_m > FALSE_M


def looks(experiences: ExperienceMap, births: Births) -> Judged:
    """The links that rest on a look. A false one welds two places together that are not one."""
    return _judged(experiences, births, ~experiences.transitions.chain)


def backbone(experiences: ExperienceMap, births: Births) -> Judged:
    """The links that are odometry alone. They are false where the robot was carried and did not notice."""
    return _judged(experiences, births, experiences.transitions.chain)


def _judged(experiences: ExperienceMap, births: Births, which: NDArray[np.bool_]) -> Judged:
    """These rows, if both ends were made in this run, so that it is known where, and if they claim to be good to a metre.

    How far off: the distance between where the link puts its second end, seen from where its first end was truly made,
    and where the second was truly made.
    """
    t = experiences.transitions
    claims = t.weight[: t.count] >= (experiences.step_sigma_m / FALSE_M) ** 2  # a row's sigma is at most 1 m
    rows = np.flatnonzero(which[: t.count] & claims)
    rows = rows[np.isfinite(births[t.ends[rows], 0]).all(axis=1)]
    ends, move = t.ends[rows], t.move[rows]
    a, b = births[ends[:, 0]], births[ends[:, 1]]
    c, s = np.cos(a[:, 2]), np.sin(a[:, 2])
    across = a[:, 0] + c * move[:, 0] - s * move[:, 1] - b[:, 0]
    up = a[:, 1] + s * move[:, 0] + c * move[:, 1] - b[:, 1]
    return Judged(ends, np.hypot(across, up), t.believed[rows] >= BELIEVED * t.weight[rows])
