"""Every browser's camera: where it looks, its flights from view to view, its way with the robot, and its framing when the window
changes shape.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import cast

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray

from web.viewer.camera_views import FAR, NEAR, PHONE_ASPECT, Camera, Flight, View, camera_for

Point = NDArray[np.float64]  # (3,)
Robots = dict[str, tuple[Point, float]]  # by plate: where the robot stands in the scene, and plate units a metre
SCREEN_ASPECT = 1.5
RESHAPED = 0.01  # a larger change of aspect needs another framing
WIDER_RAD = 1e-3  # another field of view
TURNED = 0.02  # a camera farther from its view than this has been turned by hand


class Cameras:
    """Runs in the viewer's thread; `post` brings work there from viser's callbacks."""

    def __init__(self, server: viser.ViserServer, post: Callable[[Callable[[], None]], None]) -> None:
        self._server, self._post = server, post
        self._views: dict[int, View] = {}
        self._ends: dict[int, Camera] = {}  # where the last flight of each camera ended or will end
        self._flights: dict[int, Flight] = {}
        self._followers: dict[int, Follower] = {}
        self._office, self._two = True, False  # whether there is one to be seen; whether there are two brains
        camera, initial = camera_for("all", SCREEN_ASPECT), server.initial_camera
        initial.position, initial.look_at, initial.fov = camera.position, camera.look_at, camera.fov_rad
        initial.near, initial.far = NEAR, FAR

    @property
    def flying(self) -> bool:
        return bool(self._flights or self._followers)

    def welcome(self, client: viser.ClientHandle) -> None:
        """A new browser: a phone begins on the map, a screen with all three plates.

        viser's client goes to its initial camera when it has drawn its first frame, which may be after our first
        message. A camera that is found there, and should not be, is sent on once more.
        """
        aspect = _aspect_of(client.camera)
        self.take_off(client.client_id, "map" if aspect < PHONE_ASPECT else "all")

        async def moved(camera: viser.CameraHandle) -> None:
            nonlocal aspect
            self._on_camera(client.client_id, camera)
            if abs(_aspect_of(camera) / aspect - 1) > RESHAPED:
                before, aspect = aspect, _aspect_of(camera)
                self._post(partial(self._reshaped, client, before, aspect))
            elif self._set_back(client.client_id, camera):
                self._post(lambda: self._send_on(client.client_id))

        client.camera.on_update(moved)

    def farewell(self, client_id: int) -> None:
        self._views.pop(client_id, None)
        self._ends.pop(client_id, None)
        self._flights.pop(client_id, None)
        self._followers.pop(client_id, None)

    def reframe(self, client_id: int) -> None:
        if client_id in self._views and client_id not in self._followers:
            self.take_off(client_id, self._views[client_id])

    def _reshaped(self, client: viser.ClientHandle, before: float, aspect: float) -> None:
        if client.client_id in self._followers and client.client_id not in self._flights:
            _point(client, self._followers[client.client_id].reshaped(before, aspect))
        self.reframe(client.client_id)

    def give_room(self, *, office: bool, two: bool = False) -> None:
        """Frames every view anew when an office or a second brain has come or gone."""
        if (office, two) != (self._office, self._two):
            self._office, self._two = office, two
            for client_id in list(self._views):
                self.reframe(client_id)

    def turned(self, client_id: int) -> Camera | None:
        """Where somebody has turned a camera by hand; None when it is at its view or in flight. From any thread."""
        client, view = self._server.get_clients().get(client_id), self._views.get(client_id)
        if client is None or view is None or client_id in self._flights:
            return None
        camera, end = _standing(client.camera), self._framed(view, client.camera)
        return None if _near(camera, end.position, end.look_at) else camera

    def standing(self, client_id: int) -> Camera | None:
        """Where a camera is, as its browser last reported; None for one that is not there."""
        client = self._server.get_clients().get(client_id)
        return None if client is None else _standing(client.camera)

    def take_off(
        self, client_id: int | None, view: str, now_s: float | None = None, turned: Camera | None = None
    ) -> None:
        """Flies one browser's camera (None: all) to a view, or to where it was turned from there. Without `now_s` it jumps."""
        for client in self._server.get_clients().values():
            if client_id in (None, client.client_id):
                camera, wanted = client.camera, cast(View, view)
                self._followers.pop(client.client_id, None)
                self._views[client.client_id] = wanted
                end = turned or self._framed(wanted, camera)
                self._ends[client.client_id] = end
                start = _standing(camera)
                if now_s is None or _near(start, end.position, end.look_at):
                    flight = Flight(end, end, -math.inf)  # one on the spot would hold it against who turns it
                else:
                    flight = Flight(start, end, now_s)
                self._flights[client.client_id] = flight

    def _framed(self, view: View, camera: viser.CameraHandle) -> Camera:
        return camera_for(view, _aspect_of(camera), self._office, self._two)

    def follow(self, client_id: int, robots: Robots, now_s: float) -> None:
        """From now on this browser's camera goes with the robot, on the map if it looks at the map, else in the office. With no
        robot it stays where it is."""
        self._followers.pop(client_id, None)
        client = self._server.get_clients().get(client_id)
        plate = "map" if self._views.get(client_id) == "map" or "office" not in robots else "office"
        if client is None or plate not in robots:
            return
        at, scale = robots[plate]
        end = follow_camera(at, scale, _aspect_of(client.camera))
        self._flights[client_id] = Flight(_standing(client.camera), end, now_s)
        self._ends[client_id] = end
        self._followers[client_id] = Follower(plate, at, end.position - at, end.fov_rad, now_s)

    def track(self, robots: Robots, now_s: float) -> None:
        """Moves every camera that follows and is not in flight."""
        clients = self._server.get_clients()
        for client_id, follower in list(self._followers.items()):
            if client_id in self._flights or client_id not in clients or follower.plate not in robots:
                continue
            camera = follower.step(robots[follower.plate][0], now_s)
            if camera is not None:
                _point(clients[client_id], camera)

    def _on_camera(self, client_id: int, camera: viser.CameraHandle) -> None:
        """From viser's thread."""
        position, look_at = camera.position.copy(), camera.look_at.copy()

        def moved() -> None:
            if client_id in self._followers and client_id not in self._flights:
                self._followers[client_id].on_camera(position, look_at, time.monotonic())

        if client_id in self._followers:
            self._post(moved)

    def _set_back(self, client_id: int, camera: viser.CameraHandle) -> bool:
        """Whether viser's client has gone to its initial camera by itself, or sees as widely as no hand can make it: viser does
        not send what the browser told last, which may be older than what was sent. From viser's thread.
        """
        end, initial = self._ends.get(client_id), self._server.initial_camera
        if end is None or client_id in self._flights or client_id in self._followers:
            return False
        back = _near(camera, initial.position, initial.look_at) and not _near(camera, end.position, end.look_at)
        return back or abs(camera.fov - end.fov_rad) > WIDER_RAD

    def _send_on(self, client_id: int) -> None:
        if client_id in self._ends and client_id not in self._flights:
            self._flights[client_id] = Flight(self._ends[client_id], self._ends[client_id], -math.inf)

    def fly_on(self, now_s: float) -> None:
        """Moves every camera that is in flight."""
        if not self._flights:
            return
        clients = self._server.get_clients()
        for client_id, flight in list(self._flights.items()):
            camera, arrived = flight.at(now_s)
            if client_id in clients:
                _point(clients[client_id], camera)
            if arrived or client_id not in clients:
                del self._flights[client_id]


def _aspect_of(camera: viser.CameraHandle) -> float:
    """Width over height of the canvas. A canvas without pixels, as in a browser that hides it, counts as a screen's."""
    width, height = camera.image_width, camera.image_height
    return width / height if width > 0 and height > 0 else SCREEN_ASPECT


def _near(camera: viser.CameraHandle | Camera, position: ArrayLike, look_at: ArrayLike) -> bool:
    return np.allclose(camera.position, position, atol=TURNED) and np.allclose(camera.look_at, look_at, atol=TURNED)


def _standing(camera: viser.CameraHandle) -> Camera:
    return Camera(camera.position.copy(), camera.look_at.copy(), camera.fov)


def _point(client: viser.ClientHandle, camera: Camera) -> None:
    with client.atomic():
        client.camera.position = camera.position
        client.camera.look_at = camera.look_at
        client.camera.up_direction = (0.0, 0.0, 1.0)
        client.camera.fov = camera.fov_rad


ELEVATION_DEG, FOV_DEG = 52.0, 30.0
NEAR_M, LEAST, MOST = 6.0, 1.4, 4.2  # half the width that is seen: metres, but between so many plate units
EASE_S = 0.4  # how long the camera lags behind
REST_S = 0.6  # after the hand has moved it
MOVED = 0.01  # a share of the distance: a camera whose direction differs by more was moved by hand
STEP = 0.004  # plate units: smaller steps are not sent


@dataclass
class Follower:
    """One camera that goes with the robot on one plate. It keeps the direction and distance that the hand gave it, and rests
    while that moves it."""

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

    def on_camera(self, position: Point, look_at: Point, now_s: float) -> None:
        """The browser reports its camera. If it is turned or nearer than we put it, that was the hand, which is obeyed."""
        offset = position - look_at
        if np.linalg.norm(offset - self.offset) > MOVED * np.linalg.norm(self.offset):
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


def follow_camera(at: Point, scale: float, aspect: float) -> Camera:
    """Where a camera begins to follow. scale: plate units a metre; aspect: width over height of the canvas."""
    half_width = min(max(NEAR_M * scale, LEAST), MOST)
    half, up = math.tan(math.radians(FOV_DEG) / 2), math.radians(ELEVATION_DEG)
    distance = half_width / (half * _counted(aspect))
    return Camera(at + distance * np.array([0.0, -math.cos(up), math.sin(up)]), at.copy(), math.radians(FOV_DEG))


def _counted(aspect: float) -> float:
    """A canvas that is wider than this shows more at the sides, not less in height."""
    return min(max(aspect, 0.5), 1.6)
