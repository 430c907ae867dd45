"""The page's websocket: what it receives, what it may send, and that no page slows the others."""

from __future__ import annotations

import asyncio
import time
from dataclasses import replace
from types import SimpleNamespace

import orjson
import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketState

from tests import patience
from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import OURS, PAGE, StubEngine, StubViewer, house
from tests.unit.web.frames import read_frame
from web.http import asking, proxy, security
from web.http import client as client_module
from web.http import stream as module
from web.http.client import Client
from web.http.proxy import Cameras
from web.http.stream import Stream
from web.latest import Latest
from web.messages import Drive, Event, Pause, Refused, Snapshot
from web.panel.panel import Panel, PanelReader
from web.switches import Switches
from web.themes import Themes


@pytest.fixture
def server():
    with house() as made:
        yield made


def until(socket, kind, **fields):
    """The next message of this kind with these fields."""
    while True:
        message = orjson.loads(socket.receive().get("text") or '{"type": "a part with arrays"}')
        if message["type"] == kind and all(message[name] == value for name, value in fields.items()):
            return message


def test_greets_then_tells_the_state_and_the_events(server):
    with server.stream() as socket:
        hello = orjson.loads(socket.receive_text())
        assert (hello["type"], hello["views"]) == ("hello", ["all", "office", "pose", "map"])
        state = until(socket, "state")
        assert state["state"] == server.client.get("/api/state").json()
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
    monkeypatch.setattr(asking, "ANSWER_TIMEOUT_S", 0.02)
    with server.stream() as socket:
        for answer, status in [(Refused("x", 1, "no"), 422), (None, 503), (RuntimeError("oh"), 500)]:
            server.engine.answer = answer
            socket.send_text('{"type": "kidnap"}')
            assert until(socket, "answer")["status"] == status


def test_other_commands_10_a_second(server, monkeypatch):
    monkeypatch.setattr(security, "time", SimpleNamespace(monotonic=lambda: 7.0))  # all at the same moment
    with server.stream() as socket:
        for number in range(14):
            socket.send_text(orjson.dumps({"type": "pause", "id": number}).decode())
        answers = [until(socket, "answer") for _ in range(14)]
        refused = [answer for answer in answers if not answer["accepted"]]
        assert [answer["status"] for answer in refused] == 4 * [429]


def test_the_robot_stops_when_the_socket_that_drove_closes(server):
    with server.stream() as socket:
        socket.send_text('{"type": "drive", "speed": 0.4, "yaw_rate": 0}')
        patience.until(lambda: server.engine.commands)
    patience.until(lambda: len(server.engine.commands) == 2)
    assert server.engine.commands[-1] == Drive(type="drive", speed=0.0, yaw_rate=0.0)


def test_no_stop_is_sent_when_it_stood_already_or_never_drove(server):
    with server.stream() as socket:
        socket.send_text('{"type": "drive", "speed": 0, "yaw_rate": 0}')
        patience.until(lambda: server.engine.commands)
    with server.stream() as socket:
        until(socket, "state")
    assert len(server.engine.commands) == 1


@pytest.mark.parametrize(
    "message", ['"type": "theme", "name": "dark"', '"type": "view", "name": "map"', '"type": "got"']
)
def test_whatever_has_an_id_is_answered(server, message):
    with server.stream() as socket:
        socket.send_text(f'{{{message}, "id": "mine"}}')
        assert until(socket, "answer") == {"type": "answer", "id": "mine", "accepted": True, "tick": 12}


def test_what_is_nested_too_deeply_is_answered_and_the_socket_stays(server):
    with server.stream() as socket:
        for levels in (21, 255, 1023, 50_000):
            socket.send_text('{"id": 1, "type": ' + "[" * levels + "]" * levels + "}")
            answer = until(socket, "answer")
            assert (answer["id"], answer["status"]) == (None, 422)
        socket.send_text('{"type": "pause", "id": 2}')
        assert until(socket, "answer")["accepted"]


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


class StalledSocket:
    """A browser that reads its greeting and then nothing more."""

    def __init__(self) -> None:
        self.sent = 0
        self.stuck = asyncio.Event()
        self.client_state = WebSocketState.CONNECTED

    async def close(self, _code: int) -> None:
        await asyncio.Event().wait()

    async def accept(self) -> None:
        pass

    async def send_text(self, _text: str) -> None:
        self.sent += 1
        if self.sent > 1:
            self.stuck.set()
            await asyncio.Event().wait()

    async def receive_text(self) -> str:
        await asyncio.Event().wait()
        return ""


class LiveSocket(StalledSocket):
    """A browser that reads everything."""

    def __init__(self) -> None:
        super().__init__()
        self.news = asyncio.Event()

    async def send_text(self, _text: str) -> None:
        self.news.set()


def served(check):
    """Run `check(latest, stalled, live, task of the stalled one)` while a stream serves both."""

    async def run():
        latest: Latest[Snapshot] = Latest()
        latest.put(fake_snapshot(1))
        stream = Stream(latest, StubEngine().submit, Cameras(), Themes(), Switches())
        stalled, live = StalledSocket(), LiveSocket()
        tasks = [asyncio.create_task(stream.serve(socket, PAGE)) for socket in (stalled, live)]  # type: ignore[arg-type]
        tasks.append(asyncio.create_task(stream.publish()))
        await check(latest, stalled, live, tasks[0])
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    asyncio.run(asyncio.wait_for(run(), patience.PATIENCE_S))


def test_a_stalled_page_slows_nobody(monkeypatch):
    monkeypatch.setattr(client_module, "SEND_TIMEOUT_S", 1e6)
    monkeypatch.setattr(module, "PERIOD_S", 0.001)
    monkeypatch.setattr(proxy, "CLOSE_TIMEOUT_S", 0.05)

    async def check(latest, stalled, live, task):
        await stalled.stuck.wait()
        for tick in range(30):
            live.news.clear()
            latest.put(replace(fake_snapshot(1), tick=2 + tick))
            await live.news.wait()
        assert not task.done()

    served(check)


def test_a_stalled_page_is_let_go(monkeypatch):
    monkeypatch.setattr(client_module, "SEND_TIMEOUT_S", 0.1)
    monkeypatch.setattr(proxy, "CLOSE_TIMEOUT_S", 0.05)

    async def check(_latest, stalled, live, task):
        await asyncio.wait({task})
        assert stalled.stuck.is_set()
        assert live.news.is_set()

    served(check)


def test_a_client_s_background_failure_ends_nothing():
    async def run():
        client = Client(StalledSocket(), PAGE, False, PanelReader(Panel(Switches())))  # type: ignore[arg-type]

        async def fail():
            raise RuntimeError("the browser went away")

        client.background(fail())
        assert len(client.tasks) == 1
        while client.tasks:
            await asyncio.sleep(0.001)

    asyncio.run(run())


def parts(socket, count: int) -> list[str]:
    """The names of the next `count` parts of the panel that arrive."""
    named = []
    while len(named) < count:
        message = socket.receive()
        raw = message.get("bytes")
        head = read_frame(raw)[0] if raw else orjson.loads(message["text"])
        if head["type"] == "panel":
            named.append(head["part"])
    return named


def test_only_open_tabs_are_told_and_each_page_has_its_own(server):
    with server.stream() as one, server.stream() as two:
        one.send_text('{"type": "tabs", "names": ["Senses"]}')
        assert parts(one, 2) == ["views", "cells"]
        two.send_text('{"type": "tabs", "names": ["Tune", "Memory"]}')
        assert parts(two, 3) == ["switches", "memory", "tune"]
        one.send_text('{"type": "tabs", "names": ["Truth"]}')
        assert parts(one, 2) == ["numbers", "series"]
        two.send_text('{"type": "tabs", "names": []}')
        server.latest.put(fake_snapshot(13))
        assert until(two, "state")["state"]["tick"] == 13
        two.send_text('{"type": "got", "id": 1}')
        assert until(two, "answer")["accepted"]  # and nothing of the panel was before it


def test_a_switch_is_turned_for_all_who_look(server):
    with server.stream() as one, server.stream() as two:
        for socket in (one, two):
            socket.send_text('{"type": "tabs", "names": ["Inspect"]}')
            assert parts(socket, 3) == ["switches", "active", "inspected"]
        assert not server.switches.is_on("click_inspects")
        one.send_text('{"type": "switch", "name": "click_inspects", "on": true, "id": 3}')
        assert until(one, "answer")["accepted"]
        assert parts(two, 1) == ["switches"]
        assert server.switches.is_on("click_inspects")


@pytest.mark.parametrize(
    "fields", ['"name": "moon", "on": true', '"name": "occupancy"', '"name": "occupancy", "on": 1']
)
def test_a_switch_that_is_none_is_a_sentence(server, fields):
    with server.stream() as socket:
        socket.send_text(f'{{"type": "switch", {fields}}}')
        (wrong,) = until(socket, "answer")["detail"]
        assert wrong["reason"].startswith("switch takes on, true or false, and name, one of: occupancy, ")


@pytest.mark.parametrize("names", ["null", '"Senses"', '["Senses", 3]', '["Sense"]', '[["Senses"]]', "[{}]"])
def test_tabs_that_do_not_exist_are_a_sentence(server, names):
    with server.stream() as socket:
        socket.send_text(f'{{"type": "tabs", "names": {names}}}')
        wrong = until(socket, "answer")["detail"][0]
        assert wrong["field"] == "names"
        assert wrong["reason"].startswith("tabs takes names, a list of: Senses, Memory")
