"""The pilot: explores, obeys the hand, follows routes, and frees itself. It knows sensors and the map, never the truth."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.pilot.explore import Explorer
from app.pilot.local_movement import LocalMovement
from app.pilot.params import PilotParams
from app.pilot.route_following import Progress, RouteFollower
from ratslam_core import ExperienceMap, Odometry

Mode = Literal["explore", "manual", "goal"]
BACK_OFF_S = 1.5
TURNED_RAD, MOST_TURNS = 1.5, 2
SLOWEST, GRIP_S = 0.2, 2.0
BEHAVIOURS = {  # what the experience map's links remember; 0 is standing
    "following the wall": 1,
    "crossing": 2,
    "turning back to look": 3,
    "following the route": 4,
    "coasting on the old route": 4,
    "freeing itself": 5,
    "driven by hand": 6,
}


class Pilot:
    """`step` gives the drive for the next tick: speed (m/s) and yaw rate (rad/s)."""

    def __init__(self, params: PilotParams, sonar_angles_rad: NDArray[np.float64], rng: np.random.Generator) -> None:
        self.params = params
        self.mode: Mode = "explore"
        self.doing = "starting"
        self._explorer = Explorer(rng)
        self._local = LocalMovement(sonar_angles_rad)
        self._rng = rng
        self._follower: RouteFollower | None = None
        self._hand = (0.0, 0.0)  # speed, yaw rate
        self._place = np.zeros(3)  # by odometry, from where it last got ahead
        self._still_s = 0.0
        self._looked_at, self._turns = 0.0, 0  # heading when it last had turned far; how often since it got ahead
        self._asked, self._grip = (0.0, 0.0), 1.0  # the last drive; how much of a turn that is asked for is made
        self._astray = False  # exploring because no route leads on
        self._free_self_s = 0.0
        self._free_self = (0.0, 0.0)

    # ------------------------------------------------------------ orders

    @property
    def goal(self) -> int | None:
        return self._follower.goal if self._follower else None

    @property
    def goal_state(self) -> tuple[int, str] | None:
        return (self._follower.goal, self._follower.state) if self._follower else None

    @property
    def behaviour(self) -> int:
        """The number of what it is doing, for the links of the experience map."""
        return BEHAVIOURS.get(self.doing, 0)

    def progress(self, experiences: ExperienceMap) -> Progress | None:
        return self._follower.progress(experiences) if self._follower else None

    def set_goal(self, experience: int) -> None:
        self._follower = RouteFollower(experience)
        self.mode = "goal"

    def cancel_goal(self) -> None:
        self._follower = None
        if self.mode == "goal":
            self.mode = "explore"

    def set_mode(self, mode: Mode) -> None:
        """ValueError when there is no goal to go to."""
        if mode == "goal" and self._follower is None:
            raise ValueError("there is no goal to go to; set one first")
        self.mode = mode
        self._hand = (0.0, 0.0)

    def drive(self, speed: float, yaw_rate: float) -> None:
        """By hand, until the next order; the runner lets an order expire when no newer one comes."""
        self.mode = "manual"
        self._hand = (speed, yaw_rate)

    # ------------------------------------------------------------ each tick

    def step(
        self, ranges_m: NDArray[np.float32], bumped: bool, odometry: Odometry, experiences: ExperienceMap
    ) -> tuple[float, float]:
        """From what was sensed at the end of the last tick."""
        self._asked = self._decide(ranges_m, bumped, odometry, experiences)
        return self._asked

    def _decide(
        self, ranges_m: NDArray[np.float32], bumped: bool, odometry: Odometry, experiences: ExperienceMap
    ) -> tuple[float, float]:
        self._local.sense(ranges_m, odometry)
        if self.mode == "manual":
            return self._by_hand()
        if self._stuck(bumped, odometry):
            self.doing = "freeing itself"
            return self._free_self
        if self.mode == "goal" and self._follower is not None:
            target = self._follower.step(experiences, odometry.dt, self.params)
            state = self._follower.state
            if state == "arrived":
                self.doing = "at the goal"
                self._still_s = 0.0
                return 0.0, 0.0
            if target is not None:
                self.doing = "following the route" if state == "tracking" else "coasting on the old route"
                self._astray = False
                p = self.params
                return self._local.towards(*target, p.cruise_speed, p.turn_rate, p.clearance)
            if not self._astray:
                self._astray = True
                self._explorer.begin_crossing()
        drive = self._explorer.step(ranges_m, odometry, self._local, self.params)
        self.doing = self._explorer.doing
        return drive

    def digest(self) -> bytes:
        """All that decides what it will do, for the state hash."""
        parts = (
            self.mode,
            self.goal_state,
            self._astray,
            self._hand,
            self._still_s,
            self._looked_at,
            self._turns,
            self._asked,
            self._grip,
            self._free_self_s,
            self._free_self,
            self.params,
        )
        return repr(parts).encode() + self._place.tobytes() + self._explorer.digest() + self._local.digest()

    def _by_hand(self) -> tuple[float, float]:
        self._still_s = 0.0
        self.doing = "waiting for the hand" if self._hand == (0.0, 0.0) else "driven by hand"
        return self._hand

    def _stuck(self, bumped: bool, odometry: Odometry) -> bool:
        """[ours] Back off and turn for a while when bumped into something or when getting nowhere.

        To turn is to get somewhere, but not again and again. On a floor that makes it slow everything takes its time.
        test_pilot.py::{test_a_cornered_robot_frees_itself, test_a_slow_floor_is_no_reason_to_back_off}.
        """
        dt = odometry.dt
        x, y, heading = self._place
        heading += odometry.yaw_rate * dt
        self._place[:] = (
            x + odometry.speed * dt * math.cos(heading), y + odometry.speed * dt * math.sin(heading), heading,
        )  # fmt: skip
        if abs(self._asked[1]) > 0.2 and odometry.yaw_rate != 0:  # wheels that do not turn are not slow, but stuck
            share = min(1.0, max(SLOWEST, odometry.yaw_rate / self._asked[1]))
            self._grip += min(1.0, dt / GRIP_S) * (share - self._grip)
        self._still_s += dt * self._grip
        if math.hypot(self._place[0], self._place[1]) > 0.4:
            self._place[:2] = 0.0
            self._still_s, self._looked_at, self._turns = 0.0, heading, 0
        elif abs(heading - self._looked_at) > TURNED_RAD and self._turns < MOST_TURNS:
            self._still_s, self._looked_at, self._turns = 0.0, heading, self._turns + 1
        if self._free_self_s > 0:
            self._free_self_s -= dt
            if self._free_self_s < BACK_OFF_S:
                self._free_self = (0.0, self._free_self[1])
            return True
        if self._still_s > self.params.stuck_s or (bumped and self._still_s > 1.0):
            turn = float(self._rng.uniform(0.5, 1.0)) * math.copysign(self.params.turn_rate, self._rng.uniform(-1, 1))
            self._free_self_s, self._free_self = BACK_OFF_S + 1.0, (-0.2, turn)
            self._still_s = 0.0
            self._place[:2] = 0.0
            self._local.forget()
            return True
        return False
