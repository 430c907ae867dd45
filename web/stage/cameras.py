"""Every browser's camera: where it looks, its flights from view to view, framed anew when the window changes shape."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import cast

import viser

from web.stage.camera_views import FAR, NEAR, PHONE_ASPECT, Camera, Flight, View, camera_for

RESHAPED = 0.01  # a change of aspect that asks for another framing


class Cameras:
    """Runs in the stage's thread; `post` brings work there from viser's callbacks."""

    def __init__(self, server: viser.ViserServer, post: Callable[[Callable[[], None]], None]) -> None:
        self._server, self._post = server, post
        self._views: dict[int, View] = {}
        self._flights: dict[int, Flight] = {}
        camera, initial = camera_for("all", 1.5), server.initial_camera
        initial.position, initial.look_at, initial.fov = camera.position, camera.look_at, camera.fov_rad
        initial.near, initial.far = NEAR, FAR

    @property
    def flying(self) -> bool:
        return bool(self._flights)

    def welcome(self, client: viser.ClientHandle) -> None:
        """A new browser: a phone begins on the map, a screen with all three plates."""
        aspect = client.camera.aspect
        self.take_off(client.client_id, "map" if aspect < PHONE_ASPECT else "all")

        async def moved(camera: viser.CameraHandle) -> None:
            nonlocal aspect
            if abs(camera.aspect / aspect - 1) > RESHAPED:
                aspect = camera.aspect
                self._post(lambda: self.reframe(client.client_id))

        client.camera.on_update(moved)

    def farewell(self, client_id: int) -> None:
        self._views.pop(client_id, None)
        self._flights.pop(client_id, None)

    def reframe(self, client_id: int) -> None:
        if client_id in self._views:
            self.take_off(client_id, self._views[client_id])

    def take_off(self, client_id: int | None, view: str, now_s: float | None = None) -> None:
        """Flies one browser (or all) to a view, beginning `now_s`; without a time it jumps there."""
        for client in self._server.get_clients().values():
            if client_id in (None, client.client_id):
                camera, wanted = client.camera, cast(View, view)
                self._views[client.client_id] = wanted
                end = camera_for(wanted, camera.aspect)
                start = end if now_s is None else Camera(camera.position.copy(), camera.look_at.copy(), camera.fov)
                self._flights[client.client_id] = Flight(start, end, -math.inf if now_s is None else now_s)

    def fly_on(self, now_s: float) -> None:
        """Moves every camera in flight."""
        if not self._flights:
            return
        clients = self._server.get_clients()
        for client_id, flight in list(self._flights.items()):
            camera, arrived = flight.at(now_s)
            if client_id in clients:
                _point(clients[client_id], camera)
            if arrived or client_id not in clients:
                del self._flights[client_id]


def _point(client: viser.ClientHandle, camera: Camera) -> None:
    with client.atomic():
        client.camera.position = camera.position
        client.camera.look_at = camera.look_at
        client.camera.up_direction = (0.0, 0.0, 1.0)
        client.camera.fov = camera.fov_rad
