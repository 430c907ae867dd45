"""The page's websocket: what it is told, what it may say, and that nobody slows the others."""

from __future__ import annotations

import asyncio
import time
from dataclasses import replace

import orjson
import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketState

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import OURS, PAGE, StubEngine, StubStage, house
from web import proxy
from web import stream as module
from web.latest import Latest
from web.messages import Drive, Event, Pause, Refused, Snapshot
from web.proxy import Cameras
from web.stream import Client, Stream


@pytest.fixture
def server():
    with house() as made:
        yield made


def until(socket, kind, **fields):
    """The next message of this kind with these fields."""
    while True:
        message = orjson.loads(socket.receive_text())
        if message["type"] == kind and all(message[name] == value for name, value in fields.items()):
            return message


def wait_for(condition):
    deadline = time.monotonic() + 3
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def test_greets_then_tells_the_state_and_the_events(server):
    with server.stream() as socket:
        hello = orjson.loads(socket.receive_text())
        assert (hello["type"], hello["views"]) == ("hello", ["all", "office", "pose", "map"])
        state = until(socket, "state")
        assert state["state"] == server.client.get("/api/state").json()
        assert state["theme"] is None
        assert set(state["page"]) == {
            "run",
            "doing",
            "lost",
            "fault",
            "real_time_factor",
            "title",
            "worlds",
            "places",
            "office",
            "inspected",
            "walk",
            "moving",
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


def test_a_command_with_an_id_is_answered(server):
    with server.stream() as socket:
        socket.send_text('{"type": "pause", "id": 7}')
        assert until(socket, "answer") == {"type": "answer", "id": 7, "accepted": True, "tick": 5}
    assert server.engine.commands == [Pause(type="pause")]


@pytest.mark.parametrize(
    ("text", "status", "reason"),
    [
        ('{"type": "dance", "id": 1}', 422, "is not a command"),
        ('{"type": "set_goal", "x": 1, "id": 1}', 422, "y is missing"),
        ('{"type": "view", "name": "moon", "id": 1}', 422, "view takes name, one of: all, office"),
        ('{"type": "theme", "name": "dark", "more": 1, "id": 1}', 422, "theme takes name, one of: dark, light"),
    ],
)
def test_what_is_wrong_is_answered_with_its_id(server, text, status, reason):
    with server.stream() as socket:
        socket.send_text(text)
        answer = until(socket, "answer")
        assert (answer["id"], answer["accepted"], answer["status"]) == (1, False, status)
        assert reason in answer["detail"][0]["reason"]


def test_no_json_is_answered_and_the_socket_lives(server):
    with server.stream() as socket:
        socket.send_text("what?")
        assert until(socket, "answer")["id"] is None
        socket.send_text('{"type": ["odd"]}')
        assert until(socket, "answer")["status"] == 422
        socket.send_text('{"type": "pause", "id": 2}')
        assert until(socket, "answer")["accepted"]


def test_refused_silent_and_broken_engines_are_told(server, monkeypatch):
    monkeypatch.setattr(module, "ANSWER_TIMEOUT_S", 0.02)
    with server.stream() as socket:
        for answer, status in [(Refused("x", 1, "no"), 422), (None, 503), (RuntimeError("oh"), 500)]:
            server.engine.answer = answer
            socket.send_text('{"type": "kidnap"}')
            assert until(socket, "answer")["status"] == status


def test_other_commands_10_a_second(server):
    with server.stream() as socket:
        for number in range(14):
            socket.send_text(orjson.dumps({"type": "pause", "id": number}).decode())
        answers = [until(socket, "answer") for _ in range(14)]
        refused = [answer for answer in answers if not answer["accepted"]]
        assert refused
        assert all(answer["status"] == 429 for answer in refused)


def test_the_robot_stops_when_the_socket_that_drove_closes(server):
    with server.stream() as socket:
        socket.send_text('{"type": "drive", "speed": 0.4, "yaw_rate": 0}')
        wait_for(lambda: server.engine.commands)
    wait_for(lambda: len(server.engine.commands) == 2)
    assert server.engine.commands[-1] == Drive(type="drive", speed=0.0, yaw_rate=0.0)


def test_no_stop_is_sent_when_it_stood_already_or_never_drove(server):
    with server.stream() as socket:
        socket.send_text('{"type": "drive", "speed": 0, "yaw_rate": 0}')
        wait_for(lambda: server.engine.commands)
    with server.stream() as socket:
        until(socket, "state")
    assert len(server.engine.commands) == 1


def test_theme_is_everyones(server):
    with server.stream() as one, server.stream() as two:
        until(one, "state")
        two.send_text('{"type": "theme", "name": "light"}')
        assert until(one, "state", theme="light")
    wait_for(lambda: server.stage.calls)
    assert server.stage.calls == [("set_theme", "light")]
    with server.stream() as socket:
        socket.send_text('{"type": "theme", "name": "dark"}')
        assert until(socket, "state", theme="dark")


def test_a_view_flies_when_the_stage_is_there():
    async def run():
        stage = StubStage()
        cameras = Cameras(stage)
        cameras.listen()
        await cameras.show(PAGE, "map")  # not there yet: remembered
        assert stage.calls == []

        async def message():
            assert stage.on_connect is not None
            stage.on_connect(4)

        assert await cameras.pair(PAGE, message)
        assert stage.calls == [("fly", 4, "map")]
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
    wait_for(lambda: True)


@pytest.mark.parametrize("page", ["short", "p" * 65, "p" * 21 + "/", "%00" * 22])
def test_a_page_s_id_is_checked(server, page):
    with pytest.raises(WebSocketDenialResponse) as refused:
        server.client.websocket_connect(f"/api/stream?page={page}", headers=OURS).__enter__()
    assert refused.value.status_code == 422


class StalledSocket:
    """A browser that takes its greeting and then nothing more."""

    def __init__(self) -> None:
        self.sent = 0
        self.client_state = WebSocketState.CONNECTED

    async def close(self, _code: int) -> None:
        await asyncio.sleep(60)

    async def accept(self) -> None:
        pass

    async def send_text(self, _text: str) -> None:
        self.sent += 1
        if self.sent > 1:
            await asyncio.sleep(60)

    async def receive_text(self) -> str:
        await asyncio.sleep(60)
        return ""


def test_a_stalled_page_is_let_go_and_slows_nobody(monkeypatch):
    monkeypatch.setattr(module, "SEND_TIMEOUT_S", 0.1)
    monkeypatch.setattr(proxy, "CLOSE_TIMEOUT_S", 0.05)
    monkeypatch.setattr(module, "PERIOD_S", 0.001)

    class LiveSocket(StalledSocket):
        async def send_text(self, _text: str) -> None:
            self.sent += 1

    async def run():
        latest: Latest[Snapshot] = Latest()
        latest.put(fake_snapshot(1))
        stage = StubStage()
        stream = Stream(latest, StubEngine().submit, stage, Cameras(stage))
        publishing = asyncio.create_task(stream.publish())
        stalled, live = StalledSocket(), LiveSocket()
        tasks = [asyncio.create_task(stream.serve(socket, PAGE)) for socket in (stalled, live)]  # type: ignore[arg-type]
        snapshot = fake_snapshot(1)
        for tick in range(30):
            latest.put(replace(snapshot, tick=tick))
            await asyncio.sleep(0.01)
        assert tasks[0].done()
        assert live.sent > 20
        for task in (*tasks, publishing):
            task.cancel()
        await asyncio.gather(*tasks, publishing, return_exceptions=True)

    asyncio.run(run())


def test_a_client_s_background_failure_ends_nothing():
    async def run():
        stage = StubStage()
        stream = Stream(Latest(), StubEngine().submit, stage, Cameras(stage))
        client = Client(StalledSocket(), PAGE, False)  # type: ignore[arg-type]

        async def fail():
            raise RuntimeError("the browser went away")

        stream._background(client, fail())
        await asyncio.sleep(0.01)
        assert client.answers == set()

    asyncio.run(run())
