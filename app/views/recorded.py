"""What people are shown of a recording: what it says of itself, and the ground of its true path, if it brings one."""

from __future__ import annotations

import numpy as np

from app.recordings.recording import About
from app.session import Session
from app.views.arrays import frozen
from app.views.history import Trails
from web.messages import RecordingView, WorldDrawing

LEAST_M = 4.0  # half the side of the ground at the beginning
MARGIN = 0.3  # of its size, that the ground grows beyond the path, so that it seldom has to be drawn anew
MARK = 0.014  # the robot's radius as a share of the ground: how large the recorded robot is, nobody says

Bounds = tuple[float, float, float, float]


def recording_view(about: About, over: bool) -> RecordingView:
    return RecordingView(about.name, about.format, about.moments, about.seconds, tuple(sorted(about.has)), over)


def no_room(_x: float, _y: float) -> str:
    """Why a recorded robot cannot be put anywhere."""
    return "a recording plays: its robot cannot be carried away"


class TruthFloor:
    """An empty ground without walls that grows with the true path. None as long as the recording tells no truth."""

    def __init__(self) -> None:
        self._drawn: WorldDrawing | None = None

    def look(self, session: Session, trails: Trails) -> WorldDrawing | None:
        truth = session.truth
        if truth is None:
            return self._drawn
        points = np.vstack([trails.robot, [(truth.x, truth.y)]])
        if self._drawn is None:
            bounds = truth.x - LEAST_M, truth.y - LEAST_M, truth.x + LEAST_M, truth.y + LEAST_M
            self._drawn = _ground(session, bounds)
        elif not _holds(self._drawn.bounds, points):
            self._drawn = _ground(session, _grown(self._drawn.bounds, points))
        return self._drawn


def _holds(bounds: Bounds, points: np.ndarray) -> bool:
    return bool((points.min(0) >= bounds[:2]).all() and (points.max(0) <= bounds[2:]).all())


def _grown(bounds: Bounds, points: np.ndarray) -> Bounds:
    low, high = np.minimum(points.min(0), bounds[:2]), np.maximum(points.max(0), bounds[2:])
    more = MARGIN * (high - low).max()
    low = np.where(low < bounds[:2], low - more, low)
    high = np.where(high > bounds[2:], high + more, high)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _ground(session: Session, bounds: Bounds) -> WorldDrawing:
    name = session.source.name
    none = frozen(np.zeros(0, np.float32))
    return WorldDrawing(
        name=name,
        title=name,
        bounds=bounds,
        walls=frozen(np.zeros((0, 4), np.float32)),
        wall_height_m=none,
        wall_kind=(),
        panels=frozen(np.zeros((0, 6), np.float32)),
        panel_rgb=frozen(np.zeros((0, 3), np.uint8)),
        places=(),
        robot_radius_m=MARK * max(bounds[2] - bounds[0], bounds[3] - bounds[1]),
        camera_fov_rad=session.config.local_view.field_of_view,
        sonar_angles_rad=none,
        is_office=False,
    )
