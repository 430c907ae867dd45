"""viser through our port: its page, its websocket, and which camera is whose."""

from __future__ import annotations

import asyncio
import math
import threading
from collections.abc import Iterator
from typing import Any, ClassVar, cast

import numpy as np
import orjson
import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketDisconnect, WebSocketState

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S
from tests.unit.web.doubles import OURS, PAGE, House, StubViewer, StubViewers, house, viser_double
from tests.unit.web.frames import until
from web.http import proxy as module
from web.http.proxy import Cameras, ViserProxy
from web.themes import Themes
from web.viewer.camera_views import MAP_AT, camera_for, seen_by
from web.viewer.fits import MapFit, refit
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.pointer import NOT_THERE
from web.viewer.viser_server import client_page

pytestmark = pytest.mark.slow

PROTOCOL = "viser-v1.1.1"
OTHER = "q" * 22
Behind = tuple[House, list[bytes]]


@pytest.fixture
def behind() -> Iterator[Behind]:
    """A server, and what a viser behind it has received."""
    stage = StubViewer()
    with viser_double(stage) as got, house(stage=stage) as server:
        yield server, got


def connect(server: House, page: str = PAGE, protocols: tuple[str, ...] = (PROTOCOL,)) -> Any:
    return server.client.websocket_connect(f"/viser/ws/{page}", subprotocols=list(protocols), headers=dict(OURS))


def echoed(socket: Any, data: bytes = b"camera") -> bytes:
    """What viser answers to a message, the first of which gives it its number."""
    socket.send_bytes(data)
    return socket.receive_bytes()


async def arrive(cameras: Cameras, stage: StubViewer, number: int, page: str = PAGE, turns: int = 0) -> None:
    """A page's first message, at which a stage numbers its client after some turns of the loop."""
    cameras.listen(stage)

    async def pass_on() -> None:
        for _ in range(turns):
            await asyncio.sleep(0)
        assert stage.on_connect is not None
        stage.on_connect(number)

    assert await cameras.pair(page, stage, pass_on)


# ---------------------------------------------------------------- its page and its websocket


def test_the_client_s_page_is_read_once(behind: Behind, monkeypatch: pytest.MonkeyPatch) -> None:
    client = behind[0].client
    answer = client.get("/viser/")
    assert (answer.status_code, answer.content) == (200, client_page())
    assert client.get("/viser/", headers={"Accept-Encoding": "identity"}).content == client_page()
    assert "blob:" in answer.headers["content-security-policy"]
    monkeypatch.setattr(module, "client_page", None)  # to read it again would fail
    assert client.get("/viser/", headers={"If-None-Match": answer.headers["etag"]}).status_code == 304


def test_bytes_go_both_ways_with_viser_s_subprotocol_until_viser_ends(behind: Behind) -> None:
    server, got = behind
    said = [b"\x00camera", b"\x01other", b"text"]
    with connect(server, protocols=("chat", PROTOCOL)) as socket:
        assert socket.accepted_subprotocol == PROTOCOL
        assert [echoed(socket, data) for data in said] == said
        socket.send_bytes(b"leave")
        with pytest.raises(WebSocketDisconnect):
            socket.receive_bytes()
    with connect(server) as socket:
        socket.send_text("hello")  # is not viser's language
        with pytest.raises(WebSocketDisconnect):
            socket.receive_bytes()
    assert got == [*said, b"leave"]


def test_who_speaks_otherwise_has_no_id_or_comes_too_many_is_refused(
    behind: Behind, subtests: pytest.Subtests, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, _ = behind
    for name in ("", "chat", "viser-v", "viser-v1.1.1 or so", "Viser-v1.1.1", "viser-v" + "1" * 40):
        with subtests.test(protocol=name):
            talk = connect(server, protocols=(name,) if name else ())
            with pytest.raises(WebSocketDenialResponse) as refused, talk:
                pass
            assert refused.value.status_code == 400
            assert "viser-v" in refused.value.json()["detail"][0]["reason"]
    for page in ("short", "..%5c..%5cetc", "p" * 65):
        with subtests.test(page=page), pytest.raises(WebSocketDenialResponse) as refused:
            connect(server, page).__enter__()
        assert refused.value.status_code == 404
    with pytest.raises(WebSocketDisconnect):
        connect(server, "..%2f..%2fetc").__enter__()
    monkeypatch.setattr(module, "MOST_CLIENTS", 1)
    with connect(server), pytest.raises(WebSocketDenialResponse) as refused:
        connect(server, OTHER).__enter__()
    assert refused.value.status_code == 503


def test_without_viser_or_its_secret_the_browser_may_try_again(behind: Behind) -> None:
    server, _ = behind
    server.stage.secret += "?"  # as it would be with another server on viser's port
    for port in (server.stage.port, 1):  # nobody listens there
        server.stage.port = port
        with connect(server) as socket, pytest.raises(WebSocketDisconnect) as refused:
            socket.receive_bytes()
        assert refused.value.code == 1013


def test_it_is_accepted_before_its_viewer_is_there(behind: Behind, monkeypatch: pytest.MonkeyPatch) -> None:
    """viser's client breaks off what is not open within a second and begins anew: with a viewer that is built for longer than
    that, each time, the stage would never come back."""
    built, plain = threading.Event(), StubViewers.of

    def of(viewers: StubViewers, *look: Any) -> StubViewer:
        assert built.wait(PATIENCE_S)
        return plain(viewers, *look)

    monkeypatch.setattr(StubViewers, "of", of)
    with connect(behind[0]) as socket:  # it is open
        socket.send_bytes(b"camera")
        built.set()
        assert socket.receive_bytes() == b"camera"


def test_a_browser_that_has_gone_before_its_stage_is_open_is_no_error() -> None:
    class Gone:
        client_state = WebSocketState.DISCONNECTED
        scope: ClassVar = {"subprotocols": [PROTOCOL]}

        async def accept(self, subprotocol: str) -> None:
            assert subprotocol == PROTOCOL

        async def close(self, _code: int) -> None:
            raise WebSocketDisconnect(1006)

    proxy = ViserProxy(StubViewers(), Cameras(), Themes())
    asyncio.run(proxy.relay(Gone(), PAGE))  # type: ignore[arg-type]
    assert not proxy.full


def test_each_page_is_shown_the_stage_of_its_theme() -> None:
    dark, light = StubViewer(), StubViewer()
    with viser_double(dark) as at_dark, viser_double(light) as at_light, house(stage=dark, light=light) as server:
        with server.stream() as stream, connect(server, OTHER) as other, connect(server) as socket:
            assert echoed(other, b"other") == b"other"
            stream.send_text('{"type": "theme", "name": "light"}')
            with pytest.raises(WebSocketDisconnect):  # viser's client reconnects by itself
                socket.receive_bytes()
            assert echoed(other, b"still here") == b"still here"
        for words in (b"first", b"again"):
            with connect(server) as socket:
                assert echoed(socket, words) == words
    assert at_light == [b"first", b"again"]
    assert at_dark == [b"other", b"still here"]


# ---------------------------------------------------------------- clicks, and what is told


def test_a_refusal_on_a_stage_is_told_to_the_page_it_is_of(behind: Behind) -> None:
    server, _ = behind
    complain = server.stage
    with server.stream() as one, server.stream(f"/api/stream?page={OTHER}") as two:
        with connect(server) as first, connect(server, OTHER) as second:
            echoed(first)
            echoed(second)
            assert complain.on_complaint is not None
            for client_id, text in ((1, "No goal set: too far"), (0, "Not done: a wall"), (5, "whose?")):
                complain.on_complaint(client_id, text)
            assert until(one, "notice")["text"] == "Not done: a wall"
            assert until(two, "notice")["text"] == "No goal set: too far"
        complain.on_complaint(0, "after its end")


def test_a_click_on_the_stage_is_answered(behind: Behind, monkeypatch: pytest.MonkeyPatch) -> None:
    """Done, refused, on a stage that is not there, or not heard of again: its page is told each time."""
    server, _ = behind
    click = {"type": "click", "at": [0.25, -0.5], "shift": True, "drawn": None}

    def said(number: int, **other: object) -> Any:
        stream.send_text(orjson.dumps(click | other | {"id": number}).decode())
        answer = until(stream, "answer", id=number)
        return answer["accepted"] or answer["detail"][0]["reason"]

    with server.stream() as stream:
        assert said(1) == NOT_THERE
        with connect(server) as socket:
            echoed(socket)
            server.stage.comes_of_clicks = [None, "No goal set: that is beside the map"]
            assert said(2) is True
            assert server.stage.calls[-1] == ("press", 0, (0.25, -0.5), True)
            assert said(3, shift=False) == "No goal set: that is beside the map"
            monkeypatch.setattr(module, "CLICK_S", 0.05)
            assert "not answered" in said(4)
        assert "Input should be" in said(5, at="here")


def test_what_a_click_would_do_is_told_to_the_page_that_points(behind: Behind) -> None:
    server, _ = behind
    with server.stream() as stream, connect(server) as socket:
        echoed(socket)
        for at in ("nowhere", [0.5, 0.25]):
            stream.send_text(orjson.dumps({"type": "hover", "at": at}).decode())
        assert until(stream, "hint")["words"] == "client 0 points at (0.5, 0.25)"


def test_a_click_on_the_drawing_is_one_on_the_map(behind: Behind) -> None:
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
    goal, inspected = cast(Any, server.engine.commands)
    assert (goal.x, goal.y) == pytest.approx(tuple(snapshot.map.xy[0]), abs=1e-4)
    assert np.hypot(*(snapshot.map.xy[inspected.experience] - snapshot.map.xy[0])) < 0.05


# ---------------------------------------------------------------- which camera is whose


def test_a_page_s_view_flies_its_own_camera(behind: Behind) -> None:
    server, _ = behind
    with server.stream() as stream:
        stream.send_text('{"type": "view", "name": "map"}')
        stream.send_text('{"type": "pause", "id": 1}')
        until(stream, "answer")
        with connect(server) as socket:
            echoed(socket)
            assert server.stage.called.wait(PATIENCE_S)
            assert server.stage.calls == [("jump", 0, "map")]
            server.stage.called.clear()
            stream.send_text('{"type": "view", "name": "pose"}')
            assert server.stage.called.wait(PATIENCE_S)
            assert server.stage.calls[-1] == ("fly", 0, "pose")


def test_a_message_that_brings_no_number_waits_and_the_late_one_is_still_right(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PAIRING_S", 0.01)

    async def nothing() -> None:
        pass

    async def run() -> None:
        stage, cameras = StubViewer(), Cameras()
        cameras.listen(stage)
        assert stage.on_connect is not None
        assert not await cameras.pair(PAGE, stage, nothing)
        assert not await cameras.pair(PAGE, stage, nothing)
        stage.on_connect(3)
        await asyncio.sleep(0)
        assert cameras.paired(PAGE)
        cameras.unpair(PAGE, stage)
        assert not cameras.paired(PAGE)
        stage.on_connect(4)  # nobody waits for it
        await asyncio.sleep(0)
        assert not cameras.paired(PAGE)

    asyncio.run(run())


def test_a_page_that_went_to_another_stage_keeps_its_camera_there() -> None:
    async def run() -> None:
        dark, light, cameras = StubViewer(), StubViewer(), Cameras()
        await arrive(cameras, dark, 0)
        await arrive(cameras, light, 5)  # before the end of the other connection is noticed
        cameras.unpair(PAGE, dark)
        await cameras.show(PAGE, "map")
        assert (dark.calls, light.calls) == ([], [("fly", 5, "map")])

    asyncio.run(run())


def test_two_pages_never_get_each_other_s_camera_and_a_number_of_one_stage_is_nobody_s_at_the_other() -> None:
    async def run() -> None:
        dark, light, cameras = StubViewer(), StubViewer(), Cameras()
        cameras.listen(dark)
        assert dark.on_connect is not None
        waiting = asyncio.gather(arrive(cameras, light, 1, "a", turns=5), arrive(cameras, light, 2, "b", turns=5))
        await asyncio.sleep(0)
        dark.on_connect(3)
        await waiting
        for page, number in (("a", 1), ("b", 2)):
            await cameras.show(page, "all")
            assert light.calls[-1] == ("fly", number, "all")
        assert dark.calls == []

    asyncio.run(run())


def test_old_wishes_are_forgotten() -> None:
    async def run() -> None:
        stage, cameras, most = StubViewer(), Cameras(), 2 * module.MOST_CLIENTS
        for number in range(most + 1):
            await cameras.show(f"page {number}", "map")
        for number in range(3):
            await arrive(cameras, stage, number, f"page {number}")
        assert stage.calls == [("jump", 1, "map"), ("jump", 2, "map")]

    asyncio.run(run())


def test_what_is_heard_of_a_stage_after_the_end_is_dropped() -> None:
    stage, cameras = StubViewer(), Cameras()

    async def run() -> None:
        cameras.listen(stage)

    asyncio.run(run())
    assert stage.on_connect is not None
    assert stage.on_complaint is not None
    stage.on_connect(1)
    stage.on_complaint(1, "too late")
