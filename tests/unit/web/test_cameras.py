"""Every browser's camera: framed, flown, framed anew, and sent on when viser's client resets it."""

from __future__ import annotations

import asyncio
import threading
from types import SimpleNamespace
from typing import Any

import numpy as np

from web.viewer.camera_views import Camera, camera_for
from web.viewer.cameras import Cameras


class FakeCamera(SimpleNamespace):
    def on_update(self, callback: Any) -> None:
        self.moved = callback


def browser(client_id: int, aspect: float) -> Any:
    size = {"image_width": round(1000 * aspect), "image_height": 1000}
    camera = FakeCamera(**size, position=np.zeros(3), look_at=np.ones(3), fov=0.5, up_direction=None)
    return SimpleNamespace(client_id=client_id, camera=camera, atomic=threading.Lock)


class FakeServer(SimpleNamespace):
    def get_clients(self) -> dict[int, Any]:
        return self.clients


def test_cameras_are_framed_flown_and_framed_anew() -> None:
    screen, phone = browser(1, 1.5), browser(2, 0.46)
    server = FakeServer(clients={1: screen, 2: phone}, initial_camera=SimpleNamespace())
    posted: list[Any] = []
    cameras = Cameras(server, posted.append)  # type: ignore[arg-type]
    assert server.initial_camera.far > server.initial_camera.near
    cameras.fly_on(0.0)
    cameras.welcome(screen)
    cameras.welcome(phone)
    assert cameras.flying
    cameras.fly_on(0.0)
    assert not cameras.flying
    assert np.allclose(screen.camera.position, camera_for("all", 1.5).position)
    assert np.allclose(phone.camera.position, camera_for("map", 0.46).position)

    cameras.take_off(1, "pose", 10.0)
    cameras.fly_on(10.35)
    assert cameras.flying
    cameras.fly_on(11.0)
    assert np.allclose(screen.camera.position, camera_for("pose", 1.5).position)
    assert np.allclose(phone.camera.position, camera_for("map", 0.46).position)

    assert cameras.turned(1) is None
    screen.camera.position = screen.camera.position + 1.0
    turned = cameras.turned(1)
    assert turned is not None
    assert np.allclose(turned.position, screen.camera.position)
    cameras.take_off(1, "pose", None, turned)  # as in the viewer of the other theme
    assert cameras.turned(1) is None  # on its way
    cameras.fly_on(11.1)
    assert np.allclose(screen.camera.position, turned.position)
    assert cameras.turned(7) is None

    screen.camera.position, screen.camera.look_at = server.initial_camera.position, server.initial_camera.look_at
    asyncio.run(screen.camera.moved(screen.camera))  # viser's client drew its first frame after it had been sent on
    posted.pop()()
    assert cameras.turned(1) is None
    cameras.fly_on(11.2)
    assert np.allclose(screen.camera.position, turned.position)

    asyncio.run(screen.camera.moved(screen.camera))  # orbiting alone changes nothing
    screen.camera.image_width = 1000
    asyncio.run(screen.camera.moved(screen.camera))
    assert len(posted) == 1
    posted[0]()
    cameras.fly_on(12.0)
    assert np.allclose(screen.camera.position, camera_for("pose", 1.0).position)

    screen.camera.image_height = 0  # as in a browser that hides the viewer
    asyncio.run(screen.camera.moved(screen.camera))
    posted[1]()
    cameras.fly_on(13.0)
    assert np.allclose(screen.camera.position, camera_for("pose", 1.5).position)
    screen.camera.image_height = 1000
    asyncio.run(screen.camera.moved(screen.camera))
    assert len(posted) == 3

    cameras.take_off(None, "map", 20.0)
    del server.clients[2]
    cameras.farewell(1)
    cameras.fly_on(20.1)
    assert not cameras.flying
    cameras.reframe(9)
    assert isinstance(camera_for("all", 1.0), Camera)


def test_a_camera_that_is_there_already_is_not_held() -> None:
    """A flight on the spot would be felt: whoever turns the camera meanwhile is set back."""
    screen = browser(1, 1.5)
    cameras = Cameras(FakeServer(clients={1: screen}, initial_camera=SimpleNamespace()), lambda _: None)  # type: ignore[arg-type]
    cameras.welcome(screen)
    cameras.fly_on(0.0)
    cameras.take_off(1, "all", 10.0)
    cameras.fly_on(10.0)
    assert not cameras.flying
    screen.camera.position = by_hand = screen.camera.position + 1.0
    cameras.fly_on(10.1)
    assert np.allclose(screen.camera.position, by_hand)
