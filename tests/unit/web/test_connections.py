"""Browsers that come and go leave nothing behind, and one that reads nothing keeps nobody waiting."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import psutil
import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect as connect_now

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S, until
from tests.unit.web.doubles import StubEngine, StubViewer, StubViewers, viser_double
from tests.unit.web.test_viser_server import PROTOCOL, camera
from web.http import proxy
from web.http.proxy import ViewersLike
from web.http.server import Dashboard
from web.latest import Latest
from web.viewer import Viewers

ROUNDS, AT_ONCE = 50, 10


@contextlib.contextmanager
def served(stages: ViewersLike) -> Iterator[Dashboard]:
    latest, ready = Latest(), threading.Event()
    latest.put(fake_snapshot(3))
    made = Dashboard(latest, StubEngine().submit, stages, port=0, on_ready=lambda _url: ready.set())
    thread = threading.Thread(target=made.run)
    thread.start()
    try:
        assert ready.wait(PATIENCE_S)
        yield made
    finally:
        made.stop()
        thread.join()


def left_behind(made: Dashboard) -> dict[str, int]:
    """What the process holds for connections: threads except asyncio's own pool, tasks of the server's loop, open files."""
    assert made._server is not None
    loop = made._server.servers[0].get_loop()
    return {
        "threads": sum(not thread.name.startswith("asyncio_") for thread in threading.enumerate()),
        "tasks": len(asyncio.all_tasks(loop)),
        "files": psutil.Process().num_fds() if hasattr(psutil.Process, "num_fds") else psutil.Process().num_handles(),
    }


def ours(made: Dashboard) -> str:
    return made.url.removesuffix("/")


async def enter(url: str, origin: str, **options: Any) -> ClientConnection:
    while True:  # the seats of those who have just gone may not be free yet
        try:
            return await connect(url, origin=origin, **options)  # type: ignore[arg-type]
        except InvalidStatus as full:
            if full.response.status_code != 503:
                raise
            await asyncio.sleep(0.01)


async def visit(made: Dashboard, number: int) -> None:
    """A page and its viewer; every other one is cut off instead of closing its connection."""
    where, page = ours(made), f"page-{number:020d}"
    stream = await enter(f"{where.replace('http', 'ws')}/api/stream?page={page}", where)
    await stream.send('{"type": "theme", "name": "light"}')
    await stream.send('{"type": "view", "name": "map"}')
    await stream.recv()
    stage = await enter(f"{where.replace('http', 'ws')}/viser/ws/{page}", where, subprotocols=[PROTOCOL])
    await stage.send(b"camera")
    assert await stage.recv() == b"camera"
    for talk in (stream, stage):
        if number % 2:
            talk.transport.abort()
        else:
            await talk.close()


async def visits(made: Dashboard, rounds: int) -> None:
    for number in range(rounds):
        await asyncio.gather(*(visit(made, number * AT_ONCE + seat) for seat in range(AT_ONCE)))


@pytest.mark.slow
def test_a_thousand_connections_leave_no_thread_task_or_file_behind() -> None:
    stage = StubViewer()
    with viser_double(stage), served(StubViewers(stage)) as made:  # type: ignore[arg-type]
        before = settled(lambda: left_behind(made))
        asyncio.run(visits(made, 1))  # the first ones make what is made once
        asyncio.run(visits(made, ROUNDS))
        until(lambda: all(now <= before[name] for name, now in left_behind(made).items()), (before, left_behind(made)))


def settled(look: Callable[[], dict[str, int]]) -> dict[str, int]:
    """What is seen once start-up work is over, such as the tasks of a server that has just begun."""
    seen: list[dict[str, int]] = []

    def still() -> bool:
        seen.append(look())
        return len(seen) > 20 and all(one == seen[-1] for one in seen[-20:])

    until(still)
    return seen[-1]


@pytest.mark.slow
def test_a_browser_that_takes_nothing_of_the_stage_keeps_nobody_waiting(monkeypatch) -> None:
    """Far more is drawn than fits into the buffers between the viewer and the browser that stalls."""
    monkeypatch.setattr(proxy, "SEND_TIMEOUT_S", 1e6)  # so that it is never disconnected
    stages = Viewers(Latest(), StubEngine().submit)
    with served(stages) as made, contextlib.closing(narrow_line(made)) as line:
        stage, where = stages.of("dark"), ours(made)
        url = f"{where.replace('http', 'ws')}/viser/ws/"
        options: dict[str, Any] = {"origin": where, "subprotocols": [PROTOCOL], "max_size": None}
        stalled = connect_now(url + "s" * 22, sock=line, max_queue=1, close_timeout=0, **options)
        with stalled, connect_now(url + "l" * 22, **options) as live:
            for browser in (stalled, live):
                browser.send(camera())
            until(lambda: len(stage.server.get_clients()) == 2)
            noise = np.random.default_rng(7)
            for number in range(30):
                stage.server.scene.add_point_cloud(
                    f"/noise{number}", noise.random((90_000, 3)), (0, 0, 0), precision="float32"
                )
                while len(live.recv(timeout=PATIENCE_S)) < 1_000_000:
                    pass
            assert len(stage.server.get_clients()) == 2


def narrow_line(made: Dashboard) -> socket.socket:
    line = socket.socket()
    line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 65536)
    line.connect(("127.0.0.1", made._port))
    return line
