"""How sure the robot is of its place, what it doubts, and what it let go."""

from __future__ import annotations

import numpy as np

from app.session import Session
from web.messages import Belief, Pose


def belief_of(session: Session) -> Belief:
    brain = session.brain
    map_ = brain.experience_map
    other = map_.gate.hypothesis(map_.robot)
    return Belief(
        off_m=map_.pose_filter.sigma_m,
        other=None if other is None else Pose(other.x, other.y, other.heading_rad),
        sights=map_.gate.sights,
        needed=map_.gate.needed,
        corrected=map_.corrected,
        apart=int(np.count_nonzero(map_.island_of != map_.islands.current)),
        joined=map_.islands.joined,
        spared=map_.ground.spared,
        links_spared=map_.ground.links_spared,
        forgotten=brain.view_links.forgotten,
    )
