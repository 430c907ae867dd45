"""Where the camera stands for each view, and how it flies there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

View = Literal["all", "office", "pose", "map"]
VIEWS: tuple[View, ...] = get_args(View)
NEAR, FAR = 1.0, 300.0
FLIGHT_S = 0.7
PHONE_ASPECT = 0.85  # width over height below which a screen counts as a phone's


@dataclass(frozen=True)
class Framing:
    """A box of half width and half height around a point, seen from an elevation and an azimuth."""

    look_at: tuple[float, float, float]
    half_width: float
    half_height: float
    elevation_deg: float
    azimuth_deg: float
    fov_deg: float


@dataclass(frozen=True, eq=False)
class Camera:
    position: NDArray[np.float64]
    look_at: NDArray[np.float64]
    fov_rad: float


_WIDE = {
    "all": Framing((0.0, 1.95, 0.0), 14.4, 10.3, 48, 0, 29),
    "office": Framing((-5.85, -2.75, 0.0), 6.8, 5.0, 50, 0, 30),
    "pose": Framing((0.1, 7.7, 1.6), 6.2, 5.9, 42, -22, 30),
    "map": Framing((5.85, -2.45, 0.2), 6.8, 5.1, 54, 0, 30),
}
_TALL = {
    "all": Framing((0.0, 1.95, 0.6), 12.4, 10.3, 52, 0, 29),
    "office": Framing((-5.85, -2.6, 0.2), 6.1, 5.2, 58, 0, 30),
    "pose": Framing((0.1, 7.7, 1.9), 5.6, 5.9, 46, -10, 30),
    "map": Framing((5.85, -2.4, 0.2), 6.1, 5.2, 60, 0, 30),
}


ALONE_HALF_WIDTH = (
    6.9  # of all plates when there is no office: the map then stands in the middle, before the pose cells
)


def camera_for(view: View, aspect: float, office: bool = True) -> Camera:
    """aspect: width over height of the visible canvas. office: whether there is one, else the others have its room."""
    framings = _TALL if aspect < PHONE_ASPECT else _WIDE
    framing = framings[view]
    if not office and view in ("all", "office"):
        framing = replace(framings["all"], half_width=ALONE_HALF_WIDTH)
    elif not office and view == "map":
        framing = replace(framing, look_at=(0.0, *framing.look_at[1:]))
    fov, up, turn = (math.radians(d) for d in (framing.fov_deg, framing.elevation_deg, framing.azimuth_deg))
    half = math.tan(fov / 2)
    distance = max(framing.half_width / (half * max(aspect, 0.1)), framing.half_height / half)
    direction = np.array([math.sin(turn) * math.cos(up), -math.cos(turn) * math.cos(up), math.sin(up)])
    look_at = np.array(framing.look_at)
    return Camera(look_at + distance * direction, look_at, fov)


def seen_by(camera: Camera, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(n, 2) right and up in the plane through `look_at`, and (n,) how much larger each point appears than in that plane."""
    ahead = camera.look_at - camera.position
    distance = float(np.linalg.norm(ahead))
    ahead = ahead / distance
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    offset = points - camera.position
    larger = distance / (offset @ ahead)
    return np.column_stack([offset @ right, offset @ np.cross(right, ahead)]) * larger[:, None], larger


@dataclass
class Flight:
    """A flight from one camera to another, slow at both ends."""

    start: Camera
    end: Camera
    began_s: float

    def at(self, now_s: float) -> tuple[Camera, bool]:
        """The camera now, and whether it has arrived."""
        share = min(max((now_s - self.began_s) / FLIGHT_S, 0.0), 1.0)
        ease = share * share * (3 - 2 * share)

        def blend(a: Any, b: Any) -> Any:
            return a + (b - a) * ease

        camera = Camera(
            blend(self.start.position, self.end.position),
            blend(self.start.look_at, self.end.look_at),
            blend(self.start.fov_rad, self.end.fov_rad),
        )
        return camera, share >= 1.0
