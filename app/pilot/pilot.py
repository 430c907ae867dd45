"""The pilot explores, obeys the hand, follows routes and gets free. It knows sensors and map, never the truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.pilot.bars import Bars
from app.pilot.behaviours import Behaviour
from app.pilot.explore import Explorer
from app.pilot.freeing import Freeing
from app.pilot.local_movement import Candidates, LocalMovement, candidates
from app.pilot.params import PilotParams
from app.pilot.route_following import Progress, RouteFollower
from app.pilot.seeking import Seeker
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
        self._carried = False  # away from the goal, to an island: it looks for the rest of its map
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
        drive = self._freeing.step(bumped, odometry, self._asked[1], self.params)
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
        if self._seeker.into_far:
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
        return self._local.towards(*self._local.gap_towards(*target, self.params), self.params)

    def _back_out(self) -> None:
        self._freeing.begin(self.params)
        self._local.forget()

    def _to_the_goal(
        self, follower: RouteFollower, odometry: Odometry, experiences: ExperienceMap
    ) -> tuple[float, float] | None:
        """The drive towards the goal. None: no route is known, so explore."""
        target = follower.step(experiences, self._local, odometry.dt, self.params, sure=not experiences.lost)
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
            return self._local.towards(*self._local.gap_towards(*target, self.params), self.params)
        if not self._astray:
            self._astray = True
            self._explorer.begin_crossing()
        return None

    def _by_hand(self) -> tuple[float, float]:
        self._freeing.at_rest()
        self.behaviour = Behaviour.WAITING if self._hand == (0.0, 0.0) else Behaviour.DRIVEN_BY_HAND
        return self._hand
