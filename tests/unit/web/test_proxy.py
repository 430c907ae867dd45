"""viser through our port: its page, its websocket, and which camera is whose."""

from __future__ import annotations

import asyncio

import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketDisconnect

from tests.unit.web.doubles import OURS, PAGE, StubStage, house, viser_double
from web import proxy as module
from web.proxy import Cameras, _call

PROTOCOL = "viser-v1.1.1"


@pytest.fixture
def behind():
    stage = StubStage()
    with viser_double(stage) as got, house(stage=stage) as server:
        yield server, got


def connect(server, page=PAGE):
    return server.client.websocket_connect(f"/viser/ws/{page}", subprotocols=[PROTOCOL], headers=OURS)


def test_the_client_s_page_comes_from_viser_once(behind, monkeypatch):
    server, _ = behind
    answer = server.client.get("/viser/")
    assert (answer.status_code, answer.text) == (200, "page")
    assert server.client.get("/viser/", headers={"Accept-Encoding": "identity"}).text == "page"
    assert "blob:" in answer.headers["content-security-policy"]
    monkeypatch.setattr(module, "_fetch", None)  # a second fetch would fail
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
            assert server.stage.called.wait(3)
            assert server.stage.calls == [("fly", 0, "map")]
            server.stage.called.clear()
            stream.send_text('{"type": "view", "name": "pose"}')
            assert server.stage.called.wait(3)
            assert server.stage.calls[-1] == ("fly", 0, "pose")


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
    stage = StubStage(port=1)  # nobody listens there
    with house(stage=stage) as server, pytest.raises(WebSocketDisconnect), connect(server) as socket:
        socket.receive_bytes()


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
        stage = StubStage()
        cameras = Cameras(stage)
        cameras.listen()
        assert stage.on_connect is not None
        assert not await cameras.pair(PAGE, nothing)
        assert not await cameras.pair(PAGE, nothing)
        stage.on_connect(3)
        await asyncio.sleep(0.01)
        assert cameras.paired(PAGE)
        cameras.unpair(PAGE)
        assert not cameras.paired(PAGE)
        stage.on_connect(4)  # nobody waits for it
        await asyncio.sleep(0.01)

    asyncio.run(run())


def test_two_pages_never_get_each_other_s_camera():
    async def run():
        stage = StubStage()
        cameras = Cameras(stage)
        cameras.listen()
        order: list[str] = []

        async def slowly(page: str, number: int):
            async def pass_on():
                order.append(page)
                await asyncio.sleep(0.02)
                assert stage.on_connect is not None
                stage.on_connect(number)

            assert await cameras.pair(page, pass_on)

        await asyncio.gather(slowly("a", 1), slowly("b", 2))
        for page, number in (("a", 1), ("b", 2)):
            await cameras.show(page, "all")
            assert stage.calls[-1] == ("fly", number, "all")

    asyncio.run(run())


def test_old_wishes_are_forgotten():
    async def run():
        cameras = Cameras(StubStage())
        for number in range(3 * module.MOST_CLIENTS):
            await cameras.show(f"page {number}", "map")
        assert len(cameras._wanted) == 2 * module.MOST_CLIENTS

    asyncio.run(run())


def test_a_number_that_comes_after_the_end_is_dropped():
    loop = asyncio.new_event_loop()
    loop.close()
    _call(loop, lambda _: pytest.fail("called"), 1)
