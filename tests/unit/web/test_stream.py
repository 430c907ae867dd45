"""The page's websocket: who is let in, and the newest state and events that it receives."""

from __future__ import annotations

import asyncio
import time
from dataclasses import replace

import orjson
import pytest
from starlette.testclient import WebSocketDenialResponse

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import OURS, PAGE, StubViewer, house
from tests.unit.web.frames import until
from web.http.proxy import Cameras
from web.messages import Event


@pytest.fixture
def server():
    with house() as made:
        yield made


def test_greets_then_tells_the_state_and_the_events(server):
    with server.stream() as socket:
        hello = orjson.loads(socket.receive_text())
        assert (hello["type"], hello["views"]) == ("hello", ["all", "office", "pose", "map"])
        state = until(socket, "state")
        assert state["state"] == server.client.get("/api/state").json()
        assert set(state["page"]) == {
            "run",
            "doing",
            "told",
            "fault",
            "real_time_factor",
            "title",
            "worlds",
            "places",
            "office",
            "inspected",
            "walk",
            "vision",
            "pairs",
            "additions_off",
            "closure",
            "moving",
            "time",
            "recording",
            "situation",
        }
        assert until(socket, "events")["fresh"]


def test_newest_state_wins_and_only_new_events_are_told(server):
    with server.stream() as socket:
        until(socket, "events", fresh=True)
        snapshot = fake_snapshot(12)
        news = Event(1000, 1.3, "kidnap", "moved by hand")
        server.latest.put(replace(snapshot, tick=13, events=(*snapshot.events, news)))
        assert until(socket, "state")["state"]["tick"] == 13
        tail = until(socket, "events")
        assert (tail["fresh"], [event["number"] for event in tail["events"]]) == (False, [1000])
        server.latest.put(replace(snapshot, tick=1, run=2, events=()))
        again = until(socket, "events")
        assert (again["fresh"], again["events"], again["run"]) == (True, [], 2)


def test_a_page_that_confirms_gets_the_newest_when_it_is_ready(server):
    with server.stream(f"/api/stream?got=1&page={PAGE}") as socket:
        until(socket, "events", fresh=True)
        snapshot = fake_snapshot(12)
        for tick in (13, 14, 15):
            server.latest.put(replace(snapshot, tick=tick))
            time.sleep(0.15)
        socket.send_text('{"type": "got"}')
        assert until(socket, "state")["state"]["tick"] == 15


def test_a_page_that_comes_before_the_first_tick_waits():
    with house(empty=True) as young, young.stream() as socket:
        until(socket, "hello")
        time.sleep(0.05)
        young.latest.put(fake_snapshot(1))
        assert until(socket, "state")["state"]["tick"] == 1


def test_a_view_flies_when_the_stage_is_there():
    async def run():
        stage = StubViewer()
        cameras = Cameras()
        cameras.listen(stage)
        await cameras.show(PAGE, "map")  # not there yet: remembered
        assert stage.calls == []

        async def message():
            assert stage.on_connect is not None
            stage.on_connect(4)

        assert await cameras.pair(PAGE, stage, message)
        assert stage.calls == [("jump", 4, "map")]
        await cameras.show(PAGE, "office")
        assert stage.calls[-1] == ("fly", 4, "office")

    asyncio.run(run())


def test_at_most_32_pages(server):
    sockets = []
    try:
        for _ in range(32):
            sockets.append(server.stream().__enter__())
        with pytest.raises(WebSocketDenialResponse) as refused, server.stream():
            pass
        assert refused.value.status_code == 503
    finally:
        for socket in sockets:
            socket.__exit__(None, None, None)


@pytest.mark.parametrize("page", ["short", "p" * 65, "p" * 21 + "/", "%00" * 22])
def test_a_page_s_id_is_checked(server, page):
    with pytest.raises(WebSocketDenialResponse) as refused:
        server.client.websocket_connect(f"/api/stream?page={page}", headers=dict(OURS)).__enter__()
    assert refused.value.status_code == 422
