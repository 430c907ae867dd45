"""A camera that follows goes with the robot, smoothly, and never takes the hand's turning back."""

from __future__ import annotations

import asyncio
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.unit.web.doubles import PAGE, StubViewer, house
from tests.unit.web.frames import until
from tests.unit.web.test_cameras import FakeServer, browser
from tests.unit.web.test_kept_cameras import arrive
from web.http.proxy import Cameras as Pages
from web.viewer.cameras import Cameras
from web.viewer.following import EASE_S, REST_S, Follower, follow_camera

numbers = st.floats(-5, 5)


def follower(at: np.ndarray) -> Follower:
    camera = follow_camera(at, 0.3, 1.5)
    return Follower("office", at, camera.position - camera.look_at, camera.fov_rad, 0.0)


@settings(max_examples=60)
@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=30), st.floats(0.02, 0.3))
def test_it_keeps_direction_and_distance_and_moves_less_than_the_robot(
    way: list[tuple[float, float]], dt: float
) -> None:
    camera, now_s = follower(np.zeros(3)), 0.0
    offset = camera.offset.copy()
    for x, y in way:
        now_s += dt
        robot, before = np.array([x, y, 0.0]), camera.at.copy()
        seen = camera.step(robot, now_s)
        if seen is None:
            continue
        assert np.allclose(seen.position - seen.look_at, offset)
        assert np.linalg.norm(camera.at - before) <= np.linalg.norm(robot - before) + 1e-12  # it never overshoots


def test_it_arrives_at_a_robot_that_stands() -> None:
    camera, robot = follower(np.zeros(3)), np.array([2.0, 1.0, 0.0])
    for k in range(1, 60):
        camera.step(robot, k * 0.1)
    assert np.linalg.norm(camera.at - robot) < 0.01
    assert camera.step(robot, 6.1) is None or EASE_S > 1  # and then nothing is sent


def test_the_hand_is_obeyed_and_not_disturbed() -> None:
    camera, robot = follower(np.zeros(3)), np.array([1.0, 0.0, 0.0])
    turned = np.array([3.0, -1.0, 4.0])
    camera.heard(camera.at + turned, camera.at, 1.0)
    assert camera.step(robot, 1.0 + REST_S / 2) is None
    seen = camera.step(robot, 1.1 + REST_S)
    assert seen is not None
    assert np.allclose(seen.position - seen.look_at, turned)


def test_what_it_reports_of_our_own_moves_is_not_taken_for_the_hand() -> None:
    camera = follower(np.zeros(3))
    before = camera.offset.copy()
    camera.heard(np.array([0.3, 0.2, 0.0]) + before, np.array([0.3, 0.2, 0.0]), 1.0)
    assert np.array_equal(camera.offset, before)
    assert camera.step(np.array([1.0, 0.0, 0.0]), 1.05) is not None


@pytest.mark.parametrize("aspect", [0.46, 1.0, 1.5, 2.4])
@pytest.mark.parametrize("scale", [0.05, 0.22, 1.0])
def test_it_begins_near_the_robot_in_worlds_of_any_size(scale: float, aspect: float) -> None:
    at = np.array([-3.0, 1.0, 0.0])
    camera = follow_camera(at, scale, aspect)
    away = float(np.linalg.norm(camera.position - at))
    half_height = away * math.tan(camera.fov_rad / 2)
    assert camera.look_at == pytest.approx(at)
    assert away > 1.5  # before the near plane
    assert 0.8 < half_height < 9


def test_cameras_follow_on_the_plate_they_look_at_until_another_view_is_asked_for() -> None:
    screen = browser(1, 1.5)
    server = FakeServer(clients={1: screen}, initial_camera=SimpleNamespace())
    posted: list[Any] = []
    cameras = Cameras(server, posted.append)  # type: ignore[arg-type]
    cameras.welcome(screen)
    cameras.fly_on(0.0)
    robots = {"office": (np.array([-6.0, -2.0, 0.0]), 1.0), "map": (np.array([6.0, -2.0, 0.0]), 1.0)}
    cameras.follow(1, robots, 10.0)
    cameras.fly_on(11.0)
    assert np.allclose(screen.camera.look_at, robots["office"][0])
    on = {**robots, "office": (np.array([-5.0, -2.0, 0.0]), 1.0)}
    for k in range(1, 50):
        cameras.track(on, 11.0 + 0.1 * k)
    assert np.linalg.norm(screen.camera.look_at - on["office"][0]) < 0.01
    asyncio.run(screen.camera.moved(screen.camera))
    assert cameras.flying
    away = np.linalg.norm(screen.camera.position - screen.camera.look_at)
    screen.camera.image_width = 750  # half as wide: the same from side to side is seen from farther away
    asyncio.run(screen.camera.moved(screen.camera))
    while posted:
        posted.pop(0)()
    assert np.linalg.norm(screen.camera.position - screen.camera.look_at) == pytest.approx(2 * away)
    cameras.track({**on, "office": (np.array([-4.0, -2.0, 0.0]), 1.0)}, 30.0)
    assert np.linalg.norm(screen.camera.position - screen.camera.look_at) == pytest.approx(2 * away)
    cameras.take_off(1, "map", None)
    cameras.fly_on(20.0)
    assert not cameras.flying  # it follows no longer
    cameras.follow(1, robots, 21.0)
    cameras.fly_on(22.0)
    assert np.allclose(screen.camera.look_at, robots["map"][0])
    cameras.follow(1, {}, 23.0)
    assert not cameras.flying


def test_a_page_follows_also_in_the_viewer_of_the_other_theme() -> None:
    async def run() -> None:
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

    asyncio.run(run())


@pytest.mark.parametrize("fields", ['"type": "follow", "on": 1', '"type": "replay", "event": true', '"type": "replay"'])
def test_what_makes_no_sense_is_refused(fields: str) -> None:
    with house() as server, server.stream() as page:
        page.send_text(f'{{{fields}, "id": 4}}')
        assert not until(page, "answer")["accepted"]
