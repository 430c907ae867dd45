"""Cameras: where they stand, how they fly, and how they follow the robot; what the hand has turned stays, whichever viewer a
page goes to."""

from __future__ import annotations

import asyncio
import math
import threading
from collections.abc import Callable, Coroutine
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.unit.web.doubles import PAGE, StubViewer, house
from tests.unit.web.frames import until
from web.http.proxy import MOST_CLIENTS
from web.http.proxy import Cameras as Pages
from web.viewer.camera_views import FLIGHT_S, VIEWS, Camera, camera_for, corners_of, seen_by
from web.viewer.cameras import REST_S, Cameras, Follower, follow_camera
from web.viewer.plates.office_plate import HEIGHTS

TURNED = Camera(np.ones(3), np.zeros(3), 0.5)


# ---------------------------------------------------------------- where they stand


def test_every_view_looks_down_at_its_plates_and_shows_them_as_large_as_the_window_allows(subtests) -> None:
    for view, aspect, two in product(VIEWS, (0.46, 1.0, 1.2, 2.2, 3.0), (False, True)):
        with subtests.test(view=view, aspect=aspect, two=two):
            camera = camera_for(view, aspect, two=two)
            back = camera.position - camera.look_at
            half = math.tan(camera.fov_rad / 2) * np.linalg.norm(back)
            seen = seen_by(camera, corners_of(view, True, two))[0] / (half * aspect, half)
            assert back[1] < 0 < 0.6 < back[2] / np.linalg.norm(back)
            assert np.abs(seen).max() < 1
            assert np.ptp(seen, axis=0).max() > (1.1 if two and aspect == 3.0 else 1.5)  # of 2
    walls = corners_of("office", True, False)
    assert walls[:, 2].max() >= max(HEIGHTS.values())  # the back wall is not cut
    assert len(corners_of("all", True, False)) > len(corners_of("all", False, False))  # an office is one plate more


# ---------------------------------------------------------------- of browsers


class FakeCamera(SimpleNamespace):
    def on_update(self, callback: Any) -> None:
        self.moved = callback


class Browsers:
    """Browsers of some aspects, whose cameras have arrived at their first views."""

    def __init__(self, *aspects: float) -> None:
        self.clients = {
            number: SimpleNamespace(
                client_id=number,
                atomic=threading.Lock,
                camera=FakeCamera(
                    image_width=round(1000 * aspect), image_height=1000,
                    position=np.zeros(3), look_at=np.ones(3), fov=0.5, up_direction=None,
                ),
            )
            for number, aspect in enumerate(aspects, 1)
        }  # fmt: skip
        self.initial_camera, self.posted = SimpleNamespace(), []
        self.cameras = Cameras(self, self.posted.append)  # type: ignore[arg-type]
        for client in self.clients.values():
            self.cameras.welcome(client)  # type: ignore[arg-type]
        assert self.cameras.flying
        self.cameras.fly_on(0.0)
        assert not self.cameras.flying

    def get_clients(self) -> dict[int, Any]:
        return self.clients

    def camera(self, number: int = 1) -> Any:
        return self.clients[number].camera

    def stands(self, at: Camera, towards: Camera | None = None, share: float = 0.0, number: int = 1) -> bool:
        """Whether a camera is at a place, or a share of the way from there to another, looking as it should."""
        camera = self.camera(number)
        here = np.hstack([camera.position, camera.look_at, camera.fov])
        start, end = (np.hstack([c.position, c.look_at, c.fov_rad]) for c in (at, towards or at))
        return np.allclose(here, start + share * (end - start))

    def told(self) -> int:
        """The first browser tells of its camera; returns how much work that gave the viewer's thread."""
        asyncio.run(self.camera().moved(self.camera()))
        work = [self.posted.pop(0) for _ in list(self.posted)]
        for one in work:
            one()
        return len(work)


def test_cameras_are_framed_flown_and_framed_anew() -> None:
    browsers = Browsers(1.5, 0.46)
    cameras, screen = browsers.cameras, browsers.camera()
    assert browsers.initial_camera.far > browsers.initial_camera.near
    assert browsers.stands(camera_for("all", 1.5))
    assert browsers.stands(camera_for("map", 0.46), number=2)
    cameras.take_off(1, "pose", 10.0)
    for share, weight in ((0.0, 0.0), (0.25, 5 / 32), (0.5, 0.5)):  # slow at both ends
        cameras.fly_on(10.0 + share * FLIGHT_S)
        assert browsers.stands(camera_for("all", 1.5), camera_for("pose", 1.5), weight)
        assert cameras.flying
    cameras.fly_on(10.01 + FLIGHT_S)
    assert browsers.stands(camera_for("pose", 1.5))
    assert browsers.stands(camera_for("map", 0.46), number=2)

    assert browsers.told() == 0  # orbiting alone changes nothing
    for size, aspect in (
        ({"image_width": 1000}, 1.0),
        ({"image_height": 0}, 1.5),  # as in a browser that hides the viewer
        ({"image_height": 1000}, 1.0),
    ):
        vars(screen).update(size)
        assert browsers.told() == 1
        cameras.fly_on(12.0)
        assert browsers.stands(camera_for("pose", aspect))

    cameras.take_off(None, "map", 20.0)
    del browsers.clients[2]
    cameras.farewell(1)
    cameras.reframe(1)
    cameras.fly_on(20.1)
    assert not cameras.flying


def test_a_camera_that_is_turned_by_hand_is_known_and_brought_back_when_viser_resets_it() -> None:
    browsers = Browsers(1.5)
    cameras, screen = browsers.cameras, browsers.camera()
    assert (cameras.turned(1), cameras.turned(7)) == (None, None)
    screen.position = screen.position + 1.0
    turned = cameras.turned(1)
    assert turned is not None
    assert browsers.stands(turned)
    cameras.take_off(1, "pose", None, turned)  # as in the viewer of the other theme
    assert cameras.turned(1) is None  # on its way
    cameras.fly_on(11.1)
    assert browsers.stands(turned)

    screen.position, screen.look_at = browsers.initial_camera.position, browsers.initial_camera.look_at
    assert browsers.told() == 1  # viser's client drew its first frame after it had been sent on
    assert cameras.turned(1) is None
    cameras.fly_on(11.2)
    assert browsers.stands(turned)


def test_a_camera_that_is_there_already_is_not_held() -> None:
    """A flight on the spot would be felt: whoever turns the camera meanwhile is set back."""
    browsers = Browsers(1.5)
    browsers.cameras.take_off(1, "all", 10.0)
    browsers.cameras.fly_on(10.0)
    assert not browsers.cameras.flying
    browsers.camera().position = by_hand = browsers.camera().position + 1.0
    browsers.cameras.fly_on(10.1)
    assert np.allclose(browsers.camera().position, by_hand)


def test_a_camera_that_sees_more_widely_than_its_view_is_sent_on() -> None:
    """viser keeps back what the browser seemed to have, so that the end of a flight can miss its field of view."""
    browsers = Browsers(1.5)
    browsers.camera().position = by_hand = browsers.camera().position + 1.0
    assert browsers.told() == 0
    browsers.camera().position, browsers.camera().fov = by_hand - 1.0, 0.6
    assert browsers.told() == 1
    browsers.cameras.fly_on(10.0)
    assert browsers.stands(camera_for("all", 1.5))


# ---------------------------------------------------------------- that follow

numbers = st.floats(-5, 5)


def follower() -> Follower:
    camera = follow_camera(np.zeros(3), 0.3, 1.5)
    return Follower("office", np.zeros(3), camera.position - camera.look_at, camera.fov_rad, 0.0)


@settings(max_examples=60)
@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=30), st.floats(0.02, 0.3))
def test_it_keeps_direction_and_distance_and_never_overshoots(way: list[tuple[float, float]], dt: float) -> None:
    camera = follower()
    offset = camera.offset.copy()
    for k, (x, y) in enumerate(way, 1):
        robot, before = np.array([x, y, 0.0]), camera.at.copy()
        seen = camera.step(robot, k * dt)
        if seen is not None:
            assert np.allclose(seen.position - seen.look_at, offset)
            assert np.linalg.norm(camera.at - before) <= np.linalg.norm(robot - before) + 1e-12


def test_it_arrives_at_a_robot_that_stands_and_jumps_not_even_after_a_pause() -> None:
    camera, robot = follower(), np.array([2.0, 1.0, 0.0])
    camera.step(robot, 100.0)
    assert np.linalg.norm(camera.at - robot) > 0.25 * np.linalg.norm(robot)
    for k in range(1, 60):
        camera.step(robot, 100 + k * 0.1)
    assert np.linalg.norm(camera.at - robot) < 0.01
    assert camera.step(robot, 106.1) is None  # and then nothing is sent


def test_the_hand_is_obeyed_and_not_disturbed_and_our_own_moves_are_not_taken_for_it() -> None:
    camera, robot = follower(), np.array([1.0, 0.0, 0.0])
    before, turned = camera.offset.copy(), np.array([3.0, -1.0, 4.0])
    camera.on_camera(np.array([0.3, 0.2, 0.0]) + before, np.array([0.3, 0.2, 0.0]), 1.0)
    assert np.array_equal(camera.offset, before)
    assert camera.step(robot, 1.05) is not None
    camera.on_camera(camera.at + turned, camera.at, 1.1)
    assert camera.step(robot, 1.1 + REST_S / 2) is None
    seen = camera.step(robot, 1.2 + REST_S)
    assert seen is not None
    assert np.allclose(seen.position - seen.look_at, turned)


def test_it_begins_near_the_robot_in_worlds_of_any_size(subtests) -> None:
    at, widths = np.array([-3.0, 1.0, 0.0]), {0.05: 1.4, 0.22: 1.4, 0.5: 3.0, 1.0: 4.2}
    for (scale, half_width), aspect in product(widths.items(), (0.46, 1.0, 1.5, 2.4)):
        with subtests.test(scale=scale, aspect=aspect):
            camera = follow_camera(at, scale, aspect)
            back = camera.position - at
            half_height = np.linalg.norm(back) * math.tan(camera.fov_rad / 2)
            assert camera.look_at == pytest.approx(at)
            assert back[1] < 0 < 1.1 < back[2]  # from before it, and before the near plane
            assert half_height == pytest.approx(half_width / min(max(aspect, 0.5), 1.6))


def test_cameras_follow_on_the_plate_they_look_at_until_another_view_is_asked_for() -> None:
    def robots(x: float) -> dict[str, Any]:
        return {"office": (np.array([x, -2.0, 0.0]), 1.0), "map": (np.array([6.0, -2.0, 0.0]), 1.0)}

    browsers = Browsers(1.5)
    cameras, screen = browsers.cameras, browsers.camera()
    cameras.follow(1, robots(-6.0), 10.0)
    cameras.fly_on(11.0)
    assert np.allclose(screen.look_at, robots(-6.0)["office"][0])
    for k in range(1, 50):
        cameras.track(robots(-5.0), 11.0 + 0.1 * k)
    assert np.linalg.norm(screen.look_at - robots(-5.0)["office"][0]) < 0.01
    browsers.told()
    assert cameras.flying
    away = np.linalg.norm(screen.position - screen.look_at)
    screen.image_width = 750  # half as wide: the same from side to side is seen from farther away
    browsers.told()
    assert np.linalg.norm(screen.position - screen.look_at) == pytest.approx(2 * away)
    cameras.track(robots(-4.0), 30.0)
    assert np.linalg.norm(screen.position - screen.look_at) == pytest.approx(2 * away)
    cameras.take_off(1, "map", None)
    cameras.fly_on(20.0)
    assert not cameras.flying  # it follows no longer
    cameras.follow(1, robots(-6.0), 21.0)
    cameras.fly_on(22.0)
    assert np.allclose(screen.look_at, robots(-6.0)["map"][0])
    cameras.follow(1, {}, 23.0)
    assert not cameras.flying


# ---------------------------------------------------------------- of pages, which go from viewer to viewer


async def arrive(pages: Pages, stage: StubViewer, number: int, page: str = PAGE) -> None:
    pages.listen(stage)

    async def pass_on() -> None:
        assert stage.on_connect is not None
        stage.on_connect(number)

    assert await pages.pair(page, stage, pass_on)


def in_a_loop(test: Callable[[], Coroutine[None, None, None]]) -> Callable[[], None]:
    return lambda: asyncio.run(test())


@in_a_loop
async def test_one_that_is_turned_is_taken_along_once_unless_another_view_is_asked_for() -> None:
    dark, light, pages = StubViewer(), StubViewer(), Pages()
    await pages.show(PAGE, "all")
    await arrive(pages, dark, 3)
    dark.cameras[3] = TURNED
    pages.unpair(PAGE, dark)
    await arrive(pages, light, 8)
    assert light.calls == [("jump", 8, "all", TURNED)]
    pages.unpair(PAGE, light)  # it stands at its view
    await arrive(pages, dark, 4)
    assert dark.calls[-1] == ("jump", 4, "all")
    dark.cameras[4] = TURNED
    pages.unpair(PAGE, dark)
    await pages.show(PAGE, "map")
    await arrive(pages, dark, 5)
    assert dark.calls[-1] == ("jump", 5, "map")


@in_a_loop
async def test_those_of_pages_that_have_gone_are_forgotten() -> None:
    stage, pages = StubViewer(cameras={3: TURNED}), Pages()
    names = [f"page {number}" for number in range(3 * MOST_CLIENTS)]
    for page in names:
        await pages.show(page, "map")
        await arrive(pages, stage, 3, page)
        pages.unpair(page, stage)
    stage.calls.clear()
    for page in names[MOST_CLIENTS - 1 : MOST_CLIENTS + 1]:  # the last one that is forgotten, the first that is not
        await arrive(pages, stage, 3, page)
    assert stage.calls == [("jump", 3, "map", TURNED)]


@in_a_loop
async def test_one_that_a_link_brings_is_taken_when_its_viewer_comes_or_at_once() -> None:
    stage, pages = StubViewer(), Pages()
    assert pages.turned(PAGE) is None
    await pages.turn(PAGE, "map", TURNED)
    await arrive(pages, stage, 3)
    assert stage.calls == [("jump", 3, "map", TURNED)]
    await pages.turn(PAGE, "pose", TURNED)
    assert stage.calls[-1] == ("fly", 3, "pose", TURNED)
    stage.cameras[3] = TURNED
    assert pages.turned(PAGE) is TURNED


@in_a_loop
async def test_a_page_follows_also_in_the_viewer_of_the_other_theme() -> None:
    dark, light, pages = StubViewer(), StubViewer(), Pages()
    await pages.show(PAGE, "office")
    await arrive(pages, dark, 3)
    pages.follow(PAGE, True)
    assert dark.calls[-1] == ("follow", 3, True)
    pages.unpair(PAGE, dark)
    await arrive(pages, light, 8)
    assert light.calls[-1] == ("follow", 8, True)
    await pages.show(PAGE, "all")
    pages.unpair(PAGE, light)
    await arrive(pages, dark, 4)
    assert dark.calls[-1][0] == "jump"


def test_what_makes_no_sense_is_refused(subtests) -> None:
    with house() as server, server.stream() as page:
        for fields in ('"type": "follow", "on": 1', '"type": "replay", "event": true', '"type": "replay"'):
            with subtests.test(fields=fields):
                page.send_text(f'{{{fields}, "id": 4}}')
                assert not until(page, "answer")["accepted"]
