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
    ways = experiences.submap_of[: experiences.evidence.known] == row[SUBMAP]
    return along(Pose2(float(row[X]), float(row[Y]), float(row[HEADING])), experiences.poses[: len(ways)], ways, p)


def along(robot: Pose2, poses: NDArray[np.float64], ways: NDArray[np.bool_], p: PilotParams) -> tuple[float, float]:
    """The next point, metres in the robot's frame, along the old way that is reached and faced soonest.

    poses: (n, 3), one after the other as they were driven; ways: (n,), those that count, one at least.
    """
    away = np.hypot(poses[:, 0] - robot.x, poses[:, 1] - robot.y)
    turn = np.abs(wrap_angles(poses[:, 2] - robot.heading_rad))
    nearest = int(np.argmin(np.where(ways, away / p.cruise_speed + turn / p.turn_rate, np.inf)))
    ahead = _ahead(nearest, poses, ways, away)
    point = Pose2(*poses[ahead].tolist()).compose(Pose2(max(0.0, AHEAD_M - float(away[ahead])), 0.0, 0.0))
    here = robot.inverse().compose(point)
    return here.x, here.y


def _ahead(experience: int, poses: NDArray[np.float64], ways: NDArray[np.bool_], away: NDArray[np.float64]) -> int:
    """The experience that was made after this one as the robot drove on, where that is `AHEAD_M` away or the way ends."""
    while away[experience] < AHEAD_M and experience + 1 < len(ways) and ways[experience + 1]:
        step = poses[experience + 1, :2] - poses[experience, :2]
        if math.hypot(*step.tolist()) > AHEAD_M:
            break
        experience += 1
    return experience
