"""The layers of a snapshot: experience map and times over it, occupancy grids, goal memory, and pose cells."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from app.evaluation import Evaluation
from app.session import Session
from app.views.arrays import frozen, packet_of
from app.views.history import History
from ratslam_core import CellsOnly, ExperienceMap
from ratslam_core.pose_cells.network import PoseCells
from web.messages import (
    NO_PLACES,
    GoalMemoryLayer,
    MapLayer,
    OccupancyLayer,
    OccupancyPicture,
    PoseCellLayer,
    Snap,
    TimesLayer,
)

import_module("scipy.sparse.csgraph")  # otherwise the first goal would import it, while the robot drives

MAP_EVERY_S = 0.5  # of wall time
TIMES_EVERY_S = 0.25
STRONGEST = 500


class MapLayers:
    """The map and the times over it, rebuilt as often as people can see a change. Row i of both is one experience."""

    def __init__(
        self,
        experiences: Callable[[], ExperienceMap],
        evaluation: Callable[[], Evaluation],
        goals: Callable[[], tuple[int, ...]],
    ) -> None:
        """experiences: the map as it is now; goals: those to which times are wanted, none: those from the robot."""
        self._experiences, self._evaluation, self._goals = experiences, evaluation, goals
        self._map: MapLayer | None = None
        self._times: TimesLayer | None = None
        self._goals_timed: tuple[int, ...] = ()
        self._map_due = self._times_due = -math.inf

    def refresh(self) -> None:
        self._map_due = self._times_due = -math.inf

    def layers(self) -> tuple[MapLayer, TimesLayer]:
        now = time.perf_counter()
        if self._map is None or now >= self._map_due:
            self._map = map_layer(self._experiences(), self._evaluation())
            self._map_due, self._times_due = now + MAP_EVERY_S, -math.inf
        goals = self._goals()
        if self._times is None or now >= self._times_due or goals != self._goals_timed:
            self._times = self._times_to(goals, len(self._map.ids))
            self._times_due, self._goals_timed = now + TIMES_EVERY_S, goals
        return self._map, self._times

    def _times_to(self, goals: tuple[int, ...], shown: int) -> TimesLayer:
        experiences = self._experiences()
        seconds = experiences.temporal_map.times_to(goals or experiences.active)[:shown].astype(np.float32)
        return TimesLayer(bool(goals), frozen(seconds))


def map_layer(experiences: ExperienceMap, evaluation: Evaluation) -> MapLayer:
    """The map as it is now. evaluation: has the way through it."""
    poses = experiences.poses.astype(np.float32)
    return MapLayer(
        frozen(np.arange(len(poses), dtype=np.int32)),
        frozen(np.ascontiguousarray(poses[:, :2])),
        frozen(np.ascontiguousarray(poses[:, 2])),
        frozen(experiences.links.astype(np.int32)),
        _visited(experiences, evaluation) if isinstance(experiences, CellsOnly) else NO_PLACES,
    )


def _visited(cells: CellsOnly, evaluation: Evaluation) -> NDArray[np.float32]:
    """(4, 2) corners of where it has believed to be; with none to follow it, of the whole network round its start."""
    _, way, _ = evaluation.trajectories(cells)
    if len(way):
        low, high = way.min(0), way.max(0)
    else:
        _, n_y, n_x = cells.shape
        high = np.array([n_x, n_y]) * cells.cell_m / 2
        low = -high
    corners = np.array([(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])])
    return frozen(corners.astype(np.float32))


def occupancy_layer(session: Session) -> OccupancyLayer | None:
    """The grid around the robot, from its sonars, and one that is laid out over the experience map when it is drawn."""
    brain = session.brain
    if brain.occupancy is None or brain.map_grid is None:
        return None
    grid, poses = copy.deepcopy(brain.map_grid), brain.experience_map.poses.copy()

    def draw_map() -> OccupancyPicture:
        drawn = grid.draw(poses)
        return OccupancyPicture(frozen(drawn.probability), drawn.origin_xy_m, drawn.cell_m)

    return OccupancyLayer(frozen(brain.occupancy.probability), draw_map)


def goal_memory_layer(session: Session) -> GoalMemoryLayer:
    """Times to the goal over the pose cells, as in ACRA 2005."""
    memory, goal = session.brain.goal_memory, session.pilot.goal
    if goal is None:
        return GoalMemoryLayer(len(memory), None, None, None)
    x, y, _, _ = session.brain.experience_map.cell_state(goal)
    cell = round(x) % memory.shape[2], round(y) % memory.shape[1]
    times = memory.times_to(*cell)
    direction = memory.direction(times, session.brain.pose_cells.winner)
    return GoalMemoryLayer(len(memory), cell, frozen(times.astype(np.float32)), direction)


def pose_cell_layer(session: Session, history: History) -> PoseCellLayer:
    return layer_of(session.brain.pose_cells, history.trails.packet, history.events.last_snap)


def layer_of(pose_cells: PoseCells, path: NDArray[np.float32], last_snap: Snap | None) -> PoseCellLayer:
    """The strongest pose cells and the packets. path: of the winner, (p, 3): x', y' in cells, heading in rad."""
    cells, activity = pose_cells.active
    strongest = np.argsort(-activity, kind="stable")[:STRONGEST]
    return PoseCellLayer(
        shape=pose_cells.shape,
        cell_m=pose_cells.params.cell_m,
        cells=frozen(np.ascontiguousarray(cells[strongest][:, [2, 1, 0]], np.int32)),
        activity=frozen(activity[strongest]),
        active_cells=len(activity),
        packets=tuple(map(packet_of, pose_cells.packets)),
        path=path,
        last_snap=last_snap,
        total=float(activity.sum(dtype=np.float64)),
        least=float(activity.min()),
    )
