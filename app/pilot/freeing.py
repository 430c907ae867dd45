"""[ours] Getting free: the robot backs off and turns when it has bumped into something or makes no progress.

Turning counts as progress, but only a few times in one place. On a slow floor the time without progress runs slower.
test_freeing.py::{test_a_cornered_robot_frees_itself, test_a_slow_floor_is_no_reason_to_back_off}.
"""

from __future__ import annotations

import math

import numpy as np

from app.pilot.params import PilotParams
from disk import kind
from ratslam_core import Odometry

BUMPED_S = 1.0  # without progress for this long, a robot that has bumped into something frees itself
SOMEWHERE_M, TURNED_RAD = 0.4, 1.5  # progress is to come this far, by odometry, or to turn this far ...
MOST_TURNS = 2  # ... but turns count no more often than this in one place
GRIP_YAW_RATE = 0.2  # rad/s; turns faster than this are used to measure how slow the floor is
LEAST_GRIP = 0.2  # on the slowest floor, time without progress runs at this share
GRIP_S = 2.0  # time constant of measuring the floor
BACK_OFF_S, BACK_OFF_SPEED = 1.0, 0.2  # how long, and at how many m/s, the robot backs off ...
FREE_TURN_S = 1.5  # ... and how long it turns then ...
FREE_TURN_SHARE = 0.5  # ... at this share of the turn rate or more, to the left or right


@kind("freeing/1")
class Freeing:
    """Notices that the robot is stuck, and proposes (speed, yaw rate) until it should be free."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._place = np.array([0.0, 0.0, 0.0])  # x, y, heading by odometry, since it last got ahead
        self._still_s = 0.0  # time without progress
        self._looked_at, self._turns = 0.0, 0  # heading at the last turn that counted; turns counted since it got ahead
        self._grip = 1.0  # which share of the yaw rate asked for the floor lets through
        self._left_s = 0.0  # what is left of backing off and turning
        self._drive = (0.0, 0.0)
        self.has_begun = False  # in this tick; the pilot then forgets its echoes, which have led it here

    def at_rest(self) -> None:
        """The robot stands on purpose, so it is not stuck."""
        self._still_s = 0.0

    def step(self, bumped: bool, odometry: Odometry, asked: float, p: PilotParams) -> tuple[float, float] | None:
        """The drive while the robot frees itself, else None. asked: yaw rate (rad/s) of the last drive."""
        self.has_begun = False
        self._move_on(odometry, asked)
        if self._left_s > 0:
            self._left_s -= odometry.dt
            if self._left_s < FREE_TURN_S:
                self._drive = (0.0, self._drive[1])
            return self._drive
        if self._still_s > p.stuck_s or (bumped and self._still_s > BUMPED_S):
            self.begin(p)
            return self._drive
        return None

    def _move_on(self, odometry: Odometry, asked: float) -> None:
        """Update the place by odometry, the grip of the floor, and the time without progress."""
        x, y, heading = self._place.tolist()
        heading += odometry.yaw_rate * odometry.dt
        step = odometry.speed * odometry.dt
        self._place[:] = x + step * math.cos(heading), y + step * math.sin(heading), heading
        if abs(asked) > GRIP_YAW_RATE and odometry.yaw_rate != 0:  # wheels that do not turn are stuck, not slow
            share = min(1.0, max(LEAST_GRIP, odometry.yaw_rate / asked))
            self._grip += min(1.0, odometry.dt / GRIP_S) * (share - self._grip)
        self._still_s += odometry.dt * self._grip
        if math.hypot(*self._place[:2].tolist()) > SOMEWHERE_M:
            self._place[:2] = 0.0
            self._still_s, self._looked_at, self._turns = 0.0, heading, 0
        elif abs(heading - self._looked_at) > TURNED_RAD and self._turns < MOST_TURNS:
            self._still_s, self._looked_at, self._turns = 0.0, heading, self._turns + 1

    def begin(self, p: PilotParams) -> None:
        """Back off and turn, from the next tick on."""
        share = float(self._rng.uniform(FREE_TURN_SHARE, 1.0))
        turn = share * math.copysign(p.turn_rate, self._rng.uniform(-1, 1))
        self._left_s, self._drive = FREE_TURN_S + BACK_OFF_S, (-BACK_OFF_SPEED, turn)
        self._still_s = 0.0
        self._place[:2] = 0.0
        self.has_begun = True
