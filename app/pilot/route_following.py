"""Following a route to a goal over the experience map. ACRA 2006 section 4."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from app.pilot.params import RouteParams
from disk import kind
from ratslam_core import ExperienceMap, Pose2, Route
from web.messages import GoalState

_Points = NDArray[np.float64]  # (..., 2)


@dataclass(frozen=True, slots=True, eq=False)
class Progress:
    """How far the pilot has come on its way to the goal."""

    experience: int
    state: GoalState
    eta_s: float | None
    remaining_m: float | None
    route: NDArray[np.int64]  # experiences
    arrival_s: NDArray[np.float64]  # seconds from now


@kind("route follower/1")
class RouteFollower:
    """Keeps the quickest route to one goal and says which point to head for."""

    def __init__(self, goal: int) -> None:
        self.goal = goal
        self.state: GoalState = "tracking"
        self._route: Route | None = None
        self._age_s = math.inf  # time since the route was planned
        self._plan_in_s = 0.0
        self._no_route_s = 0.0
        self._nearest_m = math.inf  # least distance to the goal so far
        self._since_nearer_s = 0.0
        self._least_left_s = math.inf  # least travel time left to the goal so far
        self._since_headway_s = self._look_around_s = 0.0
        self._failed_trials = 0  # since it last made headway
        self._bars: list[NDArray[np.float64]] = []  # lines that it could not cross, (2, 2) each, map frame

    def step(self, experiences: ExperienceMap, dt: float, p: RouteParams) -> tuple[float, float] | None:
        """The next point to head for, metres in the robot's frame. None: it has arrived, or no route is known."""
        if self.state == "arrived":
            return None
        robot = experiences.robot
        goal = experiences.pose(self.goal)
        self._age_s += dt
        self._plan_in_s -= dt
        if self._there(math.hypot(goal.x - robot.x, goal.y - robot.y), dt, p):
            self.state = "arrived"
            return None
        self._watch_headway(experiences, dt, p)
        if self._plan_in_s <= 0:
            self._plan_in_s = p.replan_s
            self._plan(experiences, p)
        self.state = self._state_on_the_way(dt, p)
        return self._aim(experiences, p.lookahead_m) if self.state in ("tracking", "coasting") else None

    def _state_on_the_way(self, dt: float, p: RouteParams) -> GoalState:
        if self._route is None or self._age_s > p.coast_s:
            self._no_route_s += dt
            return "unreachable" if self._no_route_s > p.lost_s else "exploring"
        self._no_route_s = 0.0
        if self._look_around_s > 0:
            return "exploring"
        return "tracking" if self._age_s <= p.replan_s + dt else "coasting"

    def progress(self, experiences: ExperienceMap) -> Progress:
        nothing = np.zeros(0, np.int64), np.zeros(0)
        if self.state == "arrived":
            return Progress(self.goal, self.state, 0.0, 0.0, *nothing)
        if self._route is None or self.state in ("exploring", "unreachable"):
            return Progress(self.goal, self.state, None, None, *nothing)
        at = self._nearest(experiences)
        nodes = self._route.experiences[at:]
        arrival = self._route.arrival_s[at:] - self._route.arrival_s[at]
        xy = experiences.poses[nodes, :2]
        robot = experiences.robot
        first = math.hypot(xy[0, 0] - robot.x, xy[0, 1] - robot.y)
        remaining = first + float(np.hypot(*np.diff(xy, axis=0).T).sum())
        return Progress(self.goal, self.state, float(arrival[-1]), remaining, nodes, arrival)

    def _watch_headway(self, experiences: ExperienceMap, dt: float, p: RouteParams) -> None:
        """No headway on the route counts as a failed trial of the links ahead. If it lasts, the robot looks around.

        test_routes.py::{test_a_blocked_way_is_left, test_a_door_that_was_shut_is_given_up}.
        """
        if self._look_around_s > 0:
            self._look_around_s -= dt
            return
        if self._route is None:
            return
        left_s = float(self._route.arrival_s[-1])
        self._since_headway_s += dt
        if left_s < self._least_left_s - p.headway_s:
            self._least_left_s, self._since_headway_s, self._failed_trials = left_s, 0.0, 0
        if self._since_headway_s > p.trial_s * (self._failed_trials + 1):
            self._failed_trials += 1
            self._fail(experiences, p)
        if self._since_headway_s > p.no_headway_s:
            self._begin_anew()
            self._look_around_s = p.look_around_s

    def _begin_anew(self) -> None:
        self._least_left_s, self._since_headway_s, self._failed_trials = math.inf, 0.0, 0

    def _fail(self, experiences: ExperienceMap, p: RouteParams) -> None:
        """The robot could not cross a line ahead of it, the bar: a failed trial of every link across it. ACRA 2006 3.4.

        [ours] Every link counts, not only that of the route. A place has many experiences, and otherwise the robot
        would try their links one by one.
        """
        bar = _bar_ahead(experiences.robot, math.atan2(*self._aim(experiences, p.lookahead_m)[::-1]), p)
        self._bars.append(bar)
        links, xy = experiences.links, experiences.poses[:, :2]
        across = links[crosses(bar, xy[links[:, 0]], xy[links[:, 1]])]
        pairs = np.unique(np.sort(across, axis=1), axis=0)
        deleted = [experiences.tried(int(i), int(j), False) for i, j in pairs]
        if any(deleted):
            self._route, self._plan_in_s = None, 0.0
            self._begin_anew()

    def _there(self, away: float, dt: float, p: RouteParams) -> bool:
        """Near enough; or close by and no longer getting nearer, as at a goal in a corner too tight for the robot."""
        self._since_nearer_s = 0.0 if away < self._nearest_m - p.nearer_m else self._since_nearer_s + dt
        self._nearest_m = min(self._nearest_m, away)
        return away < p.arrival_m or (away < p.close_by_share * p.arrival_m and self._since_nearer_s > p.close_by_s)

    def _plan(self, experiences: ExperienceMap, p: RouteParams) -> None:
        """Plan the quickest route, from the active experience or, over an imagined link, from another one nearby."""
        self._succeed(experiences, p)
        ways, robot, poses = experiences.temporal_map, experiences.robot, experiences.poses
        times = ways.times_to(self.goal)
        away = np.hypot(poses[:, 0] - robot.x, poses[:, 1] - robot.y)
        near = self._near(experiences, away, p)
        turn = np.abs(np.remainder(poses[near, 2] - robot.heading_rad + np.pi, 2 * np.pi) - np.pi)
        cost = times[near] + away[near] / p.near_speed + p.near_turn_cost * turn
        start = int(near[np.argmin(cost)])
        if not np.isfinite(times[start]):
            return
        self._route = ways.route(start, self.goal)
        self._age_s = 0.0

    def _near(self, experiences: ExperienceMap, away: NDArray[np.float64], p: RouteParams) -> NDArray[np.intp]:
        """Experiences at which a route may start: the active one, and those nearby that no bar separates."""
        robot, near = experiences.robot, np.flatnonzero(away < p.near_m)
        for bar in self._bars:
            near = near[~crosses(bar, np.array([[robot.x, robot.y]]), experiences.poses[near, :2])]
        return near if experiences.active in near else np.append(near, experiences.active)

    def _succeed(self, experiences: ExperienceMap, p: RouteParams) -> None:
        """Every link of the route that was driven since the last plan counts as a successful trial."""
        if self._route is None or self._age_s > p.credited_plans * p.replan_s:
            return
        for i, j in pairwise(self._route.experiences[: self._nearest(experiences) + 1]):
            experiences.tried(int(i), int(j), True)

    def _nearest(self, experiences: ExperienceMap) -> int:
        """Index of the route's experience that is nearest to the robot; of equals, the last."""
        assert self._route is not None
        xy = experiences.poses[self._route.experiences, :2]
        robot = experiences.robot
        away = np.hypot(xy[:, 0] - robot.x, xy[:, 1] - robot.y)
        return int(len(away) - 1 - np.argmin(away[::-1]))

    def _aim(self, experiences: ExperienceMap, lookahead: float) -> tuple[float, float]:
        assert self._route is not None
        robot = experiences.robot
        xy = experiences.poses[self._route.experiences, :2]
        at = self._nearest(experiences)
        target, way = xy[at], 0.0
        for k in range(at, len(xy) - 1):
            way += float(np.hypot(*(xy[k + 1] - xy[k])))
            target = xy[k + 1]
            if way > lookahead:
                break
        c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
        dx, dy = float(target[0]) - robot.x, float(target[1]) - robot.y
        return c * dx + s * dy, -s * dx + c * dy


def _bar_ahead(robot: Pose2, bearing: float, p: RouteParams) -> NDArray[np.float64]:
    """The two ends (2, 2), map frame, of a bar that lies across the way in this direction (rad, robot's frame)."""
    ahead = robot.compose(Pose2(0.0, 0.0, bearing)).compose(Pose2(p.bar_ahead_m, 0.0, 0.0))
    left, right = (ahead.compose(Pose2(0.0, side * p.bar_m / 2, 0.0)) for side in (1, -1))
    return np.array([(left.x, left.y), (right.x, right.y)])


def crosses(bar: NDArray[np.float64], a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which of the segments from a to b, (n, 2) each, cross the bar, (2, 2)."""

    def side(start: _Points, end: _Points, point: _Points) -> _Points:
        along, to = end - start, point - start
        return along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0]

    apart = side(bar[0], bar[1], a) * side(bar[0], bar[1], b) < 0
    return apart & (side(a, b, bar[0]) * side(a, b, bar[1]) < 0)
