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

from disk import kind
from ratslam_core.params import ExperienceMapParams
from ratslam_core.types import IDENTITY, Flags, Floats, Ints, Odometry, Pose2, Uints32, grown, pose_of, wrap_angle

BEHAVIOURS = 16
ROOM = 4  # half-edges that a new node has room for
_COLUMNS = (
    "ends", "move", "weight", "believed", "turning_s", "time_s", "passages", "travelled", "chain", "behaviour",
    "trials", "confidence",
)  # fmt: skip


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
        self.chain = np.zeros(1024, np.bool_)  # odometry to a new experience, no observation of a known one
        self.behaviour = np.zeros(1024, np.int8)
        self.trials = np.zeros(1024, np.int64)
        self.confidence = np.zeros(1024)
        self.row_of: dict[tuple[int, int], int] = {}
        self.reuses = False  # whether the next rows take the room of those that are free
        self.free: list[int] = []  # rows of observations that are no way any more
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
        """An empty row. [ours] That of a deleted observation, or else one more, as in the plain twin (`reuses` off).

        test_link_confidence.py::test_a_deleted_observation_leaves_its_row_to_the_next.
        """
        if self.reuses and self.free:
            row = self.free.pop()
            self.graph.remove_link(int(self.ends[row, 0]), int(self.ends[row, 1]), row)
            for name in _COLUMNS:
                getattr(self, name)[row] = 0
            return row
        if self.count == len(self.ends):
            for name in _COLUMNS:
                setattr(self, name, grown(getattr(self, name)))
        self.count += 1
        return self.count - 1

    def measure(self, row: int, move: Pose2, weight: float, old: Floats, old_weight: float) -> None:
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

    def seconds(self, poses: Floats, pace: float) -> Floats:
        """Seconds of each row, shape (count,): its time, or if longer its length at this pace (s/m); inf for no way."""
        rows = slice(self.count)
        return _seconds(self.ends[rows], self.time_s[rows], self.travelled[rows], poses, pace)

    def departures(self, i: int, behaviour: int) -> Ints:
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
        self.dropped.append((int(self.ends[row, 0]), int(self.ends[row, 1])))
        self._close(row)
        return True

    def let_go(self, rows: Ints) -> None:
        """These rows tie nothing any more, and are no ways. They have not failed, so they are not among the `dropped`."""
        for row in rows.tolist():
            if self.travelled[row]:
                self._close(row)
        self.weight[rows] = self.believed[rows] = 0.0

    def _close(self, row: int) -> None:
        """The row is no longer a way. Odometry goes on holding the map together; an observation no longer counts."""
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
def _seconds(ends: Ints, time_s: Floats, travelled: Flags, poses: Floats, pace: float) -> Floats:
    seconds = np.full(len(ends), np.inf)
    for row in range(len(ends)):
        if travelled[row]:
            i, j = ends[row, 0], ends[row, 1]
            dx, dy = poses[j, 0] - poses[i, 0], poses[j, 1] - poses[i, 1]
            seconds[row] = max(time_s[row], pace * math.sqrt(dx * dx + dy * dy))
    return seconds


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


def require_behaviour(behaviour: int) -> int:
    """The number of a local movement behaviour, or a ValueError that says which numbers there are."""
    if isinstance(behaviour, bool) or not isinstance(behaviour, int | np.integer) or not 0 <= behaviour < BEHAVIOURS:
        raise ValueError(f"behaviour must be a whole number from 0 to {BEHAVIOURS - 1}, got {behaviour!r}")
    return int(behaviour)


@kind("preintegrated odometry/1")
@dataclass(slots=True)
class PreintegratedOdometry:
    """Odometry summed up since a certain moment: the movement in the frame of where it began, the distance driven, the time
    the wheels turned, and all the time."""

    moved: Pose2 = IDENTITY
    way_m: float = 0.0
    turning_s: float = 0.0
    time_s: float = 0.0

    def add(self, moved: Pose2, odometry: Odometry) -> None:
        self.moved = self.moved.compose(moved)
        self.way_m += abs(odometry.speed * odometry.dt)
        self.turning_s += odometry.dt * (not odometry.still)
        self.time_s += odometry.dt


def moved_by(odometry: Odometry) -> Pose2:
    """One step in the robot's own frame: straight along the heading in the middle of the step."""
    middle = odometry.yaw_rate * odometry.dt / 2
    step = odometry.speed * odometry.dt
    return pose_of(step * math.cos(middle), step * math.sin(middle), wrap_angle(2 * middle))


@kind("adjacency/1")
class Adjacency:
    """Which links meet at each experience, laid out for kernels that walk over the whole map.

    Each node owns a block of half-edges in one arena: `half[start[node]:][:used[node]]`, in the order of creation. A link
    from i to j that is row r elsewhere appears twice: at i as half 2 r, with `other` j, and at j as half 2 r + 1, with
    `other` i. A full block moves to the end of the arena with twice the room, so that a walk over all nodes reads memory
    nearly in order. Row numbers need not be consecutive, and a removed one may be used again. All arrays are uint32, since
    compiled code need not test whether an unsigned index counts from the end; they are longer than what is in use.
    """

    def __init__(self) -> None:
        self.start = np.zeros(1024, np.uint32)
        self.used = np.zeros(1024, np.uint32)
        self.half = np.zeros(4096, np.uint32)
        self.other = np.zeros(4096, np.uint32)
        self._room = np.zeros(1024, np.uint32)
        self._nodes = self._end = 0
        self.changes = 0  # how often a node or a link was added or removed

    def add_node(self) -> None:
        if self._nodes == len(self.start):
            self.start, self.used, self._room = grown(self.start), grown(self.used), grown(self._room)
        self.start[self._nodes], self._room[self._nodes] = self._reserve(ROOM), ROOM
        self._nodes += 1
        self.changes += 1

    def add_link(self, i: int, j: int, row: int) -> None:
        """Row `row` links node i to node j."""
        for node in (i, j):
            if not 0 <= node < self._nodes:
                raise ValueError(f"a link must join nodes from 0 to {self._nodes - 1}, got {node!r}")
        self._append(i, 2 * row, j)
        self._append(j, 2 * row + 1, i)
        self.changes += 1

    def remove_link(self, i: int, j: int, row: int) -> None:
        """Remove a link; the others keep their order. O(links at i and j)."""
        at = self._find(i, 2 * row), self._find(j, 2 * row + 1)
        if min(at) < 0:
            raise ValueError(f"row {row!r} must link {i!r} to {j!r} to be removed, but it does not")
        self._take(i, at[0])
        self._take(j, self._find(j, 2 * row + 1))
        self.changes += 1

    def degree(self, node: int) -> int:
        """How many half-edges there are at a node."""
        return int(self.used[node])

    def at(self, node: int) -> tuple[Uints32, Uints32]:
        """Half-edges at a node and the nodes at their other ends, in the order of creation. Views."""
        block = slice(int(self.start[node]), int(self.start[node]) + int(self.used[node]))
        return self.half[block], self.other[block]

    def _append(self, node: int, half: int, other: int) -> None:
        start, used = int(self.start[node]), int(self.used[node])
        if used == self._room[node]:
            self._room[node] *= 2
            new = self._reserve(2 * used)
            for array in (self.half, self.other):
                array[new : new + used] = array[start : start + used]
            self.start[node] = start = new
        self.half[start + used], self.other[start + used] = half, other
        self.used[node] = used + 1

    def _reserve(self, room: int) -> int:
        """Reserve room at the end of the arena; returns where it begins."""
        while self._end + room > len(self.half):
            self.half, self.other = grown(self.half), grown(self.other)
        self._end += room
        return self._end - room

    def _find(self, node: int, half: int) -> int:
        """Place of a half-edge in its block, -1 when it is not there."""
        if not 0 <= node < self._nodes:
            return -1
        found = np.flatnonzero(self.at(node)[0] == half)
        return int(found[0]) if len(found) else -1

    def _take(self, node: int, place: int) -> None:
        for block in self.at(node):
            block[place:-1] = block[place + 1 :].copy()
        self.used[node] -= 1
