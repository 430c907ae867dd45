"""[ours] One law of evidence: where a robot is that may be elsewhere than it believes, and how sure that is.

Hypotheses of where the robot is move by its odometry, as packets do, and each observation weighs them. How like the
views near a hypothesis are to what is seen, in units of how like views are anyway, tells how many times likelier this
observation is there than at a wrong place that looked right a metre before: `NATS`, beside its fit of today in
`python -m benchmarks.evidence fit`. Neighbouring observations repeat each other, so a metre or a radian of way counts as one
unit of evidence; and since wrong places can stay alike for longer, a unit takes a share of what was gathered away.
Beside all hypotheses stands that of a new place, for and against which nothing speaks.

A robot that noticed that it was carried may be anywhere. One whose observation lies outside the validation gate, or whose
alarm may be false, is in doubt: *here*, where odometry has led it, is a rival, too, if what is seen there speaks against
it; what lies farther off than odometry can have drifted begins with odds against it, at most those of having been carried
unnoticed; and since an exact copy of a place may exist, observations say no more than MOST_SAID. So in a twin odometry
decides, where observations cannot. The doubt is over when nothing has spoken for another place for a while, and none
is likelier than *here*.

A corridor that was driven twice lies on the map twice, a little apart, until something closes that loop. So what is near a
hypothesis is the same place, no rival, and what is seen *here* as well says nothing against there.

The robot *believes* a hypothesis that is likelier than all others together. There it acts; nothing is learnt from it, so
that it may be wrong at no cost. Where the odds are 1000 to 1, the submap on which it was is *merged*. test_evidence.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.params import EvidenceParams
from ratslam_core.parts import GeometricVerification, LocalViewPart
from ratslam_core.pose_graph.transitions import moved_by
from ratslam_core.types import Flags, Floats, Ints, Ints32, Odometry, Pose2, wrap_angle, wrap_angles

MOST = 32  # hypotheses
UNIT, UNIT_RAD = 4.0, 1.0  # cells; so long a way, or so wide a turn, is one unit of evidence
LEAK = 0.2  # share of the evidence for a hypothesis that a unit takes away
LEAST_SEEN = 1.5  # units that a hypothesis needs to be believed
MOST_SAID = 14.0  # nats that observations can say for a place, since an exact copy of it may exist
LEAST_VIEWS = 10  # of fewer views nobody can say how like views are anyway
MOST_VIEWS = 2048  # that are compared with an observation; of more, every second, third ... one
MOST_PAIRS = 4096  # of a hypothesis and a view near it
SUGGESTED = 4  # best views of all that say where the robot may be
LIKE = 0.8  # a less like view suggests nothing
PRIOR = -2.0  # log odds of a place that a view suggests, against a new place
FORGOTTEN = PRIOR - 4.0  # log odds below which a hypothesis is given up
DOUBTED = 15.0  # and, while in doubt, how far they may lie below the likeliest's
QUIET = 5.0  # units of way after which a doubt is over for which nothing has spoken, unless another place is likelier
ONE_PLACE, ONE_PLACE_RAD = 4.0, 0.6  # cells; the same place, which a map has twice until its loops are closed
BELIEVE_IN_DOUBT = 3.0  # nats: who was hardly carried must not wander off in thought for perceptual aliasing
SAME, SAME_RAD = 2.4, 0.3  # cells; hypotheses this near are one
PULLS, PULLS_RAD = 2.8, 0.35  # cells; a view this near to a hypothesis says more exactly where it is
PULL = 0.3  # the share of that way which it goes for a unit of evidence
LEAST_PULL = 0.15
LEAST_UNITS = 0.1  # of way after which it pays to look again, for a robot in doubt; one that is lost looks all the time
AGAINST, FOR = -2.0, 7.0  # nats that one unit of evidence can say at most
# The likeness: the least difference to a view near the hypothesis, over the tenth of all differences that is least.
LIKENESS: Floats = np.array([0.2, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95, 1.05, 1.2])
# What that says, in nats, by how near views there are: within so many cells and radians. The nearest that there are count.
RINGS: Floats = np.array([(2.0, 0.3), (2.0, 0.52), (4.0, 0.3)])
NATS: Floats = np.array(
    [
        [5.8, 4.2, 2.7, 1.3, -0.4, -1.7, -2.5, -2.9, -3.1, -3.1],
        [4.3, 4.3, 3.3, 2.4, 1.1, -0.3, -1.1, -1.7, -1.9, -2.2],
        [3.2, 3.2, 2.9, 2.1, 1.1, 0.2, -0.4, -0.9, -1.2, -1.4],
    ]
)
# What echoes say in a unit of evidence, by how far apart (m) they are from those of the place, at wrong ones that had agreed.
APART_M: Floats = np.array([0.07, 0.10, 0.13, 0.16, 0.20, 0.25])
APART_NATS: Floats = np.array([1.5, 0.7, 0.0, -0.5, -1.0, -1.5])
MOST_UNHEARD = 2.0  # units for which echoes count at once
X, Y, HEADING, ODDS, UNITS, SUBMAP, CEILING = range(7)  # of a row


class Map(Protocol):
    """What has to be known of the experience map."""

    cell_m: float

    @property
    def poses(self) -> Floats: ...
    @property
    def views(self) -> Ints: ...
    @property
    def submap_of(self) -> Ints32: ...
    @property
    def robot_here(self) -> Pose2: ...
    @property
    def log_prior_of_new(self) -> float: ...
    def log_prior(self, experience: int, pose: Pose2, /) -> float: ...


@kind("belief/1")
@dataclass(frozen=True, slots=True)
class Belief:
    """The hypothesis that is likelier than all others of its submap together."""

    pose: Pose2  # the robot in the map
    log_odds: float  # against all others together
    experience: int  # near it, the view of which is most like what is seen
    facing_rad: float  # of the robot, relative to that at which this view was taken


@kind("evidence/5")
class Evidence:
    """The hypotheses, and what speaks for each."""

    def __init__(self, params: EvidenceParams, cell_m: float) -> None:
        """cell_m: side of a cell of the pose cells."""
        self.params, self.cell_m = params, cell_m
        self.belief: Belief | None = None
        self.in_doubt = False  # it knows of no kidnap, but saw something where it cannot be
        self.here = 0.0  # log odds that the robot is where odometry has led it, while in doubt
        self.known = 0  # experiences among which it is; 0: there is nothing to find out
        self._rows = np.zeros((MOST, 7))
        self._count = 0
        self._units = 0.0  # of way since the last observation
        self._unheard = 0.0  # and since echoes were last asked
        self._quiet = 0.0  # units of way since something was last seen where the robot cannot be

    def begin(self, robot: Pose2, submap: int, known: int) -> None:
        """The robot was carried away from this submap. robot: where odometry would have it."""
        self.end(known)
        self._units = 1.0  # the first observation counts whole
        self._rows[0] = robot.x, robot.y, robot.heading_rad, PRIOR, 1.0, submap, math.inf
        self._count = 1

    def doubt(self, known: int) -> None:
        """Something is seen where the robot cannot be. known: how many experiences there are, from before the doubt."""
        if not self.in_doubt:
            self.end(known)
            self.in_doubt, self.here, self._units = True, 0.0, 1.0
        self._quiet = 0.0

    def disprove(self, map_: Map, submap: int) -> None:
        """The robot is not where odometry has led it, and no longer maps there; all that was said stays."""
        here = map_.robot_here
        place = np.array([here.x, here.y, here.heading_rad])
        self._count = _begin(self._rows, self._count, place, self.here, submap, math.inf)
        self.in_doubt = False

    def end(self, known: int = 0) -> None:
        """The robot is on the map again. known: how many experiences there are, if some still lie on other submaps."""
        self.belief, self.known, self._count, self.in_doubt = None, known, 0, False

    @property
    def hypotheses(self) -> Floats:
        """x, y (m), heading (rad) in the map, log odds against a new place, units of evidence, submap, most log odds; (n, 7)."""
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
        units = abs(way) / (UNIT * self.cell_m) + abs(turn) / UNIT_RAD
        self._units, self._quiet = min(1.0, self._units + units), self._quiet + units
        if self.belief is not None:
            moved, facing = self.belief.pose.compose(moved_by(odometry)), wrap_angle(self.belief.facing_rad + turn)
            self.belief = Belief(moved, self.belief.log_odds, self.belief.experience, facing)

    def observe(
        self, map_: Map, views: LocalViewPart, submap: int, verification: GeometricVerification | None = None
    ) -> None:
        """What the local view sees speaks for the hypotheses where it is expected, and against the others.

        submap: where the robot is mapping, which is no hypothesis unless it is in doubt. verification: another sense, which
        speaks for and against them, too.
        """
        among = np.flatnonzero(map_.views >= 0)
        if len(among) < LEAST_VIEWS or (self.in_doubt and self._units < LEAST_UNITS):
            return
        among = among[:: -(-len(among) // MOST_VIEWS)]
        apart, shifts = views.apart_at(map_.views[among], np.zeros(len(among), np.int64), 2)
        usual = max(float(np.partition(apart, len(apart) // 10)[len(apart) // 10]), 1e-9)
        possible = np.arange(len(map_.views)) < self.known
        if not self.in_doubt:
            possible &= map_.submap_of != submap
        known = np.where(possible, map_.views, -1)[: self.known]
        units, self._units = self._units, 0.0
        self._weigh(map_, views, known, usual, units, submap)
        like = possible[among] & (apart <= LIKE * usual)
        among, apart, shifts = among[like], apart[like], shifts[like]
        best = np.argsort(apart, kind="stable")[:SUGGESTED]
        facing: Floats = shifts[best] * np.float64(views.column_rad)
        self._suggest(map_, among[best], facing, apart[best] / usual, max(units, LEAST_PULL))
        self._unheard += units
        if verification is not None and self._unheard >= 1.0:
            self._hear(map_, verification)
        least = max(self.here, *self.hypotheses[:, ODDS], 0.0) - DOUBTED if self.in_doubt else FORGOTTEN
        self._count = _merge(self._rows, self._count, least, self.cell_m)
        self._believe(map_, views, known)

    def _weigh(self, map_: Map, views: LocalViewPart, known: Ints, usual: float, units: float, submap: int) -> None:
        there = _Expected(map_, views, known, self.hypotheses)
        _weigh(self.hypotheses, there.ring, there.apart / usual, units)
        if self.in_doubt:
            here = _row(map_.robot_here, self.here, submap)
            there = _Expected(map_, views, known, here)
            there.ring[there.ring > 0] = -1  # who explores is beside known ground all the time, perhaps behind its wall
            _weigh(here, there.ring, there.apart / usual, units)
            self.here = float(here[0, ODDS])

    def _hear(self, map_: Map, verification: GeometricVerification) -> None:
        """Echoes say how like each hypothesis is to the place that it claims, and where exactly that is.

        test_evidence.py::test_echoes_say_which_of_two_places_it_is_and_where.
        """
        units, self._unheard = min(self._unheard, MOST_UNHEARD), 0.0
        reach_m = ONE_PLACE * self.cell_m
        nearest = _beside(self.hypotheses, map_.poses[: self.known], map_.submap_of[: self.known], reach_m)
        for h in np.flatnonzero(nearest >= 0):
            row, place = self.hypotheses[h], Pose2(*map_.poses[nearest[h]].tolist())
            observation = place.inverse().compose(Pose2(*row[:3].tolist()))
            found = verification.match(map_, int(nearest[h]), observation)
            if found is None:
                continue
            row[ODDS] = min(row[ODDS] + units * float(np.interp(found.apart_m, APART_M, APART_NATS)), row[CEILING])
            if found.sigma_m < SAME / 2 * self.cell_m:
                there = place.compose(found.pose)
                row[[X, Y, HEADING]] = there.x, there.y, there.heading_rad

    def _suggest(self, map_: Map, experiences: Ints, facing: Floats, likeness: Floats, units: float) -> None:
        """The best views say more exactly where old hypotheses are, or begin new ones."""
        places = map_.poses[experiences].copy()
        places[:, 2] += facing
        submaps = map_.submap_of[experiences].astype(np.float64)
        known = _pull(self.hypotheses, places, submaps, units, self.cell_m)
        for k in np.flatnonzero(~known):
            prior = map_.log_prior(int(experiences[k]), Pose2(*places[k].tolist()))
            odds = prior + nats(likeness[k], 0)
            self._count = _begin(self._rows, self._count, places[k], odds, submaps[k], prior + MOST_SAID)

    def weighed(self, map_: Map) -> tuple[Floats, list[float]]:
        """The hypotheses of another place than where the robot maps, (n, 7), and the log odds of all that stands beside them."""
        rows = self.hypotheses
        if not self.in_doubt:
            return rows, [0.0]
        here = self._same_place(rows, map_.robot_here)
        # What is seen here, too, says nothing against there: they may be two passes of one place.
        return rows[~here], [*np.minimum([self.here, *rows[here, ODDS]], 0.0).tolist(), map_.log_prior_of_new]

    def _believe(self, map_: Map, views: LocalViewPart, known: Ints) -> None:
        self.belief = None
        rows, beside = self.weighed(map_)
        if not len(rows):
            return
        best = int(np.argmax(rows[:, ODDS]))
        row = rows[best : best + 1]
        # One place may lie on two submaps, or twice on one.
        rivals = (rows[:, SUBMAP] == row[0, SUBMAP]) & ~self._same_place(rows, Pose2(*row[0, :3].tolist()))
        odds = float(row[0, ODDS] - np.logaddexp.reduce(np.append(rows[rivals, ODDS], beside)))
        least = BELIEVE_IN_DOUBT if self.in_doubt else self.params.believe
        if odds <= least or row[0, UNITS] < LEAST_SEEN:
            return
        there = _Expected(map_, views, known, row)
        if there.ring[0] >= 0:
            x, y, heading = row[0, :3].tolist()
            pose = Pose2(x, y, wrap_angle(heading))
            self.belief = Belief(pose, odds, int(there.experience[0]), float(there.facing[0]))

    def _same_place(self, rows: Floats, pose: Pose2) -> Flags:
        """Which hypotheses, (n, 7), are about there: none of them is a rival of another."""
        turn = np.abs(wrap_angles(rows[:, HEADING] - pose.heading_rad))
        return (np.hypot(rows[:, X] - pose.x, rows[:, Y] - pose.y) < ONE_PLACE * self.cell_m) & (turn < ONE_PLACE_RAD)

    def over(self, map_: Map) -> bool:
        """Whether the doubt is over: nothing has spoken for another place for long, and none is likelier than *here*."""
        if not self.in_doubt or self._quiet <= QUIET:
            return False
        rows = self.hypotheses
        here = self._same_place(rows, map_.robot_here)
        return max(self.here, rows[here, ODDS].max(initial=-math.inf)) >= rows[~here, ODDS].max(initial=-math.inf)


def _row(pose: Pose2, odds: float, submap: int) -> Floats:
    return np.array([[pose.x, pose.y, pose.heading_rad, odds, 1.0, submap, math.inf]], np.float64)


class _Expected:
    """For each hypothesis the view near it that is most like what is seen."""

    def __init__(self, map_: Map, views: LocalViewPart, known: Ints, rows: Floats) -> None:
        column = views.column_rad
        self.ring, pairs = _near(rows, map_.poses, map_.submap_of, known, column, map_.cell_m)
        owner, which, shift = pairs.T
        apart, by = views.apart_at(known[which], shift, 2)
        self.apart, self.experience, by = _least(len(rows), owner, which, apart, by)
        self.facing = by * column


@njit(cache=True, nogil=True)
def _least(rows: int, owner: Ints, which: Ints, apart: Floats, by: Ints) -> tuple[Floats, Ints, Ints]:
    """For each hypothesis how unlike the most alike of its views is, which experience has it, and at which shift."""
    least, experience, shift = np.full(rows, np.inf), np.full(rows, -1), np.zeros(rows, np.int64)
    for k in range(len(owner)):
        h = owner[k]
        if apart[k] < least[h]:
            least[h], experience[h], shift[h] = apart[k], which[k], by[k]
    return least, experience, shift


@njit(cache=True, nogil=True)
def _near(
    rows: Floats, poses: Floats, submaps: Ints32, known: Ints, column_rad: float, cell_m: float
) -> tuple[Ints, Ints]:
    """The ring of each hypothesis, -1 where it has no views; and (hypothesis, experience, shift in columns) of those there."""
    ring = np.full(len(rows), -1, np.int64)
    pairs = np.empty((MOST_PAIRS, 3), np.int64)
    found = 0
    for h in range(len(rows)):
        for r in range(len(RINGS)):
            for i in range(len(known)):
                dx, dy = poses[i, 0] - rows[h, X], poses[i, 1] - rows[h, Y]
                if known[i] < 0 or dx * dx + dy * dy > (RINGS[r, 0] * cell_m) ** 2 or submaps[i] != rows[h, SUBMAP]:
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
def _beside(rows: Floats, poses: Floats, submaps: Ints32, reach_m: float) -> Ints:
    """For each hypothesis the nearest experience of its submap within reach, -1 for none."""
    nearest = np.full(len(rows), -1, np.int64)
    for h in range(len(rows)):
        least = reach_m * reach_m
        for i in range(len(poses)):
            dx, dy = poses[i, 0] - rows[h, X], poses[i, 1] - rows[h, Y]
            if submaps[i] == rows[h, SUBMAP] and dx * dx + dy * dy < least:
                least, nearest[h] = dx * dx + dy * dy, i
    return nearest


@njit(cache=True, nogil=True)
def nats(likeness: float, ring: int) -> float:
    """What one unit of evidence says for a place, as the logarithm of the ratio of likelihoods."""
    return min(max(np.interp(likeness, LIKENESS, NATS[ring]), AGAINST), FOR)  # pyright: ignore[reportUnknownArgumentType]


@njit(cache=True, nogil=True)
def _weigh(rows: Floats, ring: Ints, likeness: Floats, units: float) -> None:
    for h in range(len(rows)):
        rows[h, ODDS] -= LEAK * units * max(rows[h, ODDS], 0.0)
        if ring[h] >= 0:
            rows[h, ODDS] = min(rows[h, ODDS] + units * nats(likeness[h], ring[h]), rows[h, CEILING])
            rows[h, UNITS] += units


@njit(cache=True, nogil=True)
def _pull(rows: Floats, places: Floats, submaps: Floats, units: float, cell_m: float) -> Flags:
    """Suggested places say more exactly where the hypotheses near them are. Returns near which of them there is one."""
    known = np.zeros(len(places), np.bool_)
    for k in range(len(places)):
        for h in range(len(rows)):
            dx, dy, turn = _between(rows[h], places[k])
            if rows[h, SUBMAP] == submaps[k] and math.hypot(dx, dy) < PULLS * cell_m and abs(turn) < PULLS_RAD:
                if not known[k]:
                    rows[h, X] += PULL * units * dx
                    rows[h, Y] += PULL * units * dy
                    rows[h, HEADING] += 2 * PULL * units * turn
                known[k] = True
    return known


def _begin(rows: Floats, count: int, place: Floats, odds: float, submap: float, ceiling: float) -> int:
    """A new hypothesis, in the place of the least likely if there is no room, unless it is less likely. Returns how many."""
    at = count if count < len(rows) else int(np.argmin(rows[:, ODDS]))
    if at == count or rows[at, ODDS] < odds:
        rows[at] = *place, odds, 1.0, submap, ceiling
        count = max(count, at + 1)
    return count


@njit(cache=True, nogil=True)
def _merge(rows: Floats, count: int, least: float, cell_m: float) -> int:
    """Of hypotheses that have met the likeliest stays; one that is far too unlikely goes. Returns how many are left."""
    rows[:count] = rows[:count][np.argsort(-rows[:count, ODDS], kind="mergesort")]
    left = 0
    for h in range(count):
        alone = rows[h, ODDS] >= least
        for other in range(left):
            dx, dy, turn = _between(rows[h], rows[other])
            if rows[h, SUBMAP] == rows[other, SUBMAP] and math.hypot(dx, dy) < SAME * cell_m and abs(turn) < SAME_RAD:
                alone = False
        if alone:
            rows[left] = rows[h]
            left += 1
    return left


@njit(cache=True, nogil=True)
def _between(a: Floats, b: Floats) -> tuple[float, float, float]:
    """From one pose to another: m, m, rad."""
    return b[X] - a[X], b[Y] - a[Y], (b[HEADING] - a[HEADING] + math.pi) % (2 * math.pi) - math.pi
