"""A page that stops reading slows no other page, and is let go."""

from __future__ import annotations

import asyncio
from dataclasses import replace

from starlette.websockets import WebSocketState

from tests import patience
from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import PAGE, StubEngine
from web.http import client as client_module
from web.http import proxy
from web.http import stream as module
from web.http.client import Client
from web.http.proxy import Cameras
from web.http.stream import Stream
from web.latest import Latest
from web.messages import Snapshot
from web.panel.panel import Panel, PanelReader
from web.switches import Switches
from web.themes import Themes


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
