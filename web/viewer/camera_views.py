"""Where the camera stands for each view, and how it flies there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from web.viewer.fits import DEPTH, HEIGHT, SIDE, WIDTH

View = Literal["all", "office", "pose", "map"]
VIEWS: tuple[View, ...] = get_args(View)
NEAR, FAR = 1.0, 300.0
FLIGHT_S = 0.7
PHONE_ASPECT = 0.85  # width over height below which a screen counts as a phone's


@dataclass(frozen=True, eq=False)
class Camera:
    position: NDArray[np.float64]
    look_at: NDArray[np.float64]
    fov_rad: float


Points = NDArray[np.float64]  # (n, 3)
Point3 = tuple[float, float, float]
At = tuple[float, float]  # x, y of a plate
APART = 11.7  # of the middles of two plates
OFFICE_AT, CELLS_AT, MAP_AT = (-APART, 0.0), (0.0, 0.0), (APART, 0.0)


@dataclass(frozen=True)
class Stands:
    """Where the plates stand: the office, and of each brain its pose cells and its map."""

    office: At
    cells: tuple[At, ...]
    maps: tuple[At, ...]


def stands(*, office: bool, two: bool) -> Stands:
    """In a row, from what is there to what it becomes: office, pose cells, map. office: whether there is one; without it, the
    others have its room. Of two brains each has its pose cells behind and its map in front, and the office they share stands
    between."""
    if two:
        beside, back = APART if office else APART / 2, 10.7
        return Stands((0.0, back), ((-beside, back), (beside, back)), ((-APART / 2, 0.0), (APART / 2, 0.0)))
    if not office:
        return Stands(OFFICE_AT, ((-APART / 2, 0.0),), ((APART / 2, 0.0),))
    return Stands(OFFICE_AT, (CELLS_AT,), (MAP_AT,))


def _block(size: tuple[float, float, float], y: float = 0.0) -> Points:
    """(8, 3) corners of a block of this width, depth and height, `y` beyond a plate's place."""
    width, depth, height = size
    corners = [(a * width / 2, y + b * depth / 2, z) for a in (-1, 1) for b in (-1, 1) for z in (0.0, height)]
    return np.array(corners)


SHEET = (11.0, 10.0, -0.5)  # of every plate: width, depth, y of the middle
_PLATE = _block((SHEET[0], SHEET[1], 0.0), SHEET[2])
_CELLS = np.vstack([_PLATE, _block((SIDE, SIDE, HEIGHT))])
_OFFICE = np.vstack([_PLATE, _block((WIDTH + 0.2, DEPTH + 0.2, 0.65))])  # its walls, at their highest


@dataclass(frozen=True)
class _Look:
    """Between which elevations a view may be seen, in a window that is wide and in one that is tall, and from which azimuth."""

    wide_deg: tuple[float, float]
    tall_deg: tuple[float, float]
    azimuth_deg: tuple[float, float]
    fov_deg: float


_FREE = 0.015  # share of the canvas that is left around
_LOOKS: dict[View, _Look] = {
    "all": _Look((42, 60), (50, 72), (0, 0), 29),
    "office": _Look((46, 58), (56, 74), (0, 0), 30),
    "pose": _Look((38, 46), (42, 50), (-22, -10), 30),
    "map": _Look((46, 58), (56, 74), (0, 0), 30),
}
_STEP_DEG = 2.0


@lru_cache(maxsize=256)
def camera_for(view: View, aspect: float, office: bool = True, two: bool = False) -> Camera:
    """aspect: width over height of the visible canvas. office: whether there is one, else the others have its room. two:
    whether two brains stand beside one another.

    The plates are as large as the window allows: of the elevations in question, it takes the one that fills most of it."""
    tall, look = aspect < PHONE_ASPECT, _LOOKS[view if office or view != "office" else "all"]
    low, high = look.tall_deg if tall else look.wide_deg
    points, azimuth_deg = corners_of(view, office, two), 0 if two else look.azimuth_deg[tall]
    found = [
        _fitted(points, elevation, azimuth_deg, look.fov_deg, max(aspect, 0.1))
        for elevation in np.arange(low, high + 1e-9, _STEP_DEG).tolist()
    ]
    return max(found, key=lambda camera: _filled(camera, points))


def corners_of(view: View, office: bool, two: bool) -> Points:
    """What a view shows."""
    at = stands(office=office, two=two)
    cells = np.vstack([_CELLS + np.array((*here, 0.0)) for here in at.cells])
    maps = np.vstack([_PLATE + np.array((*here, 0.0)) for here in at.maps])
    rooms = _OFFICE + np.array((*at.office, 0.0))
    if view in ("pose", "map"):
        return cells if view == "pose" else maps
    if view == "office" and office:
        return rooms
    return np.vstack([cells, maps, rooms] if office else [cells, maps])


def _fitted(points: Points, elevation_deg: float, azimuth_deg: float, fov_deg: float, aspect: float) -> Camera:
    """The nearest camera that looks from there and sees all of (n, 3) points."""
    up_rad, turn = math.radians(elevation_deg), math.radians(azimuth_deg)
    back = np.array([math.sin(turn) * math.cos(up_rad), -math.cos(turn) * math.cos(up_rad), math.sin(up_rad)])
    right = np.array([math.cos(turn), math.sin(turn), 0.0])
    up = np.cross(back, right)
    across, aloft, near = points @ right, points @ up, points @ back
    half = math.tan(math.radians(fov_deg) / 2) * (1 - 2 * _FREE)
    beside = half * aspect
    # a point is seen if  across - x <= beside (distance - near),  and so on for the other three sides
    most_x, least_x = (across + beside * near).max(), (across - beside * near).min()
    most_y, least_y = (aloft + half * near).max(), (aloft - half * near).min()
    distance = max((most_x - least_x) / (2 * beside), (most_y - least_y) / (2 * half))
    middle = right * (most_x + least_x) / 2 + up * (most_y + least_y) / 2
    return Camera(middle + back * distance, middle, math.radians(fov_deg))


def _filled(camera: Camera, points: Points) -> float:
    """The area around all of (n, 3) points, in squares of half the canvas's height."""
    half = math.tan(camera.fov_rad / 2) * float(np.linalg.norm(camera.position - camera.look_at))
    return float(np.ptp(seen_by(camera, points)[0] / half, axis=0).prod())


def seen_by(camera: Camera, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(n, 2) right and up in the plane through `look_at`, and (n,) how much larger each point appears than in that plane."""
    ahead, right, up = _axes(camera)
    offset = points - camera.position
    larger = float(np.linalg.norm(camera.look_at - camera.position)) / (offset @ ahead)
    return np.column_stack([offset @ right, offset @ up]) * larger[:, None], larger


def ray_through(camera: Camera, at: tuple[float, float]) -> tuple[Point3, Point3]:
    """Origin and direction of the ray through a place of what the camera shows: from the middle to the right and
    upwards, in halves of its height."""
    ahead, right, up = _axes(camera)
    x, y, z = (ahead + math.tan(camera.fov_rad / 2) * (at[0] * right + at[1] * up)).tolist()
    eye_x, eye_y, eye_z = camera.position.tolist()
    return (eye_x, eye_y, eye_z), (x, y, z)


def _axes(camera: Camera) -> tuple[Points, Points, Points]:
    """Unit vectors (3,): ahead, to the right, upwards."""
    ahead = camera.look_at - camera.position
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right = right / np.linalg.norm(right)
    return ahead, right, np.cross(right, ahead)


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
