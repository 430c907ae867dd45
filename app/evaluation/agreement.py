"""How well a map agrees with the truth: how far its path is off after alignment, which of its links are false, how many
loops of the floor it has closed, and how much of the floor the robot has covered. Lengths in m, angles in rad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core import ExperienceMap, Pose2
from sim2d import FreeSpace

Path = NDArray[np.floating[Any]]  # (ticks, 2), m


def alignment(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> Pose2:
    """The pose of the estimate's frame in the true frame that fits (n, 2) points best. Umeyama 1991, in SE(2)."""
    mean_e, mean_t = estimate.mean(axis=0), truth.mean(axis=0)
    e, t = estimate - mean_e, truth - mean_t
    angle = math.atan2(float(np.sum(e[:, 0] * t[:, 1] - e[:, 1] * t[:, 0])), float(np.sum(e * t)))
    turned = Pose2(0.0, 0.0, angle).compose(Pose2(float(mean_e[0]), float(mean_e[1]), 0.0))
    return Pose2(float(mean_t[0]) - turned.x, float(mean_t[1]) - turned.y, angle)


def align(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.float64]:
    """`estimate` (n, 2), rotated and translated (not scaled) to fit `truth` best."""
    frame = alignment(estimate, truth)
    c, s = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return estimate @ np.array([[c, s], [-s, c]]) + (frame.x, frame.y)


def steady_alignment(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> Pose2:
    """`alignment` without the tenth that fits worst, so that what is far off for a while does not turn the frame: one
    step of least trimmed squares, Rousseeuw 1984."""
    off = np.hypot(*(align(estimate, truth) - truth).T)
    best = off <= np.quantile(off, 0.9)
    return alignment(estimate[best], truth[best])


def rmse(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    """Root mean square distance (m) of two paths, (n, 2) each, after alignment; 0 for fewer than two points."""
    if len(estimate) < 2:
        return 0.0
    off: NDArray[np.float64] = align(estimate, truth) - truth
    squares: NDArray[np.float64] = np.square(off).sum(axis=1)
    return float(np.sqrt(np.mean(squares)))


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


def observations(experiences: ExperienceMap, births: Births) -> Judged:
    """The links that rest on an observation. A false one makes one place of two."""
    return _judged(experiences, births, ~experiences.transitions.chain)


def backbone(experiences: ExperienceMap, births: Births) -> Judged:
    """The links that are odometry alone. They are false where the robot was carried and did not notice."""
    return _judged(experiences, births, experiences.transitions.chain)


def _judged(experiences: ExperienceMap, births: Births, which: NDArray[np.bool_]) -> Judged:
    """These rows, if both ends were made in this run, so that it is known where, and if they claim to be good to a
    metre. How far off: from where the second end was truly made to where the link puts it, from where the first was.
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


def loops_closed(ends: NDArray[np.int64], births: Births, path: Path, islands: NDArray[np.float64],
                 tick_s: float) -> int:  # fmt: skip
    """How many independent loops of the floor are closed by links between `ends`, (m, 2).

    A link that rests on an observation closes a loop: from where its first end was made the robot drove to where the
    second was made, and the observation says that both are one place. How often that way winds round each island of the
    floor (a block of houses, the core of a corridor loop) is a row of whole numbers. As many loops are closed as these
    rows are independent.

    births: (n, 4) of the experiences; path: where the robot truly was in each tick, (ticks, 2), tick_s apart;
    islands: a point in each, (k, 2). Links whose ends are not where one of the two was made must have been left out.
    """
    if len(ends) == 0 or len(islands) == 0:
        return 0
    made_s: NDArray[np.float64] = births[ends, 3]
    ticks = np.minimum(np.round(made_s / tick_s).astype(np.int64), len(path) - 1)  # (m, 2)
    turns = [_turns(path - island, ticks) for island in islands]
    return int(np.linalg.matrix_rank(np.unique(np.stack(turns, axis=1), axis=0)))


ROUND_M, ROUND_S = 1.0, 30.0  # a way comes round where it has been this near, so long before


def loops_gone_round(path: Path, islands: NDArray[np.float64], tick_s: float) -> int:
    """How many independent loops of the floor the robot's way went round: what `loops_closed` would be if it had known
    every place again to which it came a second time. path: (ticks, 2); islands: (k, 2)."""
    if len(islands) == 0 or len(path) == 0:
        return 0
    ticks = np.arange(0, len(path), max(1, round(1.0 / tick_s)))  # one a second
    cells = np.floor(path[ticks] / ROUND_M).astype(np.int64)
    _, first, which = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    pairs = np.stack([ticks[first[which.ravel()]], ticks], axis=1)
    pairs = pairs[(pairs[:, 1] - pairs[:, 0]) * tick_s > ROUND_S]
    turns = [_turns(path - island, pairs) for island in islands]
    return int(np.linalg.matrix_rank(np.unique(np.stack(turns, axis=1), axis=0))) if len(pairs) else 0


def _turns(path: NDArray[np.float64], ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    """How often the path winds round (0, 0) from the first to the second tick of each pair, and straight back; (m,)."""
    angle: NDArray[np.float64] = np.unwrap(np.arctan2(path[:, 1], path[:, 0]))
    return np.round((angle[ticks[:, 1]] - angle[ticks[:, 0]]) / (2 * np.pi))


NEAR_M = 1.0  # floor from which the robot could drive to its path within this is covered


@kind("coverage/1")
class Coverage:
    """How much of the floor a robot has covered. Follows its path as it grows: the work is that of what is new."""

    CACHES = ("_floor",)

    def __init__(self) -> None:
        self._floor: FreeSpace | None = None
        self._covered: NDArray[np.bool_] = np.zeros((0, 0), np.bool_)
        self._count = self._followed = 0

    def settle(self, floor: FreeSpace) -> None:
        """Go on, on this floor, after having been restored. On a floor of another size, begin anew."""
        self._floor = floor if self._covered.shape == tuple(floor.grid) else None

    def follow(self, floor: FreeSpace, path: Path) -> float:
        """The share of this floor that a path, (n, 2) m, covers. Another floor or a shorter path begins anew."""
        if floor is not self._floor or len(path) < self._followed:
            self._floor, self._covered = floor, np.zeros(floor.grid, np.bool_)
            self._count = self._followed = 0
        self._count += floor.cover(self._covered, path[self._followed :].astype(np.float64), NEAR_M)
        self._followed = len(path)
        return self._count / max(1, floor.floor_cells)
