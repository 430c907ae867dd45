"""[ours] One law of evidence: where a robot that was carried away is, and how sure that is.

Hypotheses of where the robot is move by its odometry, as packets do, and each observation weighs them. How like the
views near a hypothesis are to what is seen, in units of how like views are anyway, tells how many times likelier this
observation is there than at a wrong place that looked right a metre before: `RINGS`, the outcome of
`python -m benchmarks.evidence`. Neighbouring observations repeat each other, so a metre or a radian of way counts as one
unit of evidence; and since wrong places can stay alike for longer, a unit takes a share of what was gathered away.
Beside all hypotheses stands that of a new place, for and against which nothing speaks.

The robot *believes* a hypothesis that is likelier than all others together. There it acts; nothing is learnt from it, so
that it may be wrong at no cost. Where the odds are 1000 to 1, the submap on which it was is *merged*. test_evidence.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from ratslam_core.params import EvidenceParams
from ratslam_core.types import Odometry, Pose2, wrap_angle

Rows = NDArray[np.float64]
Whole = NDArray[np.int64]

MOST = 32  # hypotheses
LEAST_VIEWS = 10  # of fewer views nobody can say how like views are anyway
MOST_VIEWS = 2048  # that are compared with an observation; of more, every second, third ... one
MOST_PAIRS = 4096  # of a hypothesis and a view near it
SUGGESTED = 4  # best views of all that say where the robot may be
LIKE = 0.8  # a less like view suggests nothing
PRIOR = -4.0  # log odds of a place that a view suggests, against a new place
FORGOTTEN = PRIOR - 4.0  # log odds below which a hypothesis is given up
SAME_M, SAME_RAD = 0.6, 0.3  # hypotheses this near are one
PULLS_M, PULLS_RAD = 0.7, 0.35  # a view this near to a hypothesis says more exactly where it is
PULL = 0.3  # the share of that way which it goes for a unit of evidence
LEAST_PULL = 0.15
AGAINST, FOR = -2.0, 7.0  # nats that one unit of evidence can say at most
# The likeness: the least difference to a view near the hypothesis, over the tenth of all differences that is least.
LIKENESS: Rows = np.array([0.2, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95, 1.05, 1.2])
# What that says, in nats, by how near views there are: within so many metres and radians. The nearest that there are count.
RINGS: Rows = np.array([(0.5, 0.3), (0.5, 0.52), (1.0, 0.3)])
NATS: Rows = np.array(
    [
        [5.8, 4.2, 2.7, 1.3, -0.4, -1.7, -2.5, -2.9, -3.1, -3.1],
        [4.3, 4.3, 3.3, 2.4, 1.1, -0.3, -1.1, -1.7, -1.9, -2.2],
        [3.2, 3.2, 2.9, 2.1, 1.1, 0.2, -0.4, -0.9, -1.2, -1.4],
    ]
)
X, Y, HEADING, ODDS, UNITS, SUBMAP = range(6)  # of a row


class Views(Protocol):
    """What has to be known of the local view."""

    @property
    def column_rad(self) -> float: ...
    def apart_at(self, views: Whole, shifts: Whole, slack: int, /) -> tuple[Rows, Whole]: ...


class Map(Protocol):
    """What has to be known of the experience map."""

    @property
    def poses(self) -> Rows: ...
    @property
    def views(self) -> Whole: ...
    @property
    def island_of(self) -> NDArray[np.int32]: ...


@kind("belief/1")
@dataclass(frozen=True, slots=True)
class Belief:
    """The hypothesis that is likelier than all others of its submap together."""

    pose: Pose2  # the robot in the map
    log_odds: float  # against all others together
    experience: int  # near it, the view of which is most like what is seen
    facing_rad: float  # of the robot, relative to that at which this view was taken


@kind("evidence/1")
class Evidence:
    """The hypotheses, and what speaks for each."""

    def __init__(self, params: EvidenceParams) -> None:
        self.params = params
        self.belief: Belief | None = None
        self.sure = True  # that the robot was carried
        self.known = 0  # experiences among which it is; 0: there is nothing to find out
        self._rows = np.zeros((MOST, 6))
        self._count = 0
        self._units = 0.0  # of way since the last observation

    def begin(self, robot: Pose2, submap: int, known: int, *, sure: bool) -> None:
        """The robot was carried away from this submap, or perhaps not, if not sure. robot: where odometry would have it."""
        self.end(known)
        self.sure, self._units = sure, 1.0  # the first observation counts whole
        self._rows[0] = robot.x, robot.y, robot.heading_rad, PRIOR if sure else 0.0, 1.0, submap
        self._count = 1

    def end(self, known: int = 0) -> None:
        """The robot is on the map again. known: how many experiences there are, if some still lie on other submaps."""
        self.belief, self.known, self._count = None, known, 0

    @property
    def hypotheses(self) -> Rows:
        """x, y (m), heading (rad) in the map, log odds against a new place, units of evidence, submap; shape (n, 6). A view."""
        return self._rows[: self._count]

    def move(self, odometry: Odometry) -> None:
        """The robot moved, and so have all hypotheses."""
        if not self.known:
            return
        way, turn = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        rows = self.hypotheses
        middle = rows[:, HEADING] + turn / 2
        rows[:, X] += way * np.cos(middle)
        rows[:, Y] += way * np.sin(middle)
        rows[:, HEADING] += turn
        self._units = min(1.0, self._units + abs(way) / self.params.unit_m + abs(turn) / self.params.unit_rad)
        if self.belief is not None:
            moved = self.belief.pose.compose(Pose2(way * math.cos(turn / 2), way * math.sin(turn / 2), turn))
            facing = wrap_angle(self.belief.facing_rad + turn)
            self.belief = Belief(moved, self.belief.log_odds, self.belief.experience, facing)

    def observe(self, map_: Map, views: Views, submap: int) -> None:
        """What the local view sees speaks for the hypotheses where it is expected, and against the others.

        submap: where the robot is mapping, which is no hypothesis.
        """
        known = np.where(map_.island_of[: self.known] != submap, map_.views[: self.known], -1)
        among = np.flatnonzero(map_.views >= 0)
        if len(among) < LEAST_VIEWS:
            return
        among = among[:: -(-len(among) // MOST_VIEWS)]
        apart, shifts = views.apart_at(map_.views[among], np.zeros(len(among), np.int64), 2)
        usual = max(float(np.partition(apart, len(apart) // 10)[len(apart) // 10]), 1e-9)
        elsewhere = (among < self.known) & (map_.island_of[among] != submap)
        among, apart, shifts = among[elsewhere], apart[elsewhere], shifts[elsewhere]
        units, self._units = self._units, 0.0
        there = _Expected(map_, views, known, self.hypotheses)
        _weigh(self.hypotheses, there.ring, there.apart / usual, units, self.params.leak)
        best = np.argsort(apart, kind="stable")[:SUGGESTED]
        best = best[apart[best] <= LIKE * usual]
        places = map_.poses[among[best]].copy()
        places[:, 2] += shifts[best] * views.column_rad
        submaps = map_.island_of[among[best]].astype(np.float64)
        self._count = _suggest(self._rows, self._count, places, submaps, apart[best] / usual, max(units, LEAST_PULL))
        self._count = _merge(self._rows, self._count)
        self._believe(map_, views, known)

    def _believe(self, map_: Map, views: Views, known: Whole) -> None:
        self.belief, rows = None, self.hypotheses
        if not len(rows):
            return
        best = int(np.argmax(rows[:, ODDS]))
        row = rows[best : best + 1]
        rivals = (rows[:, SUBMAP] == row[0, SUBMAP]) & (
            np.arange(len(rows)) != best
        )  # one place may lie on two submaps
        odds = float(row[0, ODDS] - np.logaddexp.reduce(np.append(rows[rivals, ODDS], 0.0)))
        if odds <= self.params.believe or row[0, UNITS] < self.params.least_units:
            return
        there = _Expected(map_, views, known, row)
        if there.ring[0] >= 0:
            x, y, heading = row[0, :3].tolist()
            pose = Pose2(x, y, wrap_angle(heading))
            self.belief = Belief(pose, odds, int(there.experience[0]), float(there.facing[0]))


class _Expected:
    """For each hypothesis the view near it that is most like what is seen."""

    def __init__(self, map_: Map, views: Views, known: Whole, rows: Rows) -> None:
        column = views.column_rad
        self.ring, pairs = _near(rows, map_.poses, map_.island_of, known, column)
        owner, which, shift = pairs.T
        apart, by = views.apart_at(known[which], shift, 2)
        self.apart, self.experience, self.facing = (
            np.full(len(rows), np.inf),
            np.full(len(rows), -1),
            np.zeros(len(rows)),
        )
        for k in np.lexsort((apart, owner))[::-1]:  # the last that is written to a hypothesis is the most like
            h = owner[k]
            self.apart[h], self.experience[h], self.facing[h] = apart[k], which[k], by[k] * column


@njit(cache=True, nogil=True)
def _near(rows: Rows, poses: Rows, submaps: NDArray[np.int32], known: Whole, column_rad: float) -> tuple[Whole, Whole]:
    """The ring of each hypothesis, -1 where it has no views; and (hypothesis, experience, shift in columns) of those there."""
    ring = np.full(len(rows), -1, np.int64)
    pairs = np.empty((MOST_PAIRS, 3), np.int64)
    found = 0
    for h in range(len(rows)):
        for r in range(len(RINGS)):
            for i in range(len(known)):
                dx, dy = poses[i, 0] - rows[h, X], poses[i, 1] - rows[h, Y]
                if known[i] < 0 or dx * dx + dy * dy > RINGS[r, 0] ** 2 or submaps[i] != rows[h, SUBMAP]:
                    continue
                turn = (rows[h, HEADING] - poses[i, 2] + math.pi) % (2 * math.pi) - math.pi
                if abs(turn) <= RINGS[r, 1] and found < MOST_PAIRS:
                    pairs[found] = h, i, round(turn / column_rad) if column_rad > 0 else 0
                    found += 1
                    ring[h] = r
            if ring[h] >= 0:
                break
    return ring, pairs[:found]


@njit(cache=True, nogil=True)
def nats(likeness: float, ring: int) -> float:
    """What one unit of evidence says for a place, as the logarithm of the ratio of likelihoods."""
    return min(max(np.interp(likeness, LIKENESS, NATS[ring]), AGAINST), FOR)  # pyright: ignore[reportUnknownArgumentType]


@njit(cache=True, nogil=True)
def _weigh(rows: Rows, ring: Whole, likeness: Rows, units: float, leak: float) -> None:
    for h in range(len(rows)):
        rows[h, ODDS] -= leak * units * max(rows[h, ODDS], 0.0)
        if ring[h] >= 0:
            rows[h, ODDS] += units * nats(likeness[h], ring[h])
            rows[h, UNITS] += units


@njit(cache=True, nogil=True)
def _suggest(rows: Rows, count: int, places: Rows, submaps: Rows, likeness: Rows, units: float) -> int:
    """The best views begin new hypotheses, or say more exactly where old ones are. Returns how many there are."""
    for k in range(len(places)):
        known = False
        for h in range(count):
            dx, dy, turn = _between(rows[h], places[k])
            if rows[h, SUBMAP] == submaps[k] and math.hypot(dx, dy) < PULLS_M and abs(turn) < PULLS_RAD:
                if not known:
                    rows[h, X] += PULL * units * dx
                    rows[h, Y] += PULL * units * dy
                    rows[h, HEADING] += 2 * PULL * units * turn
                known = True
        odds = PRIOR + nats(likeness[k], 0)
        at = count if count < len(rows) else int(np.argmin(rows[:, ODDS]))
        if not known and (at == count or rows[at, ODDS] < odds):
            rows[at, :3], rows[at, ODDS], rows[at, UNITS], rows[at, SUBMAP] = places[k], odds, 1.0, submaps[k]
            count = max(count, at + 1)
    return count


@njit(cache=True, nogil=True)
def _merge(rows: Rows, count: int) -> int:
    """Of hypotheses that have met the likeliest stays; one that is far too unlikely goes. Returns how many are left."""
    rows[:count] = rows[:count][np.argsort(-rows[:count, ODDS], kind="mergesort")]
    left = 0
    for h in range(count):
        alone = rows[h, ODDS] >= FORGOTTEN
        for other in range(left):
            dx, dy, turn = _between(rows[h], rows[other])
            if rows[h, SUBMAP] == rows[other, SUBMAP] and math.hypot(dx, dy) < SAME_M and abs(turn) < SAME_RAD:
                alone = False
        if alone:
            rows[left] = rows[h]
            left += 1
    return left


@njit(cache=True, nogil=True)
def _between(a: Rows, b: Rows) -> tuple[float, float, float]:
    """From one pose to another: m, m, rad."""
    return b[X] - a[X], b[Y] - a[Y], (b[HEADING] - a[HEADING] + math.pi) % (2 * math.pi) - math.pi
