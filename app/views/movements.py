"""The local movements that the robot tried in this tick, for the floor of the office."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from app.session import Session
from app.views.arrays import frozen
from ratslam_core import Pose2
from ratslam_core.pose_graph.preintegrated import moved_by
from web.messages import Movements


def movements_of(session: Session) -> Callable[[], Movements] | None:
    """Draws them, in any thread and only if somebody wants to see them. None: the robot chose no arc in this tick.

    They begin where the robot chose, which is a tick ago; its odometry since then tells where that was.
    """
    look = session.pilot.look_at_choice()
    if look is None:
        return None
    truth = session.simulator.truth
    start = Pose2(truth.x, truth.y, truth.heading_rad).compose(moved_by(session.odometry).inverse())

    def draw() -> Movements:
        found = look()
        c, s = np.cos(start.heading_rad), np.sin(start.heading_rad)
        paths = found.paths @ np.array([(c, s), (-s, c)]) + (start.x, start.y)
        return Movements(
            frozen(paths.astype(np.float32)),
            frozen(found.length_m.astype(np.float32)),
            frozen(found.turned_rad.astype(np.float32)),
            start.heading_rad,
            frozen(found.speed > 0),
            frozen(np.isfinite(found.cost)),
            found.chosen,
        )

    return draw
