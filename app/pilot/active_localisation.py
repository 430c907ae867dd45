"""[ours] Finding out where it is: a robot that was carried drives along a way that it drove before, if it is where it believes.

A view is recognised where it was seen before, and from the same side. To wait until exploring leads there takes time; a robot
that acts on its likeliest hypothesis either sees soon what it expects, or that it is not there: active localisation, as by
Fox, Burgard and Thrun (1998), with one hypothesis and no look ahead. It goes on until the submaps are merged, but explores
while more has spoken against each place than for it: then it is perhaps on new ground.
test_active_localisation.py.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.pilot.params import PilotParams
from ratslam_core import ExperienceMap, Pose2, wrap_angles
from ratslam_core.extensions.evidence import HEADING, ODDS, PRIOR, SUBMAP, X, Y

AHEAD_M = 0.8  # along the old way it heads for what is so far from where it may be


def active_aim(experiences: ExperienceMap, p: PilotParams) -> tuple[float, float] | None:
    """The next point to head for, metres in the robot's frame; None: it was not carried, or may be anywhere."""
    rows = experiences.evidence.hypotheses
    if not experiences.carried or not len(rows):
        return None
    row = rows[np.argmax(rows[:, ODDS])]
    if row[ODDS] < PRIOR:  # more has spoken against it than for it
        return None
    ways = np.flatnonzero(experiences.submap_of[: experiences.evidence.known] == row[SUBMAP])
    if not len(ways):  # carried again before it had mapped anything: the submap that it was on is empty
        return None
    robot, poses = Pose2(float(row[X]), float(row[Y]), float(row[HEADING])), experiences.poses
    return next_on(soonest(robot, poses, ways, p), robot, poses, ways)


def soonest(robot: Pose2, poses: NDArray[np.float64], ways: NDArray[np.int64], p: PilotParams) -> int:
    """Of these experiences (k,), one at least, the place in the list of the one that is reached and faced soonest."""
    x, y, heading = poses[ways].T
    turn = np.abs(wrap_angles(heading - robot.heading_rad))
    return int(np.argmin(np.hypot(x - robot.x, y - robot.y) / p.cruise_speed + turn / p.turn_rate))


def next_on(at: int, robot: Pose2, poses: NDArray[np.float64], ways: NDArray[np.int64]) -> tuple[float, float]:
    """The next point, metres in the robot's frame, along the old way, `AHEAD_M` away or where it ends.

    poses: (n, 3), one after the other as they were driven; ways: (k,), ascending, those that count; at: where in that list it is.
    """
    while (away := math.hypot(poses[ways[at], 0] - robot.x, poses[ways[at], 1] - robot.y)) < AHEAD_M:
        if at + 1 == len(ways) or ways[at + 1] != ways[at] + 1:
            break
        step = poses[ways[at + 1], :2] - poses[ways[at], :2]
        if math.hypot(*step.tolist()) > AHEAD_M:
            break
        at += 1
    point = Pose2(*poses[ways[at]].tolist()).compose(Pose2(max(0.0, AHEAD_M - away), 0.0, 0.0))
    here = robot.inverse().compose(point)
    return here.x, here.y
