"""Exploring: left-wall following, turning back to look, crossings. IROS 2005 section IV.D.

[ours] Wall following alone never enters the middle of a room, so now and then the robot crosses it in a random direction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from app.pilot.local_movement import LocalMovement
from app.pilot.params import PilotParams
from ratslam_core import Odometry, wrap_angle

LOOK_BACK_M = 1.0


@dataclass(slots=True)
class _Turn:
    """Turn on the spot until so many radians are left."""

    left: float


class Explorer:
    """Proposes (speed, yaw rate) for each tick and says what it is doing."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._begin_following()
        self._way = 0.0
        self._clock = 0.0
        self._cross_in_s = math.inf  # of wall following; looking back does not put it off

    @property
    def doing(self) -> str:
        return {"follow": "following the wall", "cross": "crossing", "look": "turning back to look"}[self._state]

    def digest(self) -> bytes:
        turn = self._turn.left if self._turn else math.nan
        return repr((self._state, turn, self._stage, self._way, self._clock, self._until, self._cross_in_s)).encode()

    def begin_crossing(self) -> None:
        """Turn to a random direction and go."""
        self._state, self._turn, self._stage = "cross", _Turn(float(self._rng.uniform(-math.pi, math.pi))), 0
        self._clock, self._until = 0.0, float(self._rng.uniform(6.0, 20.0))
        self._cross_in_s = math.inf

    def step(self, ranges_m, odometry: Odometry, local: LocalMovement, p: PilotParams) -> tuple[float, float]:
        """ranges_m: (8,) sonars from left to right."""
        moved, turned = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        self._clock += odometry.dt
        self._way += abs(moved)
        if self._turn is not None:
            self._turn.left -= turned
            if abs(self._turn.left) > 0.15 and self._clock < 12.0:
                return 0.0, math.copysign(p.turn_rate, self._turn.left)
            self._turn, self._clock = None, 0.0
        if self._state == "look":
            return self._look(moved, local, p)
        if self._state == "cross":
            return self._cross(local, p)
        return self._follow(ranges_m, odometry.dt, local, p)

    def _begin_following(self) -> None:
        self._state, self._turn, self._stage = "follow", None, 0
        self._clock, self._until = 0.0, math.inf

    def _follow(self, ranges_m, dt: float, local: LocalMovement, p: PilotParams) -> tuple[float, float]:
        if self._cross_in_s == math.inf:
            self._cross_in_s = p.cross_after_s * float(self._rng.uniform(0.75, 1.25))
        self._cross_in_s -= dt
        if self._way > p.look_back_after_m:
            self._way, self._state, self._stage, self._clock = 0.0, "look", 0, 0.0
            self._turn = _Turn(math.pi)
            self._back = LOOK_BACK_M
            return 0.0, p.turn_rate
        if self._cross_in_s <= 0:
            self.begin_crossing()
            return 0.0, 0.0
        left, ahead_left, front = float(ranges_m[0]), float(ranges_m[1]), float(min(ranges_m[2:6]))
        if front < p.wall_distance + 0.15:
            return local.towards(0.3, -0.6, p.cruise_speed, p.turn_rate, p.clearance)
        if left > 2 * p.wall_distance and ahead_left > 2 * p.wall_distance:
            return local.towards(0.5, 0.45, p.cruise_speed, p.turn_rate, p.clearance)
        wall = min(left, ahead_left * math.cos(math.radians(40)))
        aside = max(-0.5, min(0.5, wall - p.wall_distance))
        return local.towards(0.8, aside, p.cruise_speed, p.turn_rate, p.clearance)

    def _cross(self, local: LocalMovement, p: PilotParams) -> tuple[float, float]:
        if self._clock > self._until or local.free_way(0.0, p.clearance) < 0.35:
            self._begin_following()
            return 0.0, 0.0
        return local.towards(1.2, 0.0, p.cruise_speed, p.turn_rate, p.clearance)

    def _look(self, moved: float, local: LocalMovement, p: PilotParams) -> tuple[float, float]:
        """Back along the way for a metre, then round again and on."""
        if self._stage == 0:
            self._back -= moved
            if self._back > 0 and self._clock < 8.0 and local.free_way(0.0, p.clearance) > 0.15:
                return local.towards(0.8, 0.0, p.cruise_speed, p.turn_rate, p.clearance)
            self._stage, self._turn, self._clock = 1, _Turn(wrap_angle(math.pi - 1e-3)), 0.0
            return 0.0, 0.0
        self._begin_following()
        return 0.0, 0.0
