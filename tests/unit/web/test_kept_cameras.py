"""A camera that somebody has turned by hand stays where it is when the page goes to the viewer of the other theme."""

from __future__ import annotations

import asyncio

import numpy as np

from tests.unit.web.doubles import PAGE, StubViewer
from web.http.proxy import MOST_CLIENTS, Cameras
from web.viewer.camera_views import Camera

TURNED = Camera(np.ones(3), np.zeros(3), 0.5)


async def arrive(cameras: Cameras, stage: StubViewer, number: int, page: str = PAGE) -> None:
    cameras.listen(stage)

    async def pass_on() -> None:
        assert stage.on_connect is not None
        stage.on_connect(number)

    assert await cameras.pair(page, stage, pass_on)


def test_it_is_taken_along_once():
    async def run():
        dark, light, cameras = StubViewer(), StubViewer(), Cameras()
        await cameras.show(PAGE, "all")
        await arrive(cameras, dark, 3)
        dark.cameras[3] = TURNED
        cameras.unpair(PAGE, dark)
        await arrive(cameras, light, 8)
        assert light.calls == [("jump", 8, "all", TURNED)]
        cameras.unpair(PAGE, light)  # it stands at its view
        await arrive(cameras, dark, 4)
        assert dark.calls[-1] == ("jump", 4, "all")

    asyncio.run(run())


def test_a_view_that_is_asked_for_meanwhile_counts():
    async def run():
        dark, cameras = StubViewer(), Cameras()
        await cameras.show(PAGE, "all")
        await arrive(cameras, dark, 3)
        dark.cameras[3] = TURNED
        cameras.unpair(PAGE, dark)
        await cameras.show(PAGE, "map")
        await arrive(cameras, dark, 4)
        assert dark.calls[-1] == ("jump", 4, "map")

    asyncio.run(run())


def test_those_of_pages_that_have_gone_are_forgotten():
    async def run():
        stage, cameras = StubViewer(cameras={3: TURNED}), Cameras()
        for number in range(3 * MOST_CLIENTS):
            await arrive(cameras, stage, 3, f"page {number}")
            cameras.unpair(f"page {number}", stage)
        assert len(cameras._turned) == 2 * MOST_CLIENTS

    asyncio.run(run())


def test_one_that_a_link_brings_is_taken_when_its_viewer_comes_or_at_once():
    async def run():
        stage, cameras = StubViewer(), Cameras()
        assert cameras.turned(PAGE) is None
        await cameras.turn(PAGE, "map", TURNED)
        await arrive(cameras, stage, 3)
        assert stage.calls == [("jump", 3, "map", TURNED)]
        await cameras.turn(PAGE, "pose", TURNED)
        assert stage.calls[-1] == ("fly", 3, "pose", TURNED)
        stage.cameras[3] = TURNED
        assert cameras.turned(PAGE) is TURNED

    asyncio.run(run())
