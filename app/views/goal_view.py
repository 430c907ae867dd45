"""Tagged places, the goal and the route to it, with the times at which the robot should pass its experiences."""

from __future__ import annotations

import numpy as np

from app.session import Session, is_lost
from app.views.arrays import frozen
from web.messages import Goal, TaggedPlace


def goal_view(session: Session) -> Goal | None:
    experiences = session.brain.experience_map
    progress = session.pilot.progress(experiences)
    if progress is None:
        return None
    goal = experiences.pose(progress.experience)
    xy = experiences.poses[progress.route, :2]
    return Goal(
        progress.experience, goal.x, goal.y, progress.state, progress.eta_s, progress.remaining_m,
        frozen(xy.astype(np.float32)), frozen(progress.arrival_s.astype(np.float32)),
        frozen(experiences.poses[list(session.pilot.goals), :2].astype(np.float32)),
        is_lost(session), session.pilot.mode == "goal",
    )  # fmt: skip


def tags_view(session: Session) -> tuple[TaggedPlace, ...]:
    poses = session.brain.experience_map.poses
    return tuple(
        TaggedPlace(name, experience, float(poses[experience, 0]), float(poses[experience, 1]))
        for name, experience in session.tags.items()
    )
