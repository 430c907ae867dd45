"""[ours] Headway: whether the robot gets on along its route, judged by its own odometry.

The time that a link was learnt to take is no measure: floor may be slow, the map may be bent, and the time left jumps
with each new plan. What counts is by how much the robot itself has come nearer to the points it headed for.
test_headway.py::{test_slow_is_not_blocked, test_a_robot_that_comes_no_nearer_fails,
test_turning_towards_the_way_is_headway_but_not_for_ever}.
"""

from __future__ import annotations

import math

from app.pilot.params import RouteParams
from disk import kind
from ratslam_core import Odometry


@kind("headway/1")
class Headway:
    """`blocked`: it has come no nearer for `trial_s`. `astray`: it has not left the place for `no_headway_s`."""

    def __init__(self) -> None:
        self._aim: tuple[float, float] | None = None  # the point headed for, m, robot's frame
        self._off_x = self._off_y = self._heading = 0.0  # by odometry, since it last left a place
        self._stays_s = 0.0  # time since then
        self.begin()

    def begin(self) -> None:
        """A new trial begins."""
        self._nearer_m = self._most_m = 0.0  # how much nearer it has come in all, and at most
        self._least_turn = math.inf  # to the aim, rad
        self._still_s = 0.0

    def leave(self) -> None:
        """It goes elsewhere for a while: count its stay from now."""
        self._stays_s = self._off_x = self._off_y = 0.0
        self.begin()

    def blocked(self, p: RouteParams) -> bool:
        return self._still_s > p.trial_s

    def astray(self, p: RouteParams) -> bool:
        return self._stays_s > p.no_headway_s

    def head_for(self, aim: tuple[float, float] | None) -> None:
        """aim: the next point (m, robot's frame), None for no route."""
        self._aim = aim

    def move(self, odometry: Odometry, trying: bool, p: RouteParams) -> None:
        """The robot moved; called in every tick. trying: whether it drove towards the aim, and did not back out."""
        step, turn = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        middle = self._heading + turn / 2
        self._heading += turn
        self._off_x += step * math.cos(middle)
        self._off_y += step * math.sin(middle)
        self._stays_s += odometry.dt
        if math.hypot(self._off_x, self._off_y) > p.place_m:
            self._stays_s = self._off_x = self._off_y = 0.0
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
        if self._nearer_m > self._most_m + p.headway_m:
            self._most_m, self._least_turn, self._still_s = self._nearer_m, bearing, 0.0
        elif bearing < self._least_turn - p.headway_rad:
            self._least_turn, self._still_s = bearing, 0.0
