"""The named places of the office, and where the map has those at which the robot has been: for people, who click on names.

Only people know where the names belong. The robot is told a place of its own map, as with any click on the map.
"""

from __future__ import annotations

import numpy as np

from app.session import Session
from web.messages import KnownPlace

REACH_M = 1.5  # an experience that was truly made this near to a place stands for it


def known_places(session: Session) -> tuple[KnownPlace, ...]:
    if session.recording is not None:
        return ()
    poses = session.brain.experience_map.poses
    births = session.evaluation.births(len(poses))
    found: list[KnownPlace] = []
    for place in session.simulator.world.places:
        away = np.hypot(births[:, 0] - place.x, births[:, 1] - place.y)
        near = np.flatnonzero(away <= REACH_M)  # not where an experience was made unknown to us: NaN
        nearest = None if not len(near) else int(near[away[near].argmin()])
        xy = None if nearest is None else (float(poses[nearest, 0]), float(poses[nearest, 1]))
        found.append(KnownPlace(place.name, place.x, place.y, xy))
    return tuple(found)
