"""Local movement: of the arcs that are free, the robot takes the one that ends closest to its target. ACRA 2006 4.3.

Obstacles are the sonar echoes of the last seconds, moved along by odometry. An obstacle that slips between two cones is
thus not forgotten. For people who look, all arcs can be told (`candidates`, figure 4); the robot needs only the best.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from app.pilot.params import PilotParams
from disk import kind
from ratslam_core import Odometry
from ratslam_core.beats import BEAT_S, Beats

ECHO_RANGE_M = 1.6  # echoes from farther away are ignored
ARC_S, SPOT_S = 1.2, 0.6  # time over which an arc (D 4.3), and a turn on the spot, is planned ahead
ARC_STEPS = 8  # points on an arc that are tested for clearance
ARCS = 6  # tried to each side at each speed
SHARES = (1.0, 0.6, 0.3, 0.0)  # of the cruise speed that are tried; the last: turns on the spot ...
SPOT_SHARE = 0.5  # ... of which the slowest is this share of the turn rate
TURN_COST = 0.25  # m/rad, of the angle left to turn at the end of an arc
BEARING_M = 0.15  # nearer to its target, an arc is judged by the bearing from the robot, not from the arc's end
NARROW_M = 0.15  # margin beyond the clearance in which an echo costs, less the farther away it is ...
NARROW_COST = 0.15  # m, of one exactly at the clearance
ESCAPE_M2 = 1e-4  # on the way out, the squared distance of an echo that is too close may shrink by this much
GAP_RAD, GAP_STEPS = 1.4, 8  # how far beside the next point a gap is looked for, in so many steps to each side
GAP_COST = 0.3  # m/rad: free way that a turn from the point's direction is worth
SQUEEZE = 0.85  # of the clearance is kept where the robot does not get out: echoes are some centimetres off

_Array = NDArray[np.float64]  # (n, 2): points in the robot's frame, m


class Choice(NamedTuple):
    """The parameters that compiled code needs."""

    speed: float
    turn_rate: float
    clearance: float
    facing: NDArray[np.float64]  # of `_facing_of` this turn rate


@kind("local movement/3")
class LocalMovement:
    """Remembers echoes around the robot and chooses (speed m/s, yaw rate rad/s)."""

    CACHES = ("_choice", "_asked")

    def __init__(self, sonar_angles_rad: NDArray[np.float64], echo_s: float) -> None:
        """sonar_angles_rad: (8,) from left to right, positive to the left. echo_s: how long echoes are remembered, s.

        One scan of each beat is remembered, its last.
        """
        self._angles = np.asarray(sonar_angles_rad, np.float64)
        self._scans = max(1, round(echo_s / BEAT_S))
        self._echoes = np.full((self._scans * len(self._angles), 2), np.inf)  # in the robot's frame now
        self._beats, self._beat = Beats(), -1
        self.squeezes = False  # it passes closer to what is around it
        self._choice: tuple[PilotParams, bool, Choice] | None = None
        self._asked: tuple[float, float, Choice] | None = None  # since it last sensed, for people who look

    def forget(self) -> None:
        self._echoes[:] = np.inf

    @property
    def aslant(self) -> float:
        """The distance of a wall along the left side, divided by the range of the second sonar from the left."""
        return math.cos(self._angles[0] - self._angles[1])

    def sense(self, ranges_m: NDArray[np.float32], odometry: Odometry) -> None:
        """Move the old echoes into the robot's new frame and add the new ones. ranges_m: (8,) from its middle."""
        n, passed = len(self._angles), self._beats.take(odometry).beats
        for beat in range(self._beat + 1, self._beat + min(passed, self._scans)):
            start = beat % self._scans * n
            self._echoes[start : start + n] = np.inf  # no scan was made in it
        self._beat += passed
        start = self._beat % self._scans * n
        self._asked = None
        moved, turned = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        _sense(self._echoes, moved, turned, start, ranges_m, self._angles, ECHO_RANGE_M)

    def towards(self, x: float, y: float, p: PilotParams) -> tuple[float, float]:
        """Speed and yaw rate of the free arc that costs least on the way to (x, y), metres in the robot's frame."""
        self._asked = asked = x, y, self._chosen_by(p)
        return _best_arc(self._echoes, *asked)

    @property
    def asked(self) -> tuple[_Array, float, float, Choice] | None:
        """What `candidates` needs to tell about the choice in this tick, as copies; None: there was none."""
        return None if self._asked is None else (self._echoes.copy(), *self._asked)

    def free_way(self, bearing: float, p: PilotParams) -> float:
        """How far (m) the robot can drive straight in this direction (rad) before it is too close to an echo."""
        return _free_way(self._echoes, bearing, self._chosen_by(p).clearance, ECHO_RANGE_M)

    def gap_towards(self, x: float, y: float, p: PilotParams) -> tuple[float, float]:
        """[ours] (x, y), or if echoes are in the way, a point in the freest direction beside it. Metres, robot's frame.

        The map may be off by half a door. test_local_movement.py::test_the_gap_beside_the_point_is_headed_for.
        """
        want = min(math.hypot(x, y), p.gap_m)
        bearing = math.atan2(y, x)
        if want <= 0 or self.free_way(bearing, p) >= want:
            return x, y
        clearance = self._chosen_by(p).clearance
        better = _freest(self._echoes, bearing, want, clearance, GAP_RAD / GAP_STEPS, GAP_STEPS, GAP_COST)
        return want * math.cos(better), want * math.sin(better)

    def _chosen_by(self, p: PilotParams) -> Choice:
        """The same object for the same parameters, since it is needed in every tick."""
        if self._choice is None or self._choice[:2] != (p, self.squeezes):
            clearance = p.clearance * (SQUEEZE if self.squeezes else 1.0)
            self._choice = p, self.squeezes, Choice(p.cruise_speed, p.turn_rate, clearance, _facing_of(p.turn_rate))
        return self._choice[2]


@njit(cache=True, nogil=True)
def _sense(
    echoes: _Array, step: float, turn: float, start: int, ranges: NDArray[np.float32], angles: _Array, farthest: float
) -> None:
    _carry(echoes, step, turn)
    _place(echoes, start, ranges, angles, farthest)


@njit(cache=True, nogil=True)
def _carry(echoes: _Array, step: float, turn: float) -> None:
    c, s = math.cos(turn), math.sin(turn)
    dx, dy = step * math.cos(turn / 2), step * math.sin(turn / 2)
    for k in range(echoes.shape[0]):
        x, y = echoes[k, 0] - dx, echoes[k, 1] - dy
        if x < np.inf:
            echoes[k, 0] = c * x + s * y
            echoes[k, 1] = -s * x + c * y


@njit(cache=True, nogil=True)
def _place(echoes: _Array, start: int, ranges: NDArray[np.float32], angles: _Array, farthest: float) -> None:
    for k in range(angles.size):
        if ranges[k] < farthest:
            echoes[start + k, 0] = ranges[k] * math.cos(angles[k])
            echoes[start + k, 1] = ranges[k] * math.sin(angles[k])
        else:
            echoes[start + k, :] = np.inf


@njit(cache=True, nogil=True)
def _free_way(echoes: _Array, bearing: float, clearance: float, farthest: float) -> float:
    c, s = math.cos(bearing), math.sin(bearing)
    way = farthest
    for e in range(echoes.shape[0]):
        along = c * echoes[e, 0] + s * echoes[e, 1]
        if 0.0 < along < way + clearance and abs(-s * echoes[e, 0] + c * echoes[e, 1]) < clearance:
            way = min(way, max(0.0, along - clearance))
    return way


@njit(cache=True, nogil=True)
def _freest(
    echoes: _Array, bearing: float, want: float, clearance: float, step: float, steps: int, cost: float
) -> float:
    """The direction (rad), up to `steps` steps (rad) from this one, with most free way up to `want` less its cost."""
    best, chosen = -np.inf, bearing
    for k in range(2 * steps + 1):
        turn = (k + 1) // 2 * step * (1 if k % 2 else -1)
        worth = _free_way(echoes, bearing + turn, clearance, want) - cost * abs(turn)
        if worth > best:
            best, chosen = worth, bearing + turn
    return chosen


@njit(cache=True, nogil=True)
def _best_arc(echoes: _Array, x: float, y: float, p: Choice) -> tuple[float, float]:
    """Speed and yaw rate of the cheapest arc that keeps clear of all echoes; a turn on the spot is always clear."""
    best, best_v, best_w = np.inf, 0.0, 0.0
    near = _within(echoes, p.speed * ARC_S + p.clearance + 2 * NARROW_M)  # generously
    for share in SHARES:
        v = p.speed * share
        for wi in range(-ARCS, ARCS + 1):
            if v == 0.0 and abs(wi) < SPOT_SHARE * ARCS:
                continue
            w, step = p.turn_rate * wi / ARCS, v * (ARC_S / ARC_STEPS)
            px, py = _end_of(step, p.facing[wi + ARCS])
            turned = w * (ARC_S if v > 0.0 else SPOT_S)
            if _cost_of(x, y, px, py, turned, np.inf, p) >= best:
                continue  # nor is it the best with an echo near it
            nearest, free = _along(near, step, p.facing[wi + ARCS], p)
            cost = _cost_of(x, y, px, py, turned, nearest, p)
            if free and cost < best:
                best, best_v, best_w = cost, v, w
    return best_v, best_w


@dataclass(frozen=True, slots=True)
class Candidates:
    """The n arcs that the robot tried, in its frame and in the order in which it did. ACRA 2006, figure 4."""

    paths: NDArray[np.float64]  # (n, steps + 1, 2) m, from the robot's middle to the arc's end; a turn stays at a point
    turned_rad: NDArray[np.float64]  # (n,) between beginning and end
    length_m: NDArray[np.float64]  # (n,) of each path
    speed: NDArray[np.float64]  # (n,) m/s; 0 for a turn on the spot
    yaw_rate: NDArray[np.float64]  # (n,) rad/s
    cost: NDArray[np.float64]  # (n,) m; inf where an echo is too close

    @property
    def chosen(self) -> int:
        """The first of the cheapest, as the robot chooses."""
        return int(np.argmin(self.cost))


def candidates(echoes: _Array, x: float, y: float, p: Choice) -> Candidates:
    """All that `LocalMovement.towards` tries on the way to (x, y), with the same numbers.

    echoes: (n, 2) m, robot's frame. test_candidates.py::test_the_cheapest_candidate_is_the_one_that_was_chosen.
    """
    near = _within(echoes, p.speed * ARC_S + p.clearance + 2 * NARROW_M)
    rows: list[tuple[float, float, float, float]] = []
    paths: list[NDArray[np.float64]] = []
    for share in SHARES:
        v = p.speed * share
        for wi in range(-ARCS, ARCS + 1):
            if v == 0.0 and abs(wi) < SPOT_SHARE * ARCS:
                continue
            w, step = p.turn_rate * wi / ARCS, v * (ARC_S / ARC_STEPS)
            px, py = _end_of(step, p.facing[wi + ARCS])
            nearest, free = _along(near, step, p.facing[wi + ARCS], p)
            turned = w * (ARC_S if v > 0.0 else SPOT_S)
            rows.append((turned, v, w, _cost_of(x, y, px, py, turned, nearest, p) if free else np.inf))
            paths.append(np.vstack([np.zeros((1, 2)), np.cumsum(step * p.facing[wi + ARCS], axis=0)]))
    turned_rad, speed, yaw_rate, cost = np.array(rows).T
    return Candidates(np.array(paths), turned_rad, speed * ARC_S, speed, yaw_rate, cost)


@njit(cache=True, nogil=True)
def _end_of(step: float, facing: _Array) -> tuple[float, float]:
    """Where an arc ends (m), robot's frame."""
    px = py = 0.0
    for k in range(ARC_STEPS):
        px += step * facing[k, 0]
        py += step * facing[k, 1]
    return px, py


@njit(cache=True, nogil=True)
def _along(near: tuple[_Array, _Array], step: float, facing: _Array, p: Choice) -> tuple[float, bool]:
    """The squared distance (m²) of the echo nearest to an arc, and whether it keeps clear of all; a turn on the spot does.

    near: from `_within`. All echoes are compared at once, without a branch, so that the compiler can vectorise.
    """
    if step == 0.0:
        return np.inf, True
    px = py = 0.0
    places, limits = near
    x, y, limit, least = places[0], places[1], limits[0], limits[1]
    least[:] = np.inf
    for k in range(ARC_STEPS):
        px += step * facing[k, 0]
        py += step * facing[k, 1]
        too_close = 0
        for e in range(x.size):
            ex, ey = x[e] - px, y[e] - py
            d = ex * ex + ey * ey
            too_close += (d < p.clearance * p.clearance) & (d < limit[e])
            least[e] = d if d < least[e] else least[e]
        if too_close > 0:
            return np.inf, False
    nearest = np.inf
    for d in least:
        nearest = min(nearest, d)
    return nearest, True


@njit(cache=True, nogil=True)
def _cost_of(x: float, y: float, px: float, py: float, heading: float, nearest: float, p: Choice) -> float:
    """Cost in metres: distance left from the arc's end to (x, y), angle left to turn, and passing close to an echo."""
    left = math.hypot(x - px, y - py)
    aim = math.atan2(y - py, x - px) - heading if left > BEARING_M else math.atan2(y, x) - heading
    aim = abs(aim - 2 * math.pi * np.round(aim / (2 * math.pi)))
    close = max(0.0, p.clearance + NARROW_M - math.sqrt(nearest)) / NARROW_M
    return left + TURN_COST * aim + NARROW_COST * close


def _facing_of(turn_rate: float) -> NDArray[np.float64]:
    """Cosine and sine of the heading in the middle of each step of each arc, (arcs, steps, 2)."""
    out = np.empty((2 * ARCS + 1, ARC_STEPS, 2))
    for wi in range(-ARCS, ARCS + 1):
        for k in range(ARC_STEPS):
            heading = turn_rate * wi / ARCS * (k + 0.5) * ARC_S / ARC_STEPS
            out[wi + ARCS, k, 0], out[wi + ARCS, k, 1] = math.cos(heading), math.sin(heading)
    return out


@njit(cache=True, nogil=True)
def _within(echoes: _Array, reach: float) -> tuple[_Array, _Array]:
    """The echoes within `reach`, in their order, (2, n); no other can matter to an arc.

    And in (2, n) how near (m²) an arc must come to count as too close, since an echo that is already too close does
    not forbid an arc that leads away from it, and a row for `_along` to write in.
    """
    places, limits = np.empty((2, len(echoes))), np.empty((2, len(echoes)))
    n = 0
    for e in range(echoes.shape[0]):
        away = echoes[e, 0] * echoes[e, 0] + echoes[e, 1] * echoes[e, 1]
        if away <= reach * reach:
            places[0, n], places[1, n] = echoes[e, 0], echoes[e, 1]
            limits[0, n] = away - ESCAPE_M2
            n += 1
    return places[:, :n].copy(), limits[:, :n].copy()  # rows without gaps, or the compiler cannot vectorise
