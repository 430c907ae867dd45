"""The recent paths of the robot (true) and of the winning packet."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from app.views.arrays import frozen
from disk import kind

TRAIL_S = 120.0  # of driving
RECORDED_S = 1800.0  # of a recording with truth, which has no office beside its true path
STILL_M, STILL_CELLS = 0.005, 0.02  # smaller movements add no point


@kind("trails/1")
class Trails:
    """Call `watch` after each tick. A trail is the same object as long as nothing is added to it."""

    CACHES = ("_session",)

    def __init__(self, session: Session) -> None:
        self._session = session
        self._most = int((TRAIL_S if session.recording is None else RECORDED_S) / session.frame.dt) // 2
        self.robot = _no_points(2)  # true path, (t, 2), office frame
        self.packet = _no_points(3)  # of the winning packet, (p, 3): x', y' (cells), heading (rad)

    def settle(self, session: Session) -> None:
        """Go on in a history that was restored."""
        self._session = session
        self.robot, self.packet = frozen(self.robot), frozen(self.packet)

    def watch(self) -> None:
        session = self._session
        if session.tick_count % 2 == 0:
            truth, packet = session.truth, session.estimate.packet
            if truth is not None:
                self.robot = grown(self.robot, (truth.x, truth.y), self._most, STILL_M)
            self.packet = grown(self.packet, (packet.x, packet.y, packet.heading_rad), self._most, STILL_CELLS)


def _no_points(columns: int) -> NDArray[np.float32]:
    return frozen(np.zeros((0, columns), np.float32))


def grown(path: NDArray[np.float32], point: tuple[float, ...], most: int, still: float) -> NDArray[np.float32]:
    """`path` with `point` added, the last `most` points; `path` itself if the point is within `still` of its end."""
    if len(path) and math.dist(path[-1].tolist(), point) < still:
        return path
    return frozen(np.vstack([path[max(0, len(path) + 1 - most) :], np.array([point], np.float32)]))
