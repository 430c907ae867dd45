"""The robot as it would be if it believed its wheels alone: odometry from the start pose on, without a look or a correction."""

from __future__ import annotations

import numpy as np

from app.session import Session
from app.views.arrays import frozen
from app.views.trails import TRAIL_S
from ratslam_core import Pose2
from web.messages import Ghost, Pose

POINTS = 300  # of the path


def ghost_of(session: Session) -> Ghost | None:
    """None without truth: then nobody knows where the run began."""
    if session.truth is None:
        return None
    evaluation = session.evaluation
    ticks = int(TRAIL_S / session.frame.dt)
    path = evaluation.odometry_path(ticks, max(1, ticks // POINTS))
    office, map_ = evaluation.began(session.brain.experience_map)
    return Ghost(shown(evaluation.odometry), frozen(path.astype(np.float32)), shown(office), shown(map_))


def shown(pose: Pose2) -> Pose:
    """A pose of the engine as one that is shown."""
    return Pose(pose.x, pose.y, pose.heading_rad)
