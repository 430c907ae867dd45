"""Local movement: of the arcs that are free now, the one that ends closest to where the robot wants to be. ACRA 2006 4.3.

Obstacles are the sonar echoes of the last seconds, carried along by odometry, so that what slips between two cones is kept.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core import Odometry

MEMORY_TICKS = 30
FARTHEST_M = 1.6  # echoes beyond this are of no concern for the next second
HORIZON_S = 1.2
STEPS = 8  # of an arc
MOST_LEFT = 6  # arcs to the left, and as many to the right
NARROW_M = 0.15  # beyond the clearance an echo costs the less the farther it is, up to here


class LocalMovement:
    """Remembers echoes around the robot and chooses (speed, yaw rate)."""

    def __init__(self, sonar_angles_rad: NDArray[np.float64]) -> None:
        self._angles = np.asarray(sonar_angles_rad, np.float64)
        self._echoes = np.full((MEMORY_TICKS * len(self._angles), 2), np.inf)  # in the robot's frame now
        self._tick = 0

    def forget(self) -> None:
        self._echoes[:] = np.inf

    def sense(self, ranges_m: NDArray[np.float32], odometry: Odometry) -> None:
        """Carry the old echoes along and add the new ones. ranges_m: (8,) from the robot's middle."""
        n = len(self._angles)
        start = self._tick % MEMORY_TICKS * n
        self._tick += 1
        _carry(self._echoes, odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt)
        _place(self._echoes, start, ranges_m, self._angles, FARTHEST_M)

    def towards(self, x: float, y: float, speed: float, turn_rate: float, clearance: float) -> tuple[float, float]:
        """Speed and yaw rate of the free arc that serves best to reach (x, y), metres in the robot's frame."""
        return _best_arc(self._echoes, x, y, speed, turn_rate, clearance)

    def free_way(self, bearing: float, clearance: float) -> float:
        """How far the robot could go straight in this direction, up to FARTHEST_M."""
        return _free_way(self._echoes, bearing, clearance, FARTHEST_M)

    def digest(self) -> bytes:
        return self._echoes.tobytes()


@njit(cache=True, nogil=True)
def _carry(echoes, step, turn):
    c, s = math.cos(turn), math.sin(turn)
    dx, dy = step * math.cos(turn / 2), step * math.sin(turn / 2)
    for k in range(echoes.shape[0]):
        x, y = echoes[k, 0] - dx, echoes[k, 1] - dy
        if x < 1e9:
            echoes[k, 0] = c * x + s * y
            echoes[k, 1] = -s * x + c * y


@njit(cache=True, nogil=True)
def _place(echoes, start, ranges, angles, farthest):
    for k in range(angles.size):
        if ranges[k] < farthest:
            echoes[start + k, 0] = ranges[k] * math.cos(angles[k])
            echoes[start + k, 1] = ranges[k] * math.sin(angles[k])
        else:
            echoes[start + k, :] = np.inf


@njit(cache=True, nogil=True)
def _best_arc(echoes, x, y, speed, turn_rate, clearance):
    """Least (distance left + share of the turn left) over arcs that keep clear; turning on the spot is always free."""
    best, best_v, best_w = np.inf, 0.0, 0.0
    bearing = math.atan2(y, x)
    echoes = _within(echoes, speed * HORIZON_S + clearance + NARROW_M + 0.01)
    facing = _facing(turn_rate)
    for vi in range(4):
        v = speed * (1.0, 0.6, 0.3, 0.0)[vi]
        for wi in range(-MOST_LEFT, MOST_LEFT + 1):
            w = turn_rate * wi / MOST_LEFT
            if v == 0.0 and abs(wi) < 3:
                continue
            px = py = 0.0
            heading = w * (HORIZON_S if v > 0.0 else 0.6)
            nearest = 9.0
            free = True
            if v > 0.0:
                dt = HORIZON_S / STEPS
                for k in range(STEPS):
                    px += v * dt * facing[wi + MOST_LEFT, k, 0]
                    py += v * dt * facing[wi + MOST_LEFT, k, 1]
                    for e in range(echoes.shape[0]):
                        ex, ey = echoes[e, 0] - px, echoes[e, 1] - py
                        d = ex * ex + ey * ey
                        # an echo that is too close already does not forbid to move away from it
                        if d < clearance * clearance and d < echoes[e, 0] ** 2 + echoes[e, 1] ** 2 - 1e-4:
                            free = False
                            break
                        if d < nearest:
                            nearest = d
                    if not free:
                        break
            if not free:
                continue
            left = math.hypot(x - px, y - py)
            aim = math.atan2(y - py, x - px) - heading if left > 0.15 else bearing - heading
            aim = abs(aim - 2 * math.pi * np.round(aim / (2 * math.pi)))
            cost = left + 0.25 * aim + 0.15 * max(0.0, clearance + NARROW_M - math.sqrt(nearest)) / NARROW_M
            if cost < best:
                best, best_v, best_w = cost, v, w
    return best_v, best_w


@njit(cache=True, nogil=True)
def _facing(turn_rate):
    """Cosine and sine of the heading in the middle of each step of each arc."""
    out = np.empty((2 * MOST_LEFT + 1, STEPS, 2))
    for wi in range(-MOST_LEFT, MOST_LEFT + 1):
        for k in range(STEPS):
            heading = turn_rate * wi / MOST_LEFT * (k + 0.5) * HORIZON_S / STEPS
            out[wi + MOST_LEFT, k, 0], out[wi + MOST_LEFT, k, 1] = math.cos(heading), math.sin(heading)
    return out


@njit(cache=True, nogil=True)
def _within(echoes, reach):
    """Those at most so far away, in their order: no other can matter to an arc."""
    out = np.empty_like(echoes)
    n = 0
    for e in range(echoes.shape[0]):
        if echoes[e, 0] * echoes[e, 0] + echoes[e, 1] * echoes[e, 1] <= reach * reach:
            out[n] = echoes[e]
            n += 1
    return out[:n]


@njit(cache=True, nogil=True)
def _free_way(echoes, bearing, clearance, farthest):
    c, s = math.cos(bearing), math.sin(bearing)
    way = farthest
    for e in range(echoes.shape[0]):
        along = c * echoes[e, 0] + s * echoes[e, 1]
        if 0.0 < along < way + clearance and abs(-s * echoes[e, 0] + c * echoes[e, 1]) < clearance:
            way = min(way, max(0.0, along - clearance))
    return way
