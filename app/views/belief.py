"""How sure the robot is of its place, what it doubts, and what it let go."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from ratslam_core import ExperienceMap, Pose2
from ratslam_core.extensions.evidence import ODDS
from web.messages import Belief, Pose

POSSIBLE = 3.0  # nats: a place that is twenty times less likely than the likeliest is not counted
MOST_LOG_ODDS = 14.0  # a million to one is enough


def belief_of(session: Session) -> Belief:
    brain = session.brain
    map_ = brain.experience_map
    other, places = other_place(map_), possible_places(map_)
    return Belief(
        off_m=math.inf if map_.carried else map_.pose_filter.sigma_m,
        other=None if other is None else Pose(other.x, other.y, other.heading_rad),
        sights=map_.gate.sights,
        needed=map_.gate.needed,
        corrected=map_.corrected,
        apart=int(np.count_nonzero(map_.island_of != map_.islands.current)),
        joined=map_.islands.joined,
        spared=map_.ground.spared,
        links_spared=map_.ground.links_spared,
        forgotten=brain.view_links.forgotten,
        odds=None if map_.belief is None else math.exp(min(map_.belief.log_odds, MOST_LOG_ODDS)),
        places=len(places),
    )


def possible_places(map_: ExperienceMap) -> NDArray[np.float64]:
    """x, y (m), heading (rad) of the places where a robot that was carried may be, the likeliest first, shape (n, 3)."""
    if not map_.carried:
        return np.zeros((0, 3))
    rows = map_.evidence.hypotheses
    likely = rows[np.argsort(-rows[:, ODDS], kind="stable")]
    return likely[likely[:, ODDS] > likely[:1, ODDS].max(initial=-math.inf) - POSSIBLE][:, :3].copy()


def other_place(map_: ExperienceMap) -> Pose2 | None:
    """Where the robot may be instead: the likeliest place that it does not believe, or where looks that it holds back put it."""
    if not map_.carried:
        return map_.gate.hypothesis(map_.robot)
    here = map_.robot
    away = [Pose2(*row) for row in possible_places(map_).tolist()]
    return next((pose for pose in away if math.hypot(pose.x - here.x, pose.y - here.y) > 1e-6), None)
