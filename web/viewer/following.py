"""A camera that goes with the robot. It keeps the direction and distance that the hand gave it, and rests while that moves it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from web.viewer.camera_views import Camera

Point = NDArray[np.float64]  # (3,)

ELEVATION_DEG, FOV_DEG = 52.0, 30.0
NEAR_M, LEAST, MOST = 6.0, 1.4, 4.2  # half the width that is seen: metres, but between so many plate units
EASE_S = 0.4  # how long the camera lags behind
REST_S = 0.6  # after the hand has moved it
TURNED = 0.01  # a share of the distance: a camera whose direction differs by more was moved by hand
STEP = 0.004  # plate units: smaller steps are not sent


def follow_camera(at: Point, scale: float, aspect: float) -> Camera:
    """Where a camera begins to follow. scale: plate units a metre; aspect: width over height of the canvas."""
    half_width = min(max(NEAR_M * scale, LEAST), MOST)
    half, up = math.tan(math.radians(FOV_DEG) / 2), math.radians(ELEVATION_DEG)
    distance = half_width / (half * _counted(aspect))
    return Camera(at + distance * np.array([0.0, -math.cos(up), math.sin(up)]), at.copy(), math.radians(FOV_DEG))


def _counted(aspect: float) -> float:
    """A canvas that is wider than this shows more at the sides, not less in height."""
    return min(max(aspect, 0.5), 1.6)


@dataclass
class Follower:
    """One camera that follows on one plate."""

    plate: str  # "office" or "map"
    at: Point  # where it looks
    offset: Point  # from there to the camera
    fov_rad: float
    last_s: float
    rests_until_s: float = -math.inf

    def reshaped(self, before: float, aspect: float) -> Camera:
        """Where the camera should be now that the canvas has another aspect: as much is seen from side to side."""
        self.offset = self.offset * (_counted(before) / _counted(aspect))
        return Camera(self.at + self.offset, self.at, self.fov_rad)

    def heard(self, position: Point, look_at: Point, now_s: float) -> None:
        """The browser reports its camera. If it is turned or nearer than we put it, that was the hand, which is obeyed."""
        offset = position - look_at
        if np.linalg.norm(offset - self.offset) > TURNED * np.linalg.norm(self.offset):
            self.offset, self.rests_until_s = offset, now_s + REST_S

    def step(self, robot: Point, now_s: float) -> Camera | None:
        """Where the camera should be now; None: it stays."""
        dt, self.last_s = min(max(now_s - self.last_s, 0.0), 0.5), now_s
        if now_s < self.rests_until_s:
            return None
        towards = (robot - self.at) * (1 - math.exp(-dt / EASE_S))
        if np.linalg.norm(robot - self.at) < STEP:
            return None
        self.at = self.at + towards
        return Camera(self.at + self.offset, self.at, self.fov_rad)
