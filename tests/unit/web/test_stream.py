"""The page's websocket: what it receives, what it may send and is answered, and what becomes of pages that stall."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Coroutine
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import orjson
import pytest
from starlette.testclient import WebSocketDenialResponse
from starlette.websockets import WebSocketState

from tests import patience
from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import OURS, PAGE, House, StubEngine, house
from tests.unit.web.frames import read_message, until
from web.http import asking, proxy, security
from web.http import stream as client_module
from web.http import stream as module
from web.http.proxy import Cameras
from web.http.stream import Client, Stream
from web.latest import Latest
from web.messages import Drive, Event, Pause, Refused, Snapshot
from web.panel.panel import Panel, PanelReader
from web.switches import Switches
from web.themes import Themes

SNAPSHOT = fake_snapshot(12)
ACCEPTED = {"type": "answer", "accepted": True}


def ask(socket: Any, text: str) -> dict[str, Any]:
    """What is answered to a message."""
    socket.send_text(text)
    return until(socket, "answer")


def parts(socket: Any, count: int) -> list[str]:
    """The names of the next `count` parts of the panel that arrive."""
    named: list[str] = []
    while len(named) < count:
        message = socket.receive()
        head, _ = read_message(message.get("bytes") or message["text"])
        if head["type"] == "panel":
            named.append(head["part"])
    return named


# ---------------------------------------------------------------- who is let in, and what is told


def test_at_most_32_pages_with_ids_that_are_some() -> None:
    with house() as served, contextlib.ExitStack() as pages:
        for page in ("short", "p" * 65, "p" * 21 + "/", "%00" * 22):
            with pytest.raises(WebSocketDenialResponse) as refused:
                served.client.websocket_connect(f"/api/stream?page={page}", headers=dict(OURS)).__enter__()
            assert refused.value.status_code == 422
        for _ in range(32):
            pages.enter_context(served.stream())
        with pytest.raises(WebSocketDenialResponse) as refused, served.stream():
            pass
        assert refused.value.status_code == 503


def test_greets_then_tells_the_state_and_only_new_events(served: House) -> None:
    with served.stream() as socket:
        hello = orjson.loads(socket.receive_text())
        assert (hello["type"], hello["views"]) == ("hello", ["all", "office", "pose", "map"])
        state = until(socket, "state")
        assert state["state"] == served.client.get("/api/state").json()
        assert set(state["page"]) == {
            "run", "doing", "status", "fault", "real_time_factor", "title", "worlds", "places", "office", "inspected",
            "walk", "vision", "pairs", "additions_off", "closure", "moving", "time", "trip", "recording", "situation", "back",
        }  # fmt: skip
        assert until(socket, "events")["fresh"]
        news = Event(1000, 1.3, "kidnap", "moved by hand")
        served.latest.put(replace(SNAPSHOT, tick=13, events=(*SNAPSHOT.events, news)))
        assert until(socket, "state")["state"]["tick"] == 13
        tail = until(socket, "events")
        assert (tail["fresh"], [event["number"] for event in tail["events"]]) == (False, [1000])
        served.latest.put(replace(SNAPSHOT, tick=1, run=2, events=()))
        again = until(socket, "events")
        assert (again["fresh"], again["events"], again["run"]) == (True, [], 2)


def test_a_page_that_confirms_gets_the_newest_when_it_is_ready(served: House) -> None:
    with served.stream(f"/api/stream?got=1&page={PAGE}") as slow, served.stream() as quick:
        until(slow, "events", fresh=True)
        for tick in (13, 14, 15):
            served.latest.put(replace(SNAPSHOT, tick=tick))
            while until(quick, "state")["state"]["tick"] != tick:
                pass
        slow.send_text('{"type": "got"}')
        assert until(slow, "state")["state"]["tick"] == 15


def test_only_open_tabs_are_told_and_each_page_has_its_own(served: House) -> None:
    with served.stream() as one, served.stream() as two:
        one.send_text('{"type": "tabs", "names": ["Senses"]}')
        assert parts(one, 2) == ["views", "cells"]
        two.send_text('{"type": "tabs", "names": ["Tune", "Memory"]}')
        assert parts(two, 3) == ["switches", "memory", "tune"]
        one.send_text('{"type": "tabs", "names": ["Truth"]}')
        assert parts(one, 3) == ["switches", "numbers", "series"]
        two.send_text('{"type": "tabs", "names": []}')
        served.latest.put(fake_snapshot(13))
        assert until(two, "state")["state"]["tick"] == 13
        assert ask(two, '{"type": "got", "id": 1}')["accepted"]  # and nothing of the panel was before it


def test_a_switch_is_turned_for_all_who_look(served: House) -> None:
    with served.stream() as one, served.stream() as two:
        for socket in (one, two):
            socket.send_text('{"type": "tabs", "names": ["Inspect"]}')
            assert parts(socket, 3) == ["switches", "active", "inspected"]
        assert not served.switches.is_on("click_inspects")
        assert ask(one, '{"type": "switch", "name": "click_inspects", "on": true, "id": 3}')["accepted"]
        assert parts(two, 1) == ["switches"]
        assert served.switches.is_on("click_inspects")


# ---------------------------------------------------------------- what a page may send, and what it is answered


def test_whatever_has_an_id_is_answered(served: House) -> None:
    with served.stream() as socket:
        assert ask(socket, '{"type": "pause", "id": 7}') == ACCEPTED | {"id": 7, "tick": 5}
        for message in ('"type": "theme", "name": "dark"', '"type": "view", "name": "map"', '"type": "got"'):
            assert ask(socket, f'{{{message}, "id": "mine"}}') == ACCEPTED | {"id": "mine", "tick": 12}
    assert served.engine.commands == [Pause(type="pause")]


CAMERA = '{"type": "camera", "name": "%s", "at": {"position": [%s], "look_at": [0, 0, 0], "fov_rad": 0.5}, "id": 1}'
SWITCH = "switch takes on, true or false, and name, one of: occupancy, "
TOO_DEEP = "nested too deeply"
WRONG = [
    ('{"type": "dance", "id": 1}', "is not a command"),
    ('{"type": "set_goal", "x": 1, "id": 1}', "y is missing"),
    ('{"type": "view", "name": "moon", "id": 1}', "view takes name, one of: all, office"),
    (CAMERA % ("map", "1, 2"), "camera takes at: "),
    (CAMERA % ("moon", "1, 2, 3"), "camera takes name, one of: all, office"),
    ('{"type": "theme", "name": "dark", "more": 1, "id": 1}', "theme takes name, one of: dark, light"),
    *((f'{{"type": "switch", {fields}, "id": 1}}', SWITCH)
      for fields in ('"name": "moon", "on": true', '"name": "occupancy"', '"name": "occupancy", "on": 1')),
    *((f'{{"type": "tabs", "names": {names}, "id": 1}}', "tabs takes names, a list of: Senses, Memory")
      for names in ("null", '"Senses"', '["Senses", 3]', '["Sense"]', '[["Senses"]]', "[{}]")),
    *(('{"id": 1, "type": ' + "[" * levels + "]" * levels + "}", reason)
      for levels, reason in ((21, TOO_DEEP), (255, TOO_DEEP), (1023, TOO_DEEP), (50_000, "depth limit exceeded"))),
    ("what?", "this is not JSON"),
    ('{"type": ["odd"]}', "is not a command"),
]  # fmt: skip


def test_what_is_wrong_is_answered_with_its_id_and_the_socket_lives(
    served: House, subtests: pytest.Subtests, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(security, "time", SimpleNamespace(monotonic=iter(range(1000)).__next__))  # all in good time
    with served.stream() as socket:
        for text, reason in WRONG:
            with subtests.test(msg=text[:60]):
                answer = ask(socket, text)
                identity = 1 if text.endswith('"id": 1}') else None  # whatever could not be read has none
                assert (answer["id"], answer["accepted"], answer["status"]) == (identity, False, 422)
                assert reason in answer["detail"][0]["reason"]
        assert ask(socket, '{"type": "pause", "id": 2}')["accepted"]


def test_refused_silent_and_broken_engines_are_told(served: House, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asking, "ANSWER_TIMEOUT_S", 0.02)
    with served.stream() as socket:
        for answer, status in [(Refused("x", 1, "no"), 422), (None, 503), (RuntimeError("oh"), 500)]:
            served.engine.answer = answer
            assert ask(socket, '{"type": "kidnap"}')["status"] == status


def test_other_commands_10_a_second(served: House, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(security, "time", SimpleNamespace(monotonic=lambda: 7.0))  # all at the same moment
    with served.stream() as socket:
        for number in range(14):
            socket.send_text(orjson.dumps({"type": "pause", "id": number}).decode())
        answers = [until(socket, "answer") for _ in range(14)]
    assert [answer["status"] for answer in answers if not answer["accepted"]] == 4 * [429]


def test_the_robot_stops_when_the_socket_that_drove_closes_and_only_then(served: House) -> None:
    commands = served.engine.commands
    with served.stream() as socket:
        assert ask(socket, '{"type": "drive", "speed": 0, "yaw_rate": 0, "id": 1}')["accepted"]
    with served.stream() as socket:
        until(socket, "state")
        assert len(commands) == 1  # it stood already, or never drove
        assert ask(socket, '{"type": "drive", "speed": 0.4, "yaw_rate": 0, "id": 1}')["accepted"]
    patience.until(lambda: len(commands) == 3)
    assert commands == [Drive(type="drive", speed=speed, yaw_rate=0.0) for speed in (0.0, 0.4, 0.0)]


# ---------------------------------------------------------------- pages that stall


class StalledSocket:
    """A browser that reads its greeting and then nothing more."""

    client_state = WebSocketState.CONNECTED

    def __init__(self) -> None:
        self.sent, self.stuck = 0, asyncio.Event()

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


Check = Callable[[Latest[Snapshot], StalledSocket, LiveSocket, asyncio.Task[None]], Coroutine[Any, Any, None]]


def while_both_are_served(check: Check) -> None:
    """Run `check(latest, stalled, live, task of the stalled one)` while a stream serves both."""

    async def run() -> None:
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


def test_a_stalled_page_slows_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_module, "SEND_TIMEOUT_S", 1e6)
    monkeypatch.setattr(module, "PERIOD_S", 0.001)
    monkeypatch.setattr(proxy, "CLOSE_TIMEOUT_S", 0.05)

    async def check(
        latest: Latest[Snapshot], stalled: StalledSocket, live: LiveSocket, task: asyncio.Task[None]
    ) -> None:
        await stalled.stuck.wait()
        for tick in range(30):
            live.news.clear()
            latest.put(replace(fake_snapshot(1), tick=2 + tick))
            await live.news.wait()
        assert not task.done()

    while_both_are_served(check)


def test_a_stalled_page_is_let_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_module, "SEND_TIMEOUT_S", 0.1)
    monkeypatch.setattr(proxy, "CLOSE_TIMEOUT_S", 0.05)

    async def check(_: Latest[Snapshot], stalled: StalledSocket, live: LiveSocket, task: asyncio.Task[None]) -> None:
        await asyncio.wait({task})
        assert stalled.stuck.is_set()
        assert live.news.is_set()

    while_both_are_served(check)


def test_a_client_s_background_failure_ends_nothing() -> None:
    async def run() -> None:
        client = Client(StalledSocket(), PAGE, False, PanelReader(Panel(Switches())))  # type: ignore[arg-type]

        async def fail() -> None:
            raise RuntimeError("the browser went away")

        client.background(fail())
        (task,) = client.tasks
        await asyncio.wait({task})
        assert not client.tasks

    asyncio.run(run())
