"""The pilot: exploration, driving by hand, route following, getting free. It reads sensors and map, never the ground truth."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.pilot.active_localisation import active_aim
from app.pilot.bars import Bars
from app.pilot.behaviours import Behaviour
from app.pilot.explore import Explorer
from app.pilot.local_movement import Candidates, LocalMovement, candidates
from app.pilot.params import PilotParams
from app.pilot.route_following import Progress, RouteFollower
from app.pilot.seeking import Seeker
from app.pilot.stay import Stay
from disk import kind
from ratslam_core import ExperienceMap, Odometry
from web.messages import GoalState

Mode = Literal["explore", "manual", "goal"]


@kind("pilot/3")
class Pilot:
    """`step` gives the drive for the next tick: speed (m/s) and yaw rate (rad/s)."""

    def __init__(self, params: PilotParams, sonar_angles_rad: NDArray[np.float64], rng: np.random.Generator) -> None:
        self.params = params
        self.mode: Mode = "explore"
        self._behaviour = Behaviour.STARTING.name
        self._explorer = Explorer(rng)
        self._local = LocalMovement(sonar_angles_rad, params.echo_s)
        self._rng = rng
        self._follower: RouteFollower | None = None
        self._hand = (0.0, 0.0)  # speed, yaw rate
        self._asked = (0.0, 0.0)  # speed, yaw rate of the last tick
        self._astray = False  # has a goal, but explores since no route to it is known
        self._carried = False  # away from the goal, to a submap: it looks for the rest of its map
        self._freeing = Freeing(rng)
        self._bars = Bars()
        self._seeker = Seeker(sonar_angles_rad, self._bars)

    # ------------------------------------------------------------ orders

    @property
    def goal(self) -> int | None:
        return self._follower.goal if self._follower else None

    @property
    def goals(self) -> tuple[int, ...]:
        """All experiences that stand for the goal, `goal` first; none without a goal."""
        return tuple(self._follower.goals) if self._follower else ()

    @property
    def goal_state(self) -> tuple[int, GoalState] | None:
        return (self._follower.goal, self._follower.state) if self._follower else None

    @property
    def why_no_route(self) -> str:
        """What keeps the robot from its goal, in a few words; "" while a route is known, or without a goal."""
        return "" if self._follower is None else self._follower.why

    @property
    def behaviour(self) -> Behaviour:
        """The current behaviour. It is stored by name, since a state can hold a name."""
        return Behaviour[self._behaviour]

    @behaviour.setter
    def behaviour(self, behaviour: Behaviour) -> None:
        self._behaviour = behaviour.name

    @property
    def doing(self) -> str:
        """The current behaviour in words."""
        return self.behaviour.words

    def look_at_choice(self) -> Callable[[], Candidates] | None:
        """How to find out, at any time, among which arcs the robot chose in this tick; None: it chose none."""
        asked = self._local.asked
        return None if asked is None else lambda: candidates(*asked)

    @property
    def aim(self) -> tuple[float, float] | None:
        """The point that it steered towards in this tick (m, the robot's frame then); None: it steered towards none."""
        asked = self._local.asked
        return None if asked is None else asked[1:3]

    @property
    def explored(self) -> bool:
        """Whether, as far as it knows, there is nothing new to drive to."""
        return self.mode == "explore" and self._seeker.explored

    def trip(self, experiences: ExperienceMap) -> tuple[tuple[float, float], str, NDArray[np.float64]] | None:
        """While it explores on purpose: where to, m, map frame; why, in words; and all openings (k, 2) that it knew of."""
        target = self._seeker.target(experiences) if self.mode == "explore" else None
        return None if target is None else (target, self._seeker.reason, self._seeker.openings)

    def progress(self, experiences: ExperienceMap) -> Progress | None:
        return self._follower.progress(experiences) if self._follower else None

    def way_through(self, experiences: ExperienceMap, goals: Sequence[int]) -> Progress:
        """The way to a place that it would choose now if it went by this map: experiences that all stand for the place."""
        follower = RouteFollower(goals[0], others=goals[1:])
        follower.plan(experiences, self._local, self.params)
        return follower.progress(experiences)

    def set_goal(self, experience: int, others: Sequence[int] = ()) -> None:
        """others: experiences that stand for the same place; to come to one of them is to arrive."""
        self._bars.forget()  # they may lie wrong by now: the map is bent, doors move
        self._follower = RouteFollower(experience, self._bars, others)
        self._seeker.stop()
        self.mode = "goal"

    def cancel_goal(self) -> None:
        self._follower = None
        if self.mode == "goal":
            self.mode = "explore"

    def set_mode(self, mode: Mode) -> None:
        """ValueError if the mode is "goal" and there is no goal."""
        if mode == "goal" and self._follower is None:
            raise ValueError("there is no goal to go to; set one first")
        if mode != "goal":
            self._leave_goal()
        self.mode = mode
        self._hand = (0.0, 0.0)

    def drive(self, speed: float, yaw_rate: float) -> bool:
        """Drive by hand, until the next order. The engine ends an order that is not renewed in time. Returns whether anything
        has changed by it."""
        if self.mode == "manual" and self._hand == (speed, yaw_rate) and self._seeker.rests and not self._has_arrived:
            return False
        self._leave_goal()
        self._seeker.stop()
        self.mode = "manual"
        self._hand = (speed, yaw_rate)
        return True

    @property
    def _has_arrived(self) -> bool:
        return self._follower is not None and self._follower.state == "arrived"

    def _leave_goal(self) -> None:
        """Drop a goal that has been reached. One that was interrupted stays: the robot can go on to it later."""
        if self._has_arrived:
            self._follower = None

    # ------------------------------------------------------------ each tick

    def step(
        self, ranges_m: NDArray[np.float32], bumped: bool, odometry: Odometry, experiences: ExperienceMap
    ) -> tuple[float, float]:
        """The drive for the next tick, from what was sensed at the end of the last one. ranges_m: (8,)."""
        self._asked = self._decide(ranges_m, bumped, odometry, experiences)
        return self._asked

    def _decide(
        self, ranges_m: NDArray[np.float32], bumped: bool, odometry: Odometry, experiences: ExperienceMap
    ) -> tuple[float, float]:
        self._local.sense(ranges_m, odometry)
        self._explorer.move(odometry, self.params)
        self._seeker.ground.step(experiences, ranges_m, abs(odometry.speed * odometry.dt), odometry.dt)
        if self.mode == "manual":
            return self._by_hand()
        to_goal = self.mode == "goal" and self._follower is not None
        if to_goal and self._follower is not None:
            searched, self._carried = self._carried, self._follower.carried_away(experiences, odometry.dt)
            to_goal = not self._carried  # first it has to find its map again
            if searched and to_goal:
                self._seeker.stop()
        follower = self._follower if to_goal else self._seeker.follower
        if follower is not None:
            follower.move(odometry, self.behaviour is not Behaviour.FREEING_ITSELF)
        drive = self._freeing.step(bumped, odometry, self._asked[1], self._local, self.params)
        self._local.squeezes = self._freeing.squeezes
        if drive is not None:
            self.behaviour = Behaviour.FREEING_ITSELF
            if self._freeing.has_begun:
                self._local.forget()
            return drive
        drive = (
            self._to_the_goal(self._follower, odometry, experiences)
            if to_goal and self._follower is not None
            else self._seek(ranges_m, odometry, experiences)
        )
        if drive is not None:
            return drive
        drive = self._explorer.step(ranges_m, odometry, self._local, self.params)
        self.behaviour = self._explorer.doing
        return drive

    def _seek(
        self, ranges_m: NDArray[np.float32], odometry: Odometry, experiences: ExperienceMap
    ) -> tuple[float, float] | None:
        """The drive on a trip of its own choice. None: it wanders, or turns back to look."""
        aim = active_aim(experiences, self.params) if self.params.seek else None
        if aim is not None:
            self._seeker.stop()
            self.behaviour = Behaviour.LOCALISING
            return self._towards(aim)
        if self._seeker.on_new_ground:
            if self._explorer.doing is not Behaviour.LOOKING_BACK:
                self._explorer.travel(abs(odometry.speed * odometry.dt), self.params)
            if self._explorer.doing is Behaviour.LOOKING_BACK:
                return None
        target = self._seeker.step(experiences, self._local, ranges_m, odometry, self.params)
        if self._seeker.failed:
            self._back_out()
        if target is None:
            return None
        self.behaviour = Behaviour.RETURNING if self._seeker.returning else Behaviour.SEEKING
        return self._towards(target)

    def _towards(self, point: tuple[float, float]) -> tuple[float, float]:
        """The drive to a point (m, the robot's frame), round what the sonars find in the way."""
        return self._local.towards(*self._local.gap_towards(*point, self.params), self.params)

    def _back_out(self) -> None:
        self._freeing.begin(self.params)
        self._local.forget()

    def _to_the_goal(
        self, follower: RouteFollower, odometry: Odometry, experiences: ExperienceMap
    ) -> tuple[float, float] | None:
        """The drive towards the goal. None: no route is known, so explore."""
        sure = not (experiences.lost or experiences.suspects_kidnap)
        target = follower.step(experiences, self._local, odometry.dt, self.params, sure=sure)
        if follower.state == "arrived":
            self.behaviour = Behaviour.AT_THE_GOAL
            self._freeing.at_rest()
            return 0.0, 0.0
        if follower.failed:
            self._back_out()
        if target is not None:
            tracking = follower.state == "tracking"
            self.behaviour = Behaviour.FOLLOWING_THE_ROUTE if tracking else Behaviour.COASTING
            self._astray = False
            return self._towards(target)
        if not self._astray:
            self._astray = True
            self._explorer.begin_crossing()
        return None

    def _by_hand(self) -> tuple[float, float]:
        self._freeing.at_rest()
        self.behaviour = Behaviour.WAITING if self._hand == (0.0, 0.0) else Behaviour.DRIVEN_BY_HAND
        return self._hand


BUMPED_S = 1.0  # without progress for this long, a robot that has bumped into something frees itself
SOMEWHERE_M, TURNED_RAD = 0.4, 1.5  # progress is to come this far, by odometry, or to turn this far ...
MOST_TURNS = 4  # ... but turns count no more often than this in one place: who looks back turns round once
GRIP_YAW_RATE = 0.2  # rad/s; turns faster than this are used to measure how slow the floor is
LEAST_GRIP = 0.2  # on the slowest floor, time without progress runs at this share
GRIP_S = 2.0  # time constant of measuring the floor
BACK_OFF_S, BACK_OFF_SPEED = 1.0, 0.2  # how long, and at how many m/s, the robot backs off ...
FREE_TURN_S, LEAST_TURN_S = 1.5, 0.5  # ... and how long it turns then, less if it is free to drive ahead ...
FREE_M = 1.0  # ... so far ...
FREE_TURN_SHARE = 0.5  # ... at this share of the turn rate or more, to the left or right
SQUEEZE_S = 15.0  # who stays in one place for so long passes closer to what is around


@kind("freeing/2")
class Freeing:
    """[ours] Getting free: the robot backs off and turns when it has bumped into something or makes no progress.

    Turning counts as progress, but only a few times in one place. On a slow floor the time without progress runs slower.
    test_freeing.py::{test_a_cornered_robot_frees_itself, test_a_slow_floor_is_no_reason_to_back_off,
    test_it_gets_out_of_a_pocket_hardly_wider_than_itself}.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._place = np.array([0.0, 0.0, 0.0])  # x, y, heading by odometry, since it last got ahead
        self._still_s = 0.0  # time without progress
        self._stay = Stay()
        self._looked_at, self._turns = 0.0, 0  # heading at the last turn that counted; turns counted since it got ahead
        self._grip = 1.0  # which share of the yaw rate asked for the floor lets through
        self._left_s = 0.0  # what is left of backing off and turning
        self._drive = (0.0, 0.0)
        self.has_begun = False  # in this tick; the pilot then forgets its echoes, which have led it here

    def at_rest(self) -> None:
        """The robot stands on purpose, so it is not stuck."""
        self._still_s = 0.0
        self._stay.leave()

    @property
    def squeezes(self) -> bool:
        """Whether it has been in one place for so long that it may pass closer to what is around it."""
        return self._stay.seconds > SQUEEZE_S

    def step(
        self, bumped: bool, odometry: Odometry, asked: float, local: LocalMovement, p: PilotParams
    ) -> tuple[float, float] | None:
        """The drive while the robot frees itself, else None. asked: yaw rate (rad/s) of the last drive."""
        self.has_begun = False
        self._move_on(odometry, asked)
        if self._left_s > 0:
            self._left_s -= odometry.dt
            self._still_s, self._place[:2] = 0.0, 0.0
            if self._left_s < FREE_TURN_S:
                self._drive = (0.0, self._drive[1])
            if self._left_s < FREE_TURN_S - LEAST_TURN_S and local.free_way(0.0, p) >= FREE_M:
                self._left_s = 0.0
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
        self._stay.move(odometry)
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
        self.has_begun = True
