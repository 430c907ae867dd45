"""Which experiences a place of the map stands for as a goal (ACRA 2005 3.6), and following a route there over the
experience map (ACRA 2006 section 4).

[ours] Whether the robot gets on along its route is judged by its own odometry (`Headway`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numba import njit
from numpy.typing import NDArray

from app.pilot.bars import WIDEST_BAR_M, Bars, bar_ahead, crosses
from app.pilot.local_movement import LocalMovement
from app.pilot.params import PilotParams
from app.pilot.stay import Stay
from disk import kind
from ratslam_core import ExperienceMap, Odometry, Pose2, Route, wrap_angles
from web.messages import GoalState

GOAL_REACH_M = 1.5  # a goal farther than this from every experience is refused


def nearest_to(experiences: ExperienceMap, x: float, y: float) -> int:
    """The experience nearest to (x, y), m, map frame. ValueError off the map."""
    poses = experiences.poses
    away = np.hypot(poses[:, 0] - x, poses[:, 1] - y)
    nearest = int(np.argmin(away))
    reach = GOAL_REACH_M
    if not away[nearest] <= reach:  # written so that NaN is refused, too
        raise ValueError(
            f"({x:g}, {y:g}) is off the map: the nearest experience is {away[nearest]:.1f} m away, "
            f"at ({poses[nearest, 0]:.1f}, {poses[nearest, 1]:.1f}); choose a place within {reach:g} m of one"
        )
    return nearest


def of_its_place(experiences: ExperienceMap, experience: int, p: PilotParams) -> tuple[int, ...]:
    """The experiences that stand for the same place as this one, which comes first, the nearest before the others.

    A place has several, since the robot made one for each way that it faced and for each way that it came. They are those
    within `goal_place_m`, on the robot's own submap; if none lies there, and thus can be reached, on the submap of this
    one. With `goal_place_m` 0 it stands alone.
    test_goal_place.py::{test_whichever_way_they_face, test_what_can_be_reached_comes_first}.
    """
    if p.goal_place_m <= 0:
        return (experience,)
    poses, submaps = experiences.poses, experiences.submap_of
    apart = np.hypot(poses[:, 0] - poses[experience, 0], poses[:, 1] - poses[experience, 1])
    near = np.flatnonzero(apart <= p.goal_place_m)
    own = submaps[near] == submaps[experiences.active]
    near = near[own if own.any() else submaps[near] == submaps[experience]]
    order = np.lexsort((near != experience, apart[near]))  # some lie at exactly the same place
    return tuple(near[order].tolist())


LOOKAHEAD_M = 0.6  # how far ahead on the route the robot aims
WINDOW_M = 1.5  # it is looked for on so much of the route ahead, not where the route comes past again later
CLOSE_BY_M = 0.6  # nearer to its goal than this, a robot that gets no nearer has arrived, too ...
CLOSE_BY_S = 6.0  # ... after this time; at half that distance, after half of it
GOOD_ENOUGH_M = 0.8  # blocked nearer to its goal than this it has arrived, as where the map has the goal in a wall
NEARER_M = 0.02  # to get nearer means to get nearer by more than this
REPLAN_S, COAST_S = 1.0, 8.0  # a route is planned anew after this, and followed for this when it could not be (D 4.4)
CREDITED_PLANS = 2.0  # a route older than so many planning periods earns no successful trials
LOST_S = 25.0  # a goal is called unreachable when no route is known for this long
STAY_S = 4.0  # the robot leaves its route for another only if that saves more than this
NEAR_M = 0.6  # a route may start over an imagined link to an experience this near ...
NEAR_GROWTH, NEAR_MOST_M = 0.1, 2.0  # ... while no route is known, ever farther: m/s, up to this ...
NEAR_SPEED, NEAR_TURN_COST = 0.3, 0.3  # ... on which m/s, and s/rad for the turn at its end, are assumed ...
NEAR_COST = 3.0  # ... s added, since nobody has driven it ...
NEAR_DOUBT_S = 15.0  # ... and for each bar and failure: there the map may show side by side what is not ...
NEAR_BLIND_M = 0.2  # ... and the sonars must find it free but for so much
HEADWAY_M, HEADWAY_RAD = 0.1, 0.3  # headway is to come nearer, by odometry, or to turn to the next point, by this
TRIAL_S = 2.0  # no headway for this long is a failed trial of the way ahead (D 3.4)
NO_HEADWAY_S = 25.0  # a robot that stays in one place for this long ...
LOOK_AROUND_S = 15.0  # ... looks around for this long, since what the map takes for a way may be a wall

_Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Progress:
    """How far the pilot has come on its way to the goal."""

    experience: int
    state: GoalState
    eta_s: float | None
    remaining_m: float | None
    route: NDArray[np.int64]  # experiences
    arrival_s: _Array  # seconds from now
    why: str = ""  # no route is known, in a few words


@kind("route follower/4")
class RouteFollower:
    """Keeps the quickest route to a goal, one experience or several of one place, and says which point to head for."""

    def __init__(self, goal: int, bars: Bars | None = None, others: Sequence[int] = ()) -> None:
        """bars: what was in the robot's way so far. others: experiences that stand for the goal's place, too."""
        self.goals = [goal, *others]
        self.state: GoalState = "tracking"
        self.failed = False  # in this tick: the robot could not get on, and should back out
        self._route: Route | None = None
        self._at = 0  # the route's experience that the robot has come to
        self._age_s = math.inf  # time since the route was planned
        self._plan_in_s = 0.0
        self._no_route_s = 0.0
        self._nearest_m = math.inf  # least distance to the goal so far
        self._since_nearer_s = 0.0
        self._look_around_s = 0.0
        self._headway = Headway()
        self._bars = Bars() if bars is None else bars
        self._cut_off = ""  # what keeps the map from having a way there, in words

    @property
    def why(self) -> str:
        """Why no route is known, in a few words; "" while one is."""
        known = self._route is not None and self.state not in ("exploring", "unreachable")
        return "" if known or self.state == "arrived" else self._cut_off or "blocked on the way"

    @property
    def goal(self) -> int:
        return self.goals[0]

    def move(self, odometry: Odometry, trying: bool) -> None:
        """The robot moved. Called in every tick on the way to the goal. trying: whether it drove as `step` said."""
        self._bars.fade(odometry.dt)
        if self._look_around_s > 0:
            self._look_around_s -= odometry.dt
        elif self.state != "arrived":
            self._headway.move(odometry, trying)

    def carried_away(self, experiences: ExperienceMap, dt: float) -> bool:
        """[ours] Whether the robot was carried to a submap that no experience of the goal lies on. Where it is to the
        goal is unknown, and there is no way before the two are merged.
        test_routes.py::test_carried_away_from_the_goal_it_looks_for_the_way_back."""
        submaps = experiences.submap_of
        if (submaps[self.goals] == submaps[experiences.active]).any():
            return False
        self.failed, self._route, self._age_s, self._plan_in_s = False, None, math.inf, 0.0
        self._nearest_m, self._since_nearer_s = math.inf, 0.0
        self._cut_off = "on another submap"
        self.state = self._state_on_the_way(dt, sure=not experiences.lost)
        return True

    def step(
        self, experiences: ExperienceMap, local: LocalMovement, dt: float, p: PilotParams, *, sure: bool = True
    ) -> tuple[float, float] | None:
        """The next point to head for, metres in the robot's frame. None: it has arrived, or no route is known.

        sure: [ours] a robot that is lost, or was perhaps carried, is at the goal by its estimate only. It looks around until it
        knows: if it stood still, it would never find out.
        test_routes.py::test_who_is_lost_has_not_arrived.
        """
        self.failed = False
        if self.state == "arrived" and sure:
            return None
        goal = self._goal_from_robot(experiences)
        self._age_s += dt
        self._plan_in_s -= dt
        away = math.hypot(*goal)
        blocked = self._watch_headway()
        if self._there(away, dt, p) or (blocked and away < GOOD_ENOUGH_M):
            if sure:
                self.state = "arrived"
                return None
            self._look_around_s = LOOK_AROUND_S
        if blocked:
            self._fail(experiences, p)
        if self._plan_in_s <= 0:
            self._plan_in_s = REPLAN_S
            self.plan(experiences, local, p)
        self.state = self._state_on_the_way(dt, sure=sure)
        aim = self._aim(experiences) if self.state in ("tracking", "coasting") else None
        if aim is not None and self._free_to(goal, local, p):
            aim = goal
        self._headway.head_for(aim)
        return aim

    def _state_on_the_way(self, dt: float, *, sure: bool) -> GoalState:
        """sure: who does not know where it is cannot say that no way leads from there."""
        if self._route is None or self._age_s > COAST_S:
            self._no_route_s += dt
            return "unreachable" if sure and self._no_route_s > LOST_S else "exploring"
        self._no_route_s = 0.0
        if self._look_around_s > 0:
            return "exploring"
        return "tracking" if self._age_s <= REPLAN_S + dt else "coasting"

    def progress(self, experiences: ExperienceMap) -> Progress:
        nothing = np.zeros(0, np.int64), np.zeros(0)
        if self.state == "arrived":
            return Progress(self.goal, self.state, 0.0, 0.0, *nothing)
        if self._route is None or self.state in ("exploring", "unreachable"):
            return Progress(self.goal, self.state, None, None, *nothing, self.why)
        nodes = self._route.experiences[self._at :]
        arrival = self._route.arrival_s[self._at :] - self._route.arrival_s[self._at]
        xy = experiences.poses[nodes, :2]
        robot = experiences.robot
        first = math.hypot(xy[0, 0] - robot.x, xy[0, 1] - robot.y)
        remaining = first + float(np.hypot(*np.diff(xy, axis=0).T).sum())
        return Progress(self.goal, self.state, float(arrival[-1]), remaining, nodes, arrival)

    def _watch_headway(self) -> bool:
        """Whether a trial of the way ahead has failed for want of headway. A robot that stays at one place for long
        looks around. test_routes.py::{test_a_blocked_way_is_left, test_a_door_that_was_shut_is_given_up}.
        """
        if self._look_around_s > 0 or self._route is None:
            return False
        if self._headway.astray():
            self._headway.leave()
            self._look_around_s = LOOK_AROUND_S
        if not self._headway.blocked():
            return False
        self._headway.begin()
        return True

    def _fail(self, experiences: ExperienceMap, p: PilotParams) -> None:
        """The robot could not cross a line ahead of it, the bar. With fading bars the ways across it are slower for a
        while; without, it is a failed trial of every link across it. ACRA 2006 3.4.

        [ours] Every link counts, not only that of the route. A place has many experiences, and otherwise the robot
        would try their links one by one.
        """
        bearing = math.atan2(*self._aim(experiences)[::-1])
        self._bars.add(experiences.robot, bearing, p)
        self.failed, self._plan_in_s, self._route = True, 0.0, None
        if p.bar_fade_s:
            return
        links, xy = experiences.links, experiences.poses[:, :2]
        bar = bar_ahead(experiences.robot, bearing, WIDEST_BAR_M)
        across = links[crosses(bar, xy[links[:, 0]], xy[links[:, 1]])]
        pairs = np.unique(np.sort(across, axis=1), axis=0)
        for i, j in pairs:
            experiences.tried(int(i), int(j), False)

    def _goal_from_robot(self, experiences: ExperienceMap) -> tuple[float, float]:
        """The place of the goal's experience that is nearest to the robot, whichever way it faces; m, robot's frame."""
        places, robot = experiences.poses[list(self.goals), :2], experiences.robot
        nearest = int(np.argmin(np.hypot(places[:, 0] - robot.x, places[:, 1] - robot.y)))
        return _from_robot(robot, *places[nearest])

    def _there(self, away: float, dt: float, p: PilotParams) -> bool:
        """Near enough; or close by and no longer getting nearer, as at a goal in a corner too tight for the robot."""
        self._since_nearer_s = 0.0 if away < self._nearest_m - NEARER_M else self._since_nearer_s + dt
        self._nearest_m = min(self._nearest_m, away)
        patience = CLOSE_BY_S * away / CLOSE_BY_M
        return away < p.arrival_m or (away < CLOSE_BY_M and self._since_nearer_s > patience)

    def _free_to(self, goal: tuple[float, float], local: LocalMovement, p: PilotParams) -> bool:
        """[ours] Whether the robot may leave the route and drive straight to the goal, since the sonars see nothing in
        between. test_routes.py::test_the_last_metre_is_driven_straight."""
        away = math.hypot(*goal)
        return away < p.approach_m and local.free_way(math.atan2(goal[1], goal[0]), p) >= away - p.arrival_m

    def plan(self, experiences: ExperienceMap, local: LocalMovement, p: PilotParams) -> None:
        """Plan the quickest route, from the active experience or, over an imagined link, from another one nearby."""
        self._succeed(experiences)
        t = experiences.transitions
        delays = self._bars.delays(t.ends[: t.count], experiences.poses) if p.bar_fade_s else None
        ways, robot, poses = experiences.temporal_map, experiences.robot, experiences.poses
        times = ways.times_to(self.goals, delays)
        away = np.hypot(poses[:, 0] - robot.x, poses[:, 1] - robot.y)
        start = self._start(experiences, local, times, away, p)
        self._cut_off = "" if np.isfinite(times[start]) else _cut_off(experiences, times)
        if self._cut_off:
            return
        self._route = ways.route_again(start)
        self._age_s, self._at = 0.0, 0

    def _start(
        self, experiences: ExperienceMap, local: LocalMovement, times: _Array, away: _Array, p: PilotParams
    ) -> int:
        """Where the route starts: where the last one has led to, at the active experience, or over an imagined link at
        one nearby, if that is quicker and neither a bar nor an echo lies between.

        Two passes of one corridor may lie farther from each other on the map than an imagined link may reach. Who follows
        the one beside the other keeps to it; to leave it would be to turn back, to where it sees that pass again.
        test_routes.py::test_a_route_beside_it_is_kept.

        times: to the goal, s; away: from the robot, m; (n,) each.
        """
        robot, poses, active = experiences.robot, experiences.poses, experiences.active
        reach = min(NEAR_M + NEAR_GROWTH * self._no_route_s, NEAR_MOST_M)
        near = np.flatnonzero((away < reach) & np.isfinite(times))
        near = near[~self._bars.between(robot.x, robot.y, poses[near, :2])]
        near = np.append(near, active)
        on_route = -1 if self._route is None else int(self._route.experiences[self._at])
        if self._route is not None and away[on_route] < NEAR_MOST_M:
            near = np.append(near, on_route)
        turn = np.abs(wrap_angles(poses[near, 2] - robot.heading_rad))
        cost = times[near] + away[near] / NEAR_SPEED + NEAR_TURN_COST * turn
        cost += (NEAR_COST + NEAR_DOUBT_S * self._bars.failures) * ((near != active) & (near != on_route))
        cost -= STAY_S * (near == on_route)
        for at in np.argsort(cost, kind="stable").tolist():
            if near[at] in (active, on_route) or self._sees(_from_robot(robot, *poses[near[at], :2]), local, p):
                return int(near[at])
        return active

    def _sees(self, place: tuple[float, float], local: LocalMovement, p: PilotParams) -> bool:
        """Whether the sonars, which look ahead and to the sides, find the way to a place (m, robot's frame) free."""
        return place[0] >= 0 and local.free_way(math.atan2(place[1], place[0]), p) >= math.hypot(*place) - NEAR_BLIND_M

    def _succeed(self, experiences: ExperienceMap) -> None:
        """Every link of the route that was driven since the last plan counts as a successful trial."""
        if self._route is None or self._age_s > CREDITED_PLANS * REPLAN_S:
            return
        for i, j in pairwise(self._route.experiences[: self._at + 1]):
            experiences.tried(int(i), int(j), True)

    def _aim(self, experiences: ExperienceMap) -> tuple[float, float]:
        """The route's point `LOOKAHEAD_M` ahead of the robot. Notes how far on the route the robot has come."""
        assert self._route is not None
        robot, nodes = experiences.robot, self._route.experiences
        self._at, to = _along(experiences.poses, nodes, self._at, robot.x, robot.y, WINDOW_M, LOOKAHEAD_M)
        x, y, _ = experiences.poses[nodes[to]]
        return _from_robot(robot, x, y)


def _cut_off(experiences: ExperienceMap, times: _Array) -> str:
    """Why no way leads to where times (n,) s are finite. A link that was deleted is the cause if it led there."""
    ends = np.array(experiences.dropped_links, np.int64).reshape(-1, 2)
    led_there = np.isfinite(times)[ends]
    return "its links were deleted" if (led_there[:, 0] != led_there[:, 1]).any() else "no links lead there"


def _from_robot(robot: Pose2, x: float, y: float) -> tuple[float, float]:
    """A place of the map in the robot's frame, m."""
    c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
    dx, dy = float(x) - robot.x, float(y) - robot.y
    return c * dx + s * dy, -s * dx + c * dy


@njit(cache=True, nogil=True)
def _along(
    poses: _Array, nodes: NDArray[np.int64], at: int, x: float, y: float, window: float, lookahead: float
) -> tuple[int, int]:
    """Where on the route the robot at (x, y) is, on the stretch of length `window` from `at`: the nearest node, of
    equals the last. And the first node more than `lookahead` farther on. All lengths in m."""
    here, least, way = at, np.inf, 0.0
    for k in range(at, len(nodes)):
        if k > at:
            way += math.hypot(poses[nodes[k], 0] - poses[nodes[k - 1], 0], poses[nodes[k], 1] - poses[nodes[k - 1], 1])
        if way > window:
            break
        away = math.hypot(poses[nodes[k], 0] - x, poses[nodes[k], 1] - y)
        if away <= least:
            here, least = k, away
    to, way = here, 0.0
    while to < len(nodes) - 1 and way <= lookahead:
        to += 1
        way += math.hypot(poses[nodes[to], 0] - poses[nodes[to - 1], 0], poses[nodes[to], 1] - poses[nodes[to - 1], 1])
    return here, to


@kind("headway/2")
class Headway:
    """Whether the robot gets on along its route, judged by its own odometry.

    `blocked`: it has come no nearer for `TRIAL_S`. `astray`: it has not left the place for `NO_HEADWAY_S`. [ours] The
    time that a link was learnt to take is no measure: floor may be slow, the map may be bent, and the time left jumps
    with each new plan. What counts is by how much the robot itself has come nearer to the points it headed for.
    test_headway.py::{test_slow_is_not_blocked, test_a_robot_that_comes_no_nearer_fails,
    test_turning_towards_the_way_is_headway_but_not_for_ever}.
    """

    def __init__(self) -> None:
        self._aim: tuple[float, float] | None = None  # the point headed for, m, robot's frame
        self._stay = Stay()
        self.begin()

    def begin(self) -> None:
        """A new trial begins."""
        self._nearer_m = self._most_m = 0.0  # how much nearer it has come in all, and at most
        self._least_turn = math.inf  # to the aim, rad
        self._still_s = 0.0

    def leave(self) -> None:
        """It goes elsewhere for a while: count its stay from now."""
        self._stay.leave()
        self.begin()

    def blocked(self) -> bool:
        return self._still_s > TRIAL_S

    def astray(self) -> bool:
        return self._stay.seconds > NO_HEADWAY_S

    def head_for(self, aim: tuple[float, float] | None) -> None:
        """aim: the next point (m, robot's frame), None for no route."""
        self._aim = aim

    def move(self, odometry: Odometry, trying: bool) -> None:
        """The robot moved; called in every tick. trying: whether it drove towards the aim, and did not back out."""
        step, turn = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        self._stay.move(odometry)
        if self._aim is None:
            return
        x, y = self._aim
        away = math.hypot(x, y)
        x, y = x - step * math.cos(turn / 2), y - step * math.sin(turn / 2)
        c, s = math.cos(turn), math.sin(turn)
        self._aim = c * x + s * y, -s * x + c * y
        self._nearer_m += away - math.hypot(x, y)
        self._still_s += odometry.dt * trying
        bearing = abs(math.atan2(self._aim[1], self._aim[0]))
        if self._nearer_m > self._most_m + HEADWAY_M:
            self._most_m, self._least_turn, self._still_s = self._nearer_m, bearing, 0.0
        elif bearing < self._least_turn - HEADWAY_RAD:
            self._least_turn, self._still_s = bearing, 0.0
