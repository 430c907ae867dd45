"""The transitions of an experience map, as rows for map correction and for the times of routes. ACRA 2006 section 3.2.

A row says: from experience i to experience j the robot makes this move (dx, dy in the frame of i, change of facing). Its
weight is sigma^2 / variance, 1 for the odometry of one step. Since the move is kept in the frame of i, it turns with i in
the map by itself, which is equation 8. test_transitions.py::test_links_turn_with_their_experience.
"""

# Callers may not be type-checked.
# pyright: reportUnnecessaryIsInstance=false

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from ratslam_core.params import ExperienceMapParams
from ratslam_core.pose_graph.adjacency import Adjacency
from ratslam_core.types import Pose2, wrap_angle

BEHAVIOURS = 16


def require_behaviour(behaviour: int) -> int:
    """The number of a local movement behaviour, or a ValueError that says which numbers there are."""
    if isinstance(behaviour, bool) or not isinstance(behaviour, int | np.integer) or not 0 <= behaviour < BEHAVIOURS:
        raise ValueError(f"behaviour must be a whole number from 0 to {BEHAVIOURS - 1}, got {behaviour!r}")
    return int(behaviour)


@dataclass(frozen=True, slots=True)
class Link:
    """One transition i -> j, as plain values. ACRA 2005 4.2, ACRA 2006 3.2 and 3.4."""

    from_experience: int
    to_experience: int
    distance_m: float  # d_ij
    bearing_rad: float  # theta_ij: to j, relative to the facing of i
    facing_rad: float  # phi_ij: facing of j relative to that of i
    time_s: float  # mean over the passages
    behaviour: int  # under which it was learnt
    passages: int
    trials: int  # how often the robot was expected to arrive by it
    confidence: float  # c_ij: share of the trials in which the robot arrived
    weight: float  # in map correction, 1 for odometry over a step
    believed: float  # the weight times how far (0 to 1) the map agrees with it


@kind("transitions/2")
class Transitions:
    """Rows that are added, averaged and dropped. Arrays have room to spare; `count` rows are used."""

    def __init__(self) -> None:
        self.count = 0
        self.graph = Adjacency()
        self.ends = np.zeros((1024, 2), np.int64)
        self.move = np.zeros((1024, 3))
        self.weight = np.zeros(1024)
        self.believed = np.zeros(1024)  # the weight times how far the map agrees with the row
        self.turning_s = np.zeros(1024)  # time during which the wheels turned
        self.time_s = np.zeros(1024)
        self.passages = np.zeros(1024, np.int64)
        self.travelled = np.zeros(1024, np.bool_)  # a way that the robot drove; the others serve map correction only
        self.chain = np.zeros(1024, np.bool_)  # odometry to an experience that was just made, not a look at a known one
        self.behaviour = np.zeros(1024, np.int8)
        self.trials = np.zeros(1024, np.int64)
        self.confidence = np.zeros(1024)
        self.row_of: dict[tuple[int, int], int] = {}
        self.reuses = False  # whether the next rows take the room of those that are free
        self.free: list[int] = []  # rows of looks that are no way any more
        self.dropped: list[tuple[int, int]] = []  # every link that was deleted because it failed, in order

    def add(self, i: int, j: int, *, travelled: bool, behaviour: int = 0) -> int:
        """A new row, still without a move; returns its number."""
        row = self._room()
        self.ends[row], self.travelled[row], self.behaviour[row] = (i, j), travelled, behaviour
        self.chain[row] = self.graph.degree(j) == 0 or not travelled
        self.graph.add_link(i, j, row)
        if travelled:
            self.row_of[i, j] = row
        return row

    def _room(self) -> int:
        """An empty row. [ours] That of a look that was deleted, or else one more, as in the plain twin (`reuses` off).

        test_link_confidence.py::test_a_deleted_look_leaves_its_row_to_the_next.
        """
        if self.reuses and self.free:
            row = self.free.pop()
            self.graph.remove_link(int(self.ends[row, 0]), int(self.ends[row, 1]), row)
            for name in _COLUMNS:
                getattr(self, name)[row] = 0
            return row
        if self.count == len(self.ends):
            for name in _COLUMNS:
                array = getattr(self, name)
                setattr(self, name, np.concatenate([array, np.zeros_like(array)]))
        self.count += 1
        return self.count - 1

    def measure(self, row: int, move: Pose2, weight: float, old: NDArray[np.float64], old_weight: float) -> None:
        """Average a passage into the row as it was before, each by its weight. ACRA 2006 eq. 6."""
        share = weight / (old_weight + weight)
        turn = old[2] + share * wrap_angle(move.heading_rad - old[2])
        self.move[row] = old[0] + share * (move.x - old[0]), old[1] + share * (move.y - old[1]), wrap_angle(turn)
        self.weight[row] = self.believed[row] = old_weight + weight

    def take_time(self, row: int, seconds: float, turning_s: float) -> None:
        """Add the times of one more passage to the running means."""
        n = self.passages[row]
        self.time_s[row] += (seconds - self.time_s[row]) / (n + 1)
        self.turning_s[row] += (turning_s - self.turning_s[row]) / (n + 1)
        self.passages[row] = n + 1

    def seconds(self, poses: NDArray[np.float64], pace: float) -> NDArray[np.float64]:
        """Seconds of each row, shape (count,): its time, or if longer its length at this pace (s/m); inf for no way."""
        rows = slice(self.count)
        return _seconds(self.ends[rows], self.time_s[rows], self.travelled[rows], poses, pace)

    def departures(self, i: int, behaviour: int) -> NDArray[np.int64]:
        """Rows of the links from i that were learnt under this behaviour."""
        rows = slice(self.count)
        own = (self.ends[rows, 0] == i) & (self.behaviour[rows] == behaviour) & self.travelled[rows]
        return np.flatnonzero(own)

    def judge(self, row: int, reached: bool, p: ExperienceMapParams) -> bool:
        """Count one more trial of a link: c_ij = n_ij / n, ACRA 2006 eq. 9. True when it failed so often that it was deleted."""
        n = self.trials[row] = self.trials[row] + 1
        self.confidence[row] += (reached - self.confidence[row]) / n
        if n < p.link_trials or self.confidence[row] >= p.link_confidence:
            return False
        self._drop(row)
        return True

    def let_go(self, rows: NDArray[np.intp]) -> None:
        """These rows tie nothing any more, and are no ways. They have not failed, so they are not among the `dropped`."""
        for row in rows.tolist():
            if self.travelled[row]:
                self._close(row)
        self.weight[rows] = self.believed[rows] = 0.0

    def _drop(self, row: int) -> None:
        self.dropped.append((int(self.ends[row, 0]), int(self.ends[row, 1])))
        self._close(row)

    def _close(self, row: int) -> None:
        """The row is no longer a way. A row of odometry goes on holding the map together; a look no longer counts."""
        i, j = int(self.ends[row, 0]), int(self.ends[row, 1])
        del self.row_of[i, j]
        self.travelled[row] = False
        if not self.chain[row]:
            self.weight[row] = self.believed[row] = 0.0
            self.free.append(row)

    def link(self, row: int) -> Link:
        """One row, as plain values."""
        i, j = self.ends[row]
        dx, dy, turn = self.move[row]
        return Link(
            int(i), int(j), math.hypot(dx, dy), math.atan2(dy, dx), float(turn), float(self.time_s[row]),
            int(self.behaviour[row]), int(self.passages[row]), int(self.trials[row]), float(self.confidence[row]),
            float(self.weight[row]), float(self.believed[row]),
        )  # fmt: skip


@njit(cache=True, nogil=True)
def _seconds(
    ends: NDArray[np.int64],
    time_s: NDArray[np.float64],
    travelled: NDArray[np.bool_],
    poses: NDArray[np.float64],
    pace: float,
) -> NDArray[np.float64]:
    seconds = np.full(len(ends), np.inf)
    for row in range(len(ends)):
        if travelled[row]:
            i, j = ends[row, 0], ends[row, 1]
            dx, dy = poses[j, 0] - poses[i, 0], poses[j, 1] - poses[i, 1]
            seconds[row] = max(time_s[row], pace * math.sqrt(dx * dx + dy * dy))
    return seconds


_COLUMNS = (
    "ends", "move", "weight", "believed", "turning_s", "time_s", "passages", "travelled", "chain", "behaviour",
    "trials", "confidence",
)  # fmt: skip
