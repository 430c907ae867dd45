"""What the switches lay over the plates at a moment, and what is inspected: on the stage and in pictures alike."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import NamedTuple

from web.messages import GoalMemoryLayer, Movements, OccupancyLayer, Report, Snapshot
from web.switches import Name


class Overlaid(NamedTuple):
    """None: it is switched off, or there is none."""

    occupancy: OccupancyLayer | None  # below the map
    beneath: OccupancyLayer | None  # the same below the pose cells
    goal_memory: GoalMemoryLayer | None
    movements: Callable[[], Movements] | None
    inspected: Report | None


def overlaid(snapshot: Snapshot, on: Collection[Name]) -> Overlaid:
    """on: the switches that are on."""
    alone = snapshot.beside is None  # of two brains, both are drawn alike
    return Overlaid(
        snapshot.occupancy if alone and "occupancy" in on else None,
        snapshot.occupancy if "cell_occupancy" in on else None,
        snapshot.goal_memory if alone and "goal_memory" in on else None,
        snapshot.movements if "movements" in on else None,
        snapshot.inspected,
    )
