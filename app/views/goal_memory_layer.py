"""Times to the goal over the pose cells, as in ACRA 2005."""

from __future__ import annotations

from importlib import import_module

import numpy as np

from app.session import Session
from app.views.arrays import frozen
from web.messages import GoalMemoryLayer

import_module("scipy.sparse.csgraph")  # otherwise the first goal would import it, while the robot drives


def goal_memory_layer(session: Session) -> GoalMemoryLayer:
    memory, goal = session.brain.goal_memory, session.pilot.goal
    if goal is None:
        return GoalMemoryLayer(len(memory), None, None, None)
    x, y, _, _ = session.brain.experience_map.cell_state(goal)
    cell = round(x) % memory.shape[2], round(y) % memory.shape[1]
    times = memory.times_to(*cell)
    direction = memory.direction(times, session.brain.pose_cells.winner)
    return GoalMemoryLayer(len(memory), cell, frozen(times.astype(np.float32)), direction)
