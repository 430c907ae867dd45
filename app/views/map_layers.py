"""The experience map and the times over it, rebuilt only as often as people can see a change."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from app.evaluation import Evaluation
from app.views.arrays import frozen
from ratslam_core import CellsOnly, ExperienceMap
from web.messages import NO_PLACES, MapLayer, TimesLayer

MAP_EVERY_S = 0.5  # of wall time
TIMES_EVERY_S = 0.25


class MapLayers:
    """The map and the times over it. Row i of both belongs to the same experience."""

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
    """(4, 2) corners of where it has believed to be; where nobody has followed it, of the whole network around its start."""
    _, way, _ = evaluation.trajectories(cells)
    if len(way):
        low, high = way.min(0), way.max(0)
    else:
        _, n_y, n_x = cells.shape
        high = np.array([n_x, n_y]) * cells.cell_m / 2
        low = -high
    corners = np.array([(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])])
    return frozen(corners.astype(np.float32))
