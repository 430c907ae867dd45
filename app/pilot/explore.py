"""Exploring: following the wall on the left, turning back to look. IROS 2005 section IV.D.

[ours] Wall following alone never enters the middle of a room, so from time to time the robot crosses it in a random
direction, and it looks back for a metre only. With `retrace` it does as the paper says: test_looking_back.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.pilot.behaviours import Behaviour
from app.pilot.local_movement import LocalMovement
from app.pilot.looking_back import LookingBack
from app.pilot.params import PilotParams
from disk import kind
from ratslam_core import Odometry

FOLLOW_AHEAD_M = 0.8  # how far ahead the robot aims along a wall, and when it drives back to look
FOLLOW_ASIDE_M = 0.5  # how far to the side it aims at most to keep its distance
BLOCKED_AHEAD_M = 0.15  # added to the wall distance: it turns away from anything nearer ahead ...
AWAY_FROM_IT = (0.3, -0.6)  # ... and aims there, m, in its frame
CORNER_SHARE = 2.0  # a wall more than so many wall distances away has ended ...
ROUND_THE_CORNER = (0.5, 0.45)  # ... and it aims there
TURNED_TO_RAD = 0.15  # a turn on the spot ends when no more than this is left ...
TURN_PATIENCE_S = 12.0  # ... and is given up after this time
LOOK_BACK_M, LOOK_BACK_S = 1.0, 8.0  # how far it drives back to look, and for how long at most ...
LOOK_STOP_M = 0.15  # ... and it ends when no more than this is free ahead
LOOK_TURN_RAD, LOOK_RETURN_RAD = math.pi, math.pi - 1e-3  # to look back (C IV.D), and to go on: the other way round
CROSS_SPREAD = 0.25  # largest random variation of the time before a crossing, as a share of it
CROSS_LEAST_S, CROSS_MOST_S = 6.0, 20.0  # of a crossing, not counting its turn
CROSS_AHEAD_M, CROSS_STOP_M = 1.2, 0.35  # how far ahead it aims, and how little free way ahead ends the crossing

_DOING = {
    "follow": Behaviour.FOLLOWING_THE_WALL,
    "cross": Behaviour.CROSSING,
    "look": Behaviour.LOOKING_BACK,
}


@kind("turn/1")
@dataclass(slots=True)
class Turn:
    """A turn on the spot; `left`: what is still to be turned (rad, positive to the left)."""

    left: float


@kind("explorer/2")
class Explorer:
    """Proposes (speed m/s, yaw rate rad/s) for each tick and names the behaviour."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._begin_following()
        self._way, self._far = 0.0, math.inf  # since it last looked back, m: wandering; to new ground, first of all
        self._back = 0.0  # what is left to drive back while looking, m
        self._looking = LookingBack()
        self._cross_in_s = math.inf  # time of wall following until the next crossing; looking back does not reset it

    @property
    def doing(self) -> Behaviour:
        return _DOING[self._state]

    def move(self, odometry: Odometry, p: PilotParams) -> None:
        """In each tick, whoever drives."""
        if _plainly(p):
            self._looking.move(odometry)

    def travel(self, way_m: float, p: PilotParams) -> None:
        """[ours] The robot drove on new ground on a trip of its own; there, too, it turns back to look after a while."""
        self._far += way_m
        if self._far > p.far_look_back_m:
            self._far = 0.0
            self._begin_looking_back()

    def begin_crossing(self) -> None:
        """Turn to a random direction, then drive straight ahead."""
        self._state, self._turn, self._stage = "cross", Turn(float(self._rng.uniform(-math.pi, math.pi))), 0
        self._clock, self._until = 0.0, float(self._rng.uniform(CROSS_LEAST_S, CROSS_MOST_S))
        self._cross_in_s = math.inf

    def step(
        self, ranges_m: NDArray[np.float32], odometry: Odometry, local: LocalMovement, p: PilotParams
    ) -> tuple[float, float]:
        """ranges_m: (8,) sonar ranges from left to right, from the robot's middle."""
        moved, turned = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        self._clock += odometry.dt
        self._way += abs(moved)
        if self._turn is not None:
            self._turn.left -= turned
            if abs(self._turn.left) > TURNED_TO_RAD and self._clock < TURN_PATIENCE_S:
                return 0.0, math.copysign(p.turn_rate, self._turn.left)
            self._turn, self._clock = None, 0.0
        if self._state == "look":
            return self._retrace(local, p) if _plainly(p) else self._look(moved, local, p)
        if self._state == "cross":
            return self._cross(local, p)
        return self._follow(ranges_m, odometry.dt, local, p)

    def _begin_following(self) -> None:
        self._state, self._turn, self._stage = "follow", None, 0
        self._clock, self._until = 0.0, math.inf

    def _follow(
        self, ranges_m: NDArray[np.float32], dt: float, local: LocalMovement, p: PilotParams
    ) -> tuple[float, float]:
        if _plainly(p):
            return self._follow_plainly(ranges_m, local, p)
        if self._cross_in_s == math.inf:
            self._cross_in_s = p.cross_after_s * float(self._rng.uniform(1 - CROSS_SPREAD, 1 + CROSS_SPREAD))
        self._cross_in_s -= dt
        if self._way > p.look_back_after_m:
            self._begin_looking_back()
            return 0.0, p.turn_rate
        if self._cross_in_s <= 0:
            self.begin_crossing()
            return 0.0, 0.0
        return self._along_the_wall(ranges_m, local, p)

    def _follow_plainly(
        self, ranges_m: NDArray[np.float32], local: LocalMovement, p: PilotParams
    ) -> tuple[float, float]:
        self._looking.note()
        if not self._looking.is_due(p):
            return self._along_the_wall(ranges_m, local, p)
        self._begin_looking_back()
        return 0.0, p.turn_rate

    def _begin_looking_back(self) -> None:
        self._way, self._state, self._stage, self._clock = 0.0, "look", 0, 0.0
        self._turn = Turn(LOOK_TURN_RAD)
        self._back = LOOK_BACK_M
        self._looking.begin_leg(back=True)

    def _along_the_wall(
        self, ranges_m: NDArray[np.float32], local: LocalMovement, p: PilotParams
    ) -> tuple[float, float]:
        left, ahead_left, front = float(ranges_m[0]), float(ranges_m[1]), float(min(ranges_m[2:6]))
        if front < p.wall_distance + BLOCKED_AHEAD_M:
            return local.towards(*AWAY_FROM_IT, p)
        gone = CORNER_SHARE * p.wall_distance
        if left > gone and ahead_left > gone:
            return local.towards(*ROUND_THE_CORNER, p)
        wall = min(left, ahead_left * local.aslant)
        aside = max(-FOLLOW_ASIDE_M, min(FOLLOW_ASIDE_M, wall - p.wall_distance))
        return local.towards(FOLLOW_AHEAD_M, aside, p)

    def _cross(self, local: LocalMovement, p: PilotParams) -> tuple[float, float]:
        if self._clock > self._until or local.free_way(0.0, p) < CROSS_STOP_M:
            self._begin_following()
            return 0.0, 0.0
        return local.towards(CROSS_AHEAD_M, 0.0, p)

    def _look(self, moved: float, local: LocalMovement, p: PilotParams) -> tuple[float, float]:
        """After the half turn: drive back along the way for `LOOK_BACK_M`, turn round again and go on."""
        if self._stage == 0:
            self._back -= moved
            if self._back > 0 and self._clock < LOOK_BACK_S and local.free_way(0.0, p) > LOOK_STOP_M:
                return local.towards(FOLLOW_AHEAD_M, 0.0, p)
            self._stage, self._turn, self._clock = 1, Turn(LOOK_RETURN_RAD), 0.0
            return 0.0, 0.0
        self._begin_following()
        return 0.0, 0.0

    def _retrace(self, local: LocalMovement, p: PilotParams) -> tuple[float, float]:
        """After the half turn: back along its path, turn round again, and return. C IV.D."""
        drive = self._looking.drive(local, p)
        if drive is not None:
            return drive
        self._stage, self._clock = self._stage + 1, 0.0
        if self._stage == 1:
            self._turn = Turn(-LOOK_RETURN_RAD)
            self._looking.begin_leg(back=False)
        else:
            self._looking.begin_path()
            self._begin_following()
        return 0.0, 0.0


def _plainly(p: PilotParams) -> bool:
    """Whether it wanders as in IROS 2005: the wall, and the way back. [ours] It seeks, or crosses rooms and looks back 1 m."""
    return p.retrace and not p.seek
