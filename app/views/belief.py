"""How sure the robot is of its place, where else it may be, and what it let go."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from ratslam_core import ExperienceMap, Pose2
from ratslam_core.extensions.evidence import ODDS, SUBMAP
from web.messages import Belief, Hypothesis

POSSIBLE = 3.0  # nats: a place that is twenty times less likely than the likeliest, or than a new one, is not counted
MOST_LOG_ODDS = 14.0  # a million to one is enough
MOST_OTHERS = 4  # places that are shown beside that where it believes itself to be
HELD_M = 1.0  # a place stands for a state of the pose cells if an experience is so near
LEAST_SHARE = 0.02  # how likely a place must be before one is shown that a robot in doubt may be at


def belief_of(session: Session) -> Belief:
    brain = session.brain
    map_ = brain.experience_map
    return Belief(
        off_m=math.inf if map_.carried else map_.off_m,
        others=other_places(map_),
        corrected=map_.corrected,
        apart=int(np.count_nonzero(map_.island_of != map_.islands.current)),
        joined=map_.islands.joined,
        spared=map_.ground.spared,
        links_spared=map_.ground.links_spared,
        forgotten=brain.view_links.forgotten,
        odds=None if map_.belief is None else math.exp(min(map_.belief.log_odds, MOST_LOG_ODDS)),
        places=len(possible_places(map_)),
    )


def possible_places(map_: ExperienceMap) -> NDArray[np.float64]:
    """x, y (m), heading (rad) of the places where a robot that was carried may be, the likeliest first, shape (n, 3)."""
    if not map_.carried:
        return np.zeros((0, 3))
    rows = map_.evidence.hypotheses
    likely = rows[np.argsort(-rows[:, ODDS], kind="stable")]
    return likely[likely[:, ODDS] > likely[:1, ODDS].max(initial=0.0) - POSSIBLE][:, :3].copy()


def other_places(map_: ExperienceMap) -> tuple[Hypothesis, ...]:
    """Where a robot that was carried, or is in doubt, may be instead of where it believes itself to be, the likeliest first."""
    rows, beside = map_.evidence.weighed(map_.robot_here)
    if not len(rows) or not (map_.carried or map_.evidence.in_doubt):
        return ()
    all_odds = np.append(rows[:, ODDS], beside)
    every = np.exp(all_odds - np.logaddexp.reduce(all_odds))
    shares = every[: len(rows)]
    here, found = map_.robot, list[Hypothesis]()
    least = every.max() * math.exp(-POSSIBLE) if map_.carried else LEAST_SHARE
    for k in np.argsort(-shares, kind="stable").tolist():
        x, y, heading = rows[k, :3].tolist()
        if shares[k] >= least and math.hypot(x - here.x, y - here.y) > 1e-6:
            state = state_of(map_, Pose2(x, y, heading), int(rows[k, SUBMAP]))
            found.append(Hypothesis(x, y, heading, float(shares[k]), state))
    return tuple(found[:MOST_OTHERS])


def state_of(map_: ExperienceMap, place: Pose2, submap: int) -> tuple[float, float, float] | None:
    """The state of the pose cells of the nearest experience of this submap, moved by as much as the place is beside it."""
    own = np.flatnonzero(map_.island_of == submap)
    apart = np.hypot(map_.poses[own, 0] - place.x, map_.poses[own, 1] - place.y)
    if not len(own) or apart.min() > HELD_M:
        return None
    near = int(own[np.argmin(apart)])
    x, y, theta, _ = map_.cell_state(near)
    beside = map_.pose(near).inverse().compose(place)
    facing = theta * math.tau / map_.shape[0]
    state = Pose2(x * map_.cell_m, y * map_.cell_m, facing).compose(beside)
    return state.x / map_.cell_m, state.y / map_.cell_m, state.heading_rad
