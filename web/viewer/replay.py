"""A correction of the map, played again slowly: the experiences go from where they were before a closure to where it put them.

It is drawn on the plate only. The session goes on meanwhile, or stands, and its map is drawn again afterwards.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from web.messages import Closure, Snapshot
from web.viewer.plates.map_plate import MapPlate
from web.viewer.primitives import meshes

BEFORE_S, MOVES_S, AFTER_S = 0.8, 3.0, 1.2
EVERY_S = 1 / 12
WAYS = 240  # experiences whose way is drawn


class Replay:
    """At most one runs at a time."""

    def __init__(self, plate: MapPlate) -> None:
        self._plate = plate
        self._closure: Closure | None = None
        self._began_s = self._due_s = 0.0
        self.ways = plate.scene.add_line_segments(
            f"{plate.root}/replay", meshes.NOWHERE, plate.palette.drawn(plate.palette.packets[3]), thickness=0.035
        )

    @property
    def runs(self) -> bool:
        return self._closure is not None

    def find(self, snapshot: Snapshot | None, event: int, now_s: float) -> None:
        """Starts with the closure of this event; one that is no longer kept is left alone."""
        for closure in () if snapshot is None else snapshot.closures:
            if closure.event == event:
                self.start(closure, now_s)

    def start(self, closure: Closure, now_s: float) -> None:
        self._closure, self._began_s, self._due_s = closure, now_s, now_s

    def stop(self) -> None:
        """It is over with the next `draw`."""
        self._began_s = -math.inf

    def draw(self, now_s: float) -> bool:
        """Draws this moment of it. True when it is over, so that the map as it is must be drawn again."""
        closure = self._closure
        if closure is None:
            return False
        after_s = now_s - self._began_s
        if after_s >= BEFORE_S + MOVES_S + AFTER_S:
            self._closure = None
            self.ways.points = meshes.NOWHERE
            return True
        if now_s >= self._due_s:
            self._due_s = now_s + EVERY_S
            xy = moved(closure, share_at(after_s))
            self._plate.show_replay(xy, closure.links, _title(closure, after_s))
            self.ways.points = self._ways(closure, xy)
        return False

    def _ways(self, closure: Closure, xy: NDArray[np.float64]) -> NDArray[np.float32]:
        """How far the experiences have come that move most."""
        far = np.hypot(*(closure.after_xy - closure.before_xy).T)
        rows = np.sort(np.argsort(-far, kind="stable")[:WAYS])
        rows = rows[far[rows] > 0]
        ends = [meshes.lifted(self._plate.fit.to_plate(p[rows]), 0.04) for p in (closure.before_xy, xy)]
        return meshes.some(np.stack(ends, 1), WAYS)


def share_at(after_s: float) -> float:
    """How much of the correction has been shown so many seconds after the beginning, slow at both ends."""
    share = min(max((after_s - BEFORE_S) / MOVES_S, 0.0), 1.0)
    return share * share * (3 - 2 * share)


def moved(closure: Closure, share: float) -> NDArray[np.float64]:
    """(n, 2) where the experiences are when this share of the correction is done."""
    before, after = np.asarray(closure.before_xy, np.float64), np.asarray(closure.after_xy, np.float64)
    return before + (after - before) * share


def _title(closure: Closure, after_s: float) -> str:
    when = f"{closure.time_s // 60:.0f}:{closure.time_s % 60:02.0f}"
    stage = "before" if after_s < BEFORE_S else "after" if after_s > BEFORE_S + MOVES_S else "being corrected"
    return f"loop closed at {when}: {stage}"
