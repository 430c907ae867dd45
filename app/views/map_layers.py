"""The experience map and the times over it, rebuilt only as often as people can see a change."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from app.views.arrays import frozen
from ratslam_core import CellsOnly, ExperienceMap
from web.messages import NO_PLACES, MapLayer, TimesLayer

MAP_EVERY_S = 0.5  # of wall time
TIMES_EVERY_S = 0.25


class MapLayers:
    """The map and the times over it. Row i of both belongs to the same experience."""

    def __init__(self, experiences: Callable[[], ExperienceMap], goals: Callable[[], tuple[int, ...]]) -> None:
        """experiences: the map as it is now; goals: those to which times are wanted, none: those from the robot."""
        self._experiences, self._goals = experiences, goals
        self._map: MapLayer | None = None
        self._times: TimesLayer | None = None
        self._goals_timed: tuple[int, ...] = ()
        self._map_due = self._times_due = -math.inf

    def refresh(self) -> None:
        self._map_due = self._times_due = -math.inf

    def layers(self) -> tuple[MapLayer, TimesLayer]:
        now = time.perf_counter()
        if self._map is None or now >= self._map_due:
            self._map = map_layer(self._experiences())
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


def map_layer(experiences: ExperienceMap) -> MapLayer:
    """The map as it is now."""
    poses = experiences.poses.astype(np.float32)
    return MapLayer(
        frozen(np.arange(len(poses), dtype=np.int32)),
        frozen(np.ascontiguousarray(poses[:, :2])),
        frozen(np.ascontiguousarray(poses[:, 2])),
        frozen(experiences.links.astype(np.int32)),
        _cells(experiences) if isinstance(experiences, CellsOnly) else NO_PLACES,
    )


def _cells(cells: CellsOnly) -> NDArray[np.float32]:
    """(4, 2) corners of the network around where the robot woke up."""
    _, n_y, n_x = cells.shape
    half = np.array([n_x, n_y]) * cells.cell_m / 2
    return frozen((half * [(-1, -1), (1, -1), (1, 1), (-1, 1)]).astype(np.float32))
