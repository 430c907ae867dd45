"""What is kept of a second brain for people to look at: its packet's path, its last snap, its errors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.companion import Companion
from app.session import Session
from app.views.arrays import frozen
from app.views.map_turn import map_turn
from app.views.series import ERROR_POINTS
from app.views.trails import STILL_CELLS, TRAIL_S, grown
from disk import kind
from ratslam_core import Packet

EVERY_S = 1.0  # simulated time between two measurements of the errors


@kind("beside_history/1")
class BesideHistory:
    """Call `watch` after each tick."""

    def __init__(self, session: Session, companion: Companion) -> None:
        self.of = companion
        self._most = int(TRAIL_S / session.frame.dt) // 2
        self.path: NDArray[np.float32] = frozen(np.zeros((0, 3), np.float32))  # of the winning packet, as in `Trails`
        self.last_snap: tuple[float, Packet, Packet] | None = None  # when, from, to
        self._before: Packet | None = None
        self.error_map_m: float | None = None
        self.map_turn_rad = 0.0
        self._due_s = 0.0

    def settle(self) -> None:
        """Go on after it was restored."""
        self.path = frozen(self.path)

    def watch(self, session: Session) -> None:
        estimate = self.of.estimate
        assert estimate is not None
        packet = estimate.packet
        if estimate.relocalised and self._before is not None:
            self.last_snap = session.time_s, self._before, packet
        self._before = packet
        if session.tick_count % 2 == 0:
            self.path = grown(self.path, (packet.x, packet.y, packet.heading_rad), self._most, STILL_CELLS)
        if session.time_s >= self._due_s:
            self._measure(session)

    def _measure(self, session: Session) -> None:
        self._due_s = session.time_s + EVERY_S
        evaluation, map_ = self.of.evaluation, self.of.brain.experience_map
        if session.truth is not None:
            self.error_map_m = evaluation.errors(map_, max(1, session.tick_count // ERROR_POINTS))[0]
        self.map_turn_rad = map_turn(self.map_turn_rad, evaluation, map_, session.truth)
