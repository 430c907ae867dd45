"""viser through our port: its page, its websocket, and which camera is whose."""

from __future__ import annotations

import asyncio
import math
import threading
from typing import ClassVar

import numpy as np
import orjson
import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketDisconnect, WebSocketState

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S
from tests.unit.web.doubles import OURS, PAGE, StubViewer, StubViewers, house, viser_double
from tests.unit.web.frames import until
from web.http import proxy as module
from web.http.proxy import Cameras, ViserProxy, _call
from web.themes import Themes
from web.viewer.camera_views import MAP_AT, camera_for, seen_by
from web.viewer.fits.map_fit import MapFit, refit
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.pointer import NOT_THERE
from web.viewer.viser_server import client_page

pytestmark = pytest.mark.slow

PROTOCOL = "viser-v1.1.1"


@pytest.fixture
def behind():
    stage = StubViewer()
    with viser_double(stage) as got, house(stage=stage) as server:
        yield server, got


def connect(server, page=PAGE, protocols=(PROTOCOL,)):
    return server.client.websocket_connect(f"/viser/ws/{page}", subprotocols=list(protocols), headers=dict(OURS))


def test_the_client_s_page_is_read_once(behind, monkeypatch):
    server, _ = behind
    answer = server.client.get("/viser/")
    assert (answer.status_code, answer.content) == (200, client_page())
    assert server.client.get("/viser/", headers={"Accept-Encoding": "identity"}).content == client_page()
    assert "blob:" in answer.headers["content-security-policy"]
    monkeypatch.setattr(module, "client_page", None)  # to read it again would fail
    tag = answer.headers["etag"]
    assert server.client.get("/viser/", headers={"If-None-Match": tag}).status_code == 304


def test_both_ways_with_viser_s_subprotocol(behind):
    server, got = behind
    with connect(server) as socket:
        assert socket.accepted_subprotocol == PROTOCOL
        for data in (b"\x00camera", b"\x01other"):
            socket.send_bytes(data)
            assert socket.receive_bytes() == data
        socket.send_bytes(b"text")
        assert socket.receive_bytes() == b"text"
    assert got == [b"\x00camera", b"\x01other", b"text"]


def test_a_page_s_view_flies_its_own_camera(behind):
    server, _ = behind
    with server.stream() as stream:
        stream.send_text('{"type": "view", "name": "map"}')
        stream.send_text('{"type": "pause", "id": 1}')
        while '"answer"' not in stream.receive_text():
            pass
        with connect(server) as socket:
            socket.send_bytes(b"camera")
            socket.receive_bytes()
            assert server.stage.called.wait(PATIENCE_S)
            assert server.stage.calls == [("jump", 0, "map")]
            server.stage.called.clear()
            stream.send_text('{"type": "view", "name": "pose"}')
            assert server.stage.called.wait(PATIENCE_S)
            assert server.stage.calls[-1] == ("fly", 0, "pose")


def test_a_refusal_on_a_stage_is_told_to_the_page_it_is_of(behind):
    server, _ = behind
    other = "q" * 22
    with server.stream() as one, server.stream(f"/api/stream?page={other}") as two:
        with connect(server) as first, connect(server, other) as second:
            for socket in (first, second):
                socket.send_bytes(b"camera")
                socket.receive_bytes()
            for client_id, text in ((1, "No goal set: too far"), (0, "Not done: a wall"), (5, "whose?")):
                server.stage.on_complaint(client_id, text)
            assert (next_notice(one), next_notice(two)) == ("Not done: a wall", "No goal set: too far")
        server.stage.on_complaint(0, "after its end")


def next_notice(stream) -> str:
    while (message := orjson.loads(stream.receive_text()))["type"] != "notice":
        pass
    return message["text"]


def test_viser_s_end_ends_the_browser_s(behind):
    server, _ = behind
    with connect(server) as socket:
        socket.send_bytes(b"leave")
        with pytest.raises(WebSocketDisconnect):
            socket.receive_bytes()


def test_text_is_not_viser_s_language(behind):
    server, got = behind
    with connect(server) as socket:
        socket.send_text("hello")
        with pytest.raises(WebSocketDisconnect):
            socket.receive_bytes()
    assert got == []


def test_without_viser_the_browser_may_try_again():
    stage = StubViewer(port=1)  # nobody listens there
    with house(stage=stage) as server, pytest.raises(WebSocketDisconnect), connect(server) as socket:
        socket.receive_bytes()


@pytest.mark.parametrize(
    "protocols", [[], ["chat"], ["viser-v"], ["viser-v1.1.1 or so"], ["Viser-v1.1.1"], ["viser-v" + "1" * 40]]
)
def test_without_viser_s_subprotocol_it_is_said_what_is_missing(behind, protocols):
    server, _ = behind
    with pytest.raises(WebSocketDenialResponse) as refused, connect(server, protocols=protocols):
        pass
    assert refused.value.status_code == 400
    assert "viser-v" in refused.value.json()["detail"][0]["reason"]


def test_of_several_subprotocols_viser_s_is_taken(behind):
    server, _ = behind
    with connect(server, protocols=["chat", PROTOCOL]) as socket:
        assert socket.accepted_subprotocol == PROTOCOL


def test_without_the_secret_the_browser_may_try_again(behind):
    server, _ = behind
    server.stage.secret += "?"  # as it would be with another server on viser's port
    with connect(server) as socket, pytest.raises(WebSocketDisconnect) as refused:
        socket.receive_bytes()
    assert refused.value.code == 1013


def test_it_is_accepted_before_its_viewer_is_there(behind, monkeypatch):
    """viser's client breaks off what is not open within a second and begins anew: with a viewer that is built for longer than
    that, each time, the stage would never come back."""
    server, _ = behind
    built = threading.Event()
    plain = StubViewers.of

    def of(*look):
        assert built.wait(PATIENCE_S)
        return plain(*look)

    monkeypatch.setattr(StubViewers, "of", of)
    with connect(server) as socket:  # it is open
        socket.send_bytes(b"camera")
        built.set()
        assert socket.receive_bytes() == b"camera"


def test_a_click_on_the_stage_is_answered(behind, monkeypatch):
    """Done, refused, on a stage that is not there, or not heard of again: its page is told each time."""
    server, _ = behind
    click = {"type": "click", "at": [0.25, -0.5], "shift": True, "drawn": None}

    def said(number: int, **other: object) -> dict:
        stream.send_text(orjson.dumps(click | other | {"id": number}).decode())
        answer = until(stream, "answer", id=number)
        return answer if answer["accepted"] else answer["detail"][0]["reason"]

    with server.stream() as stream:
        assert said(1) == NOT_THERE
        with connect(server) as socket:
            socket.send_bytes(b"camera")
            socket.receive_bytes()
            server.stage.comes_of_clicks = [None, "No goal set: that is beside the map"]
            assert said(2)["accepted"]
            assert server.stage.calls[-1] == ("press", 0, (0.25, -0.5), True)
            assert said(3, shift=False) == "No goal set: that is beside the map"
            monkeypatch.setattr(module, "CLICK_S", 0.05)
            assert "not answered" in said(4)
        assert "Input should be" in said(5, at="here")


def test_a_click_on_the_drawing_is_one_on_the_map(behind):
    server, _ = behind
    snapshot, drawn = fake_snapshot(12), {"view": "map", "aspect": 1.5}
    x, y = refit(MapFit(), snapshot.map.extent_xy, snapshot.map_turn_rad).to_plate(snapshot.map.xy[:1])[0]
    camera = camera_for("map", 1.5)
    half = math.tan(camera.fov_rad / 2) * float(np.linalg.norm(camera.look_at - camera.position))
    at = (seen_by(camera, np.array([[MAP_AT[0] + x, MAP_AT[1] + y, NODE_Z]]))[0][0] / half).tolist()
    with server.stream() as stream:
        for number, (where, shift) in enumerate([(at, False), (at, True), ([3.0, 3.0], False)]):
            message = {"type": "click", "at": where, "shift": shift, "drawn": drawn, "id": number}
            stream.send_text(orjson.dumps(message).decode())
            assert until(stream, "answer", id=number)["accepted"] == (number < 2)
    goal, inspected = server.engine.commands
    assert (goal.x, goal.y) == pytest.approx(tuple(snapshot.map.xy[0]), abs=1e-4)
    assert np.hypot(*(snapshot.map.xy[inspected.experience] - snapshot.map.xy[0])) < 0.05


@pytest.mark.parametrize("page", ["short", "..%5c..%5cetc", "p" * 65])
def test_a_page_s_id_is_checked(behind, page):
    server, _ = behind
    with pytest.raises(WebSocketDenialResponse) as refused, connect(server, page):
        pass
    assert refused.value.status_code == 404


def test_at_most_so_many_stages(behind, monkeypatch):
    server, _ = behind
    monkeypatch.setattr(module, "MOST_CLIENTS", 1)
    with connect(server), pytest.raises(WebSocketDenialResponse) as refused, connect(server, "q" * 22):
        pass
    assert refused.value.status_code == 503


def test_a_path_that_climbs_is_refused(behind):
    server, _ = behind
    with pytest.raises(WebSocketDisconnect), connect(server, "..%2f..%2fetc"):
        pass


async def nothing() -> None:
    pass


def test_a_message_that_brings_no_number_waits_and_the_late_one_is_still_right(monkeypatch):
    monkeypatch.setattr(module, "PAIRING_S", 0.01)

    async def run():
        stage = StubViewer()
        cameras = Cameras()
        cameras.listen(stage)
        assert stage.on_connect is not None
        assert not await cameras.pair(PAGE, stage, nothing)
        assert not await cameras.pair(PAGE, stage, nothing)
        stage.on_connect(3)
        await asyncio.sleep(0.01)
        assert cameras.paired(PAGE)
        cameras.unpair(PAGE, stage)
        assert not cameras.paired(PAGE)
        stage.on_connect(4)  # nobody waits for it
        await asyncio.sleep(0.01)

    asyncio.run(run())


def test_a_page_that_went_to_another_stage_keeps_its_camera_there():
    async def run():
        dark, light, cameras = StubViewer(), StubViewer(), Cameras()

        async def arrive(stage: StubViewer, number: int):
            cameras.listen(stage)

            async def pass_on():
                assert stage.on_connect is not None
                stage.on_connect(number)

            assert await cameras.pair(PAGE, stage, pass_on)

        await arrive(dark, 0)
        await arrive(light, 5)  # before the end of the other connection is noticed
        cameras.unpair(PAGE, dark)
        await cameras.show(PAGE, "map")
        assert (dark.calls, light.calls) == ([], [("fly", 5, "map")])

    asyncio.run(run())


def test_a_number_of_one_stage_is_nobody_s_at_the_other():
    async def run():
        dark, light, cameras = StubViewer(), StubViewer(), Cameras()
        cameras.listen(dark)
        cameras.listen(light)

        async def pass_on():
            assert dark.on_connect is not None
            assert light.on_connect is not None
            dark.on_connect(3)
            light.on_connect(7)

        assert await cameras.pair(PAGE, light, pass_on)
        await cameras.show(PAGE, "pose")
        assert (dark.calls, light.calls) == ([], [("fly", 7, "pose")])

    asyncio.run(run())


def test_each_page_is_shown_the_stage_of_its_theme():
    dark, light = StubViewer(), StubViewer()
    with viser_double(dark) as at_dark, viser_double(light) as at_light, house(stage=dark, light=light) as server:
        with server.stream() as stream, connect(server, "q" * 22) as other, connect(server) as socket:
            other.send_bytes(b"other")
            assert other.receive_bytes() == b"other"
            stream.send_text('{"type": "theme", "name": "light"}')
            with pytest.raises(WebSocketDisconnect):  # viser's client reconnects by itself
                socket.receive_bytes()
            other.send_bytes(b"still here")
            assert other.receive_bytes() == b"still here"
        for words in (b"first", b"again"):
            with connect(server) as socket:
                socket.send_bytes(words)
                assert socket.receive_bytes() == words
    assert at_light == [b"first", b"again"]
    assert at_dark == [b"other", b"still here"]


def test_two_pages_never_get_each_other_s_camera():
    async def run():
        stage = StubViewer()
        cameras = Cameras()
        cameras.listen(stage)
        order: list[str] = []

        async def slowly(page: str, number: int):
            async def pass_on():
                order.append(page)
                await asyncio.sleep(0.02)
                assert stage.on_connect is not None
                stage.on_connect(number)

            assert await cameras.pair(page, stage, pass_on)

        await asyncio.gather(slowly("a", 1), slowly("b", 2))
        for page, number in (("a", 1), ("b", 2)):
            await cameras.show(page, "all")
            assert stage.calls[-1] == ("fly", number, "all")

    asyncio.run(run())


def test_old_wishes_are_forgotten():
    async def run():
        cameras = Cameras()
        for number in range(3 * module.MOST_CLIENTS):
            await cameras.show(f"page {number}", "map")
        assert len(cameras._wanted) == 2 * module.MOST_CLIENTS

    asyncio.run(run())


def test_a_number_that_comes_after_the_end_is_dropped():
    loop = asyncio.new_event_loop()
    loop.close()
    _call(loop, lambda _: pytest.fail("called"), 1)


def test_a_browser_that_has_gone_before_its_stage_is_open_is_no_error():
    class Gone:
        client_state = WebSocketState.DISCONNECTED
        scope: ClassVar = {"subprotocols": ["viser-v1.1.1"]}

        async def accept(self, subprotocol: str) -> None:
            assert subprotocol == PROTOCOL

        async def close(self, _code: int) -> None:
            raise WebSocketDisconnect(1006)

    proxy = ViserProxy(StubViewers(), Cameras(), Themes())
    asyncio.run(proxy.relay(Gone(), PAGE))  # type: ignore[arg-type]
    assert not proxy.full
