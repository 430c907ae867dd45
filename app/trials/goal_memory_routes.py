"""Whether the route of the goal memory stays when its three weights change by a fifth. C IV.C: "insensitive to small changes"."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from app.trials.course import Course
    from ratslam_core import GoalMemory
    from ratslam_core.types import Packet


_WEIGHTS = ("time_weight", "activity_weight", "distance_weight")
CHANGES = (0.8, 1.2)
MOST_STEPS = 1000  # cells that a route may be long


class GoalMemoryRoutes:
    """Goal memories with changed weights learn beside the brain's own, and lead from where the robot is to where it began."""

    def __init__(self, course: Course) -> None:
        from ratslam_core import GoalMemory

        self._session = course.session
        brain = self._session.brain
        params, shape, cell_m = brain.params.goal_memory, brain.pose_cells.shape, brain.pose_cells.params.cell_m
        changed = [replace(params, **{name: by * getattr(params, name)}) for name in _WEIGHTS for by in CHANGES]
        self._memories = [GoalMemory(each, shape, cell_m) for each in (params, *changed)]
        self._home = brain.pose_cells.winner
        self._under_way_s = 0.0

    def note(self) -> None:
        """The same that the brain's own memory is given in `RatSlam.step`."""
        brain, odometry = self._session.brain, self._session.odometry
        leap = (self._session.estimate.relocalised or brain.carried) and not brain.params.goal_memory.over_jumps
        moves = not odometry.still
        self._under_way_s += odometry.dt * moves
        for memory in self._memories:
            if leap:
                memory.interrupt()
            if moves:
                memory.learn(*brain.pose_cells.active, self._under_way_s)

    def scores(self) -> dict[str, float]:
        begin = self._session.brain.pose_cells.winner
        base, *others = [_route(memory, begin, self._home) for memory in self._memories]
        off = [_off(route, base) * self._memories[0].cell_m for route in others if len(route) and len(base)]
        if not off:
            return {}
        return {"route_off_m": float(np.mean(off)), "route_off_at_most_m": max(off), "route_cells": float(len(base))}


def _route(memory: GoalMemory, begin: Packet, goal: Packet) -> NDArray[np.float64]:
    """The cells (n, 2) that the directions lead through, a cell a step; empty if they do not lead to the goal."""
    from ratslam_core.goal_memory import ARRIVED

    n_y, n_x = memory.shape[1:]
    times = memory.times_to(round(goal.x) % n_x, round(goal.y) % n_y)
    at, cells = begin, [(begin.x, begin.y)]
    for _ in range(MOST_STEPS):
        bearing = memory.direction(times, at)
        if bearing is None:
            break
        at = replace(at, x=(at.x + math.cos(bearing)) % n_x, y=(at.y + math.sin(bearing)) % n_y)
        cells.append((at.x, at.y))
    away = math.hypot(_apart(at.x, goal.x, n_x), _apart(at.y, goal.y, n_y))
    return np.array(cells) if away <= ARRIVED + 1 else np.zeros((0, 2))


def _off(route: NDArray[np.float64], base: NDArray[np.float64]) -> float:
    """The mean distance of a route's cells from the nearest cell of another route."""
    return float(np.mean([np.hypot(*(base - cell).T).min() for cell in route]))


def _apart(a: float, b: float, ring: int) -> float:
    return (a - b + ring / 2) % ring - ring / 2
