"""Browsers that come and go leave nothing behind; one that reads nothing, or a crowd that says nothing, keeps nobody waiting."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import gc
import logging
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from itertools import product
from typing import Any
from unittest.mock import Mock

import numpy as np
import psutil
import pytest
import uvicorn
from uvicorn.server import ServerState
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect as connect_now

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S, until
from tests.unit.web.doubles import StubEngine, StubViewer, StubViewers, viser_double
from tests.unit.web.test_viser_server import PROTOCOL, camera
from web.http import connections, proxy, server
from web.http.connections import WebSocketProtocol
from web.http.proxy import ViewersLike
from web.http.server import Dashboard, ForClass
from web.latest import Latest
from web.viewer import Viewers

pytestmark = pytest.mark.slow

ROUNDS, AT_ONCE = 10, 10


@contextlib.contextmanager
def served(stages: ViewersLike) -> Iterator[Dashboard]:
    latest, ready = Latest(), threading.Event()
    latest.put(fake_snapshot(3))
    room = ForClass("127.0.0.1", 0)
    made = Dashboard(latest, StubEngine().submit, stages, port=0, on_ready=lambda _url: ready.set(), for_class=room)
    thread = threading.Thread(target=made.run)
    thread.start()
    try:
        assert ready.wait(PATIENCE_S)
        yield made
    finally:
        made.stop()
        thread.join()


def ours(made: Dashboard) -> tuple[str, str]:
    """The page's address as an Origin, and as that of websockets."""
    origin = made.url.removesuffix("/")
    return origin, origin.replace("http", "ws")


def doors(made: Dashboard) -> tuple[int, int]:
    """The ports of the main door and of that of the class."""
    assert made.classroom is not None
    return int(ours(made)[0].rpartition(":")[2]), made.classroom.port


# ---------------------------------------------------------------- those that come and go


def left_behind() -> dict[str, int]:
    """What the process holds for connections: threads except asyncio's own pool, tasks, open files."""
    process = psutil.Process()
    return {
        "threads": sum(not thread.name.startswith("asyncio_") for thread in threading.enumerate()),
        "tasks": sum(isinstance(one, asyncio.Task) and not one.done() for one in gc.get_objects()),
        "files": process.num_fds() if hasattr(process, "num_fds") else process.num_handles(),
    }


def settled() -> dict[str, int]:
    """What is held once start-up work is over, such as the tasks of a server that has just begun."""
    seen: list[dict[str, int]] = []
    until(lambda: seen.append(left_behind()) or (len(seen) > 10 and all(one == seen[-1] for one in seen[-10:])))
    return seen[-1]


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
    (origin, where), page = ours(made), f"page-{number:020d}"
    stream = await enter(f"{where}/api/stream?page={page}", origin)
    await stream.send('{"type": "theme", "name": "light"}')
    await stream.send('{"type": "view", "name": "map"}')
    await stream.recv()
    stage = await enter(f"{where}/viser/ws/{page}", origin, subprotocols=[PROTOCOL])
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


@pytest.mark.long
def test_hundreds_of_connections_leave_no_thread_task_or_file_behind() -> None:
    stage = StubViewer()
    with viser_double(stage), served(StubViewers(stage)) as made:  # type: ignore[arg-type]
        before = settled()
        asyncio.run(visits(made, 1))  # the first ones make what is made once
        asyncio.run(visits(made, ROUNDS))
        until(lambda: all(now <= before[name] for name, now in left_behind().items()), (before, left_behind()))


def test_the_end_of_the_program_takes_a_farewell_that_was_there_first() -> None:
    async def accepting(_scope: Any, receive: Any, send: Any) -> None:
        await receive()
        await send({"type": "websocket.accept"})
        while (await receive())["type"] != "websocket.disconnect":
            pass

    async def ended_while_the_browser_says_farewell() -> None:
        config, state = uvicorn.Config(accepting, log_config=None), ServerState()
        config.load()
        protocol = WebSocketProtocol(config, state, {})
        protocol.connection_made(line)
        protocol.data_received(
            b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        )
        while not protocol.handshake_complete:
            await asyncio.sleep(0)
        going_away = (1001).to_bytes(2, "big")
        protocol.data_received(bytes([0x88, 0x82]) + bytes(4) + going_away)  # masked with nothing
        protocol.shutdown()
        await asyncio.gather(*state.tasks)

    line = Mock(asyncio.Transport, **{"is_closing.side_effect": lambda: line.close.called})  # it sends nothing yet
    line.get_extra_info.side_effect = lambda _name, default=None: default
    asyncio.run(ended_while_the_browser_says_farewell())
    assert line.write.call_args_list[0].args[0].startswith(b"HTTP/1.1 101")
    assert line.close.called


# ---------------------------------------------------------------- those that read nothing


def test_a_browser_that_takes_nothing_of_the_stage_keeps_nobody_waiting(monkeypatch) -> None:
    """Far more is drawn than fits into the buffers between the viewer and the browser that stalls."""
    monkeypatch.setattr(proxy, "SEND_TIMEOUT_S", 1e6)  # so that it is never disconnected
    stages = Viewers(Latest(), StubEngine().submit)
    with served(stages) as made, socket.socket() as line:
        line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 65536)
        line.connect(("127.0.0.1", doors(made)[0]))
        stage, (origin, where) = stages.of("dark"), ours(made)
        options: dict[str, Any] = {"origin": origin, "subprotocols": [PROTOCOL], "max_size": None}
        stalled = connect_now(f"{where}/viser/ws/{'s' * 22}", sock=line, max_queue=1, close_timeout=0, **options)
        with stalled, connect_now(f"{where}/viser/ws/{'l' * 22}", **options) as live:
            for browser in (stalled, live):
                browser.send(camera())
            until(lambda: len(stage.server.get_clients()) == 2)
            noise = np.random.default_rng(7).random((90_000, 3))
            for number in range(30):
                stage.server.scene.add_point_cloud(f"/noise{number}", noise, (0, 0, 0), precision="float32")
                while len(live.recv(timeout=PATIENCE_S)) < 1_000_000:
                    pass
            assert len(stage.server.get_clients()) == 2


# ---------------------------------------------------------------- those that say nothing, or not enough

GET = "GET / HTTP/1.1\r\nHost: 127.0.0.1:{0}\r\n"
POST = GET.replace("GET /", "POST /api/{1}") + "Content-Type: application/json\r\nContent-Length: 99\r\n"
DOORS = """
import resource, threading
resource.setrlimit(resource.RLIMIT_NOFILE, (160, 160))
from tests.unit.web.test_connections import doors, served
from tests.unit.web.doubles import StubViewers
with served(StubViewers()) as made:
    print(*doors(made), flush=True)
    input()
    open("/dev/null")  # there is still a descriptor for whoever needs one
"""


def open_to(port: int, origin: str = "127.0.0.1", said: str = "") -> socket.socket:
    line = socket.create_connection(("127.0.0.1", port), PATIENCE_S, (origin, 0))
    with contextlib.suppress(OSError):  # it had to go already
        line.sendall(said.format(port, "commands").encode())
    return line


def asked(port: int, origin: str = "127.0.0.1") -> bytes:
    """The first line of the answer to a request that is sent at once."""
    with open_to(port, origin, f"{GET}\r\n") as line:
        return line.recv(12)


def ended(line: socket.socket) -> bool:
    """Whether the server has closed it, which is waited for."""
    try:
        while line.recv(65536):
            pass
    except ConnectionResetError:
        return True
    except TimeoutError:
        return False
    return True


def test_more_connections_than_there_are_descriptors_hold_up_neither_door() -> None:
    """The door of the class, and the main one; with nothing, a part of the headers, and a part of a body."""
    vote = f"{POST}Origin: http://127.0.0.1:{{0}}\r\n\r\n{{{{".replace("{1}", "vote")
    program = subprocess.Popen(
        [sys.executable, "-c", DOORS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert program.stdout is not None
        main, room = map(int, program.stdout.readline().split())
        for port, part in product((room, main), ("", f"{GET}X: ", vote)):
            with contextlib.ExitStack() as held:
                for _ in range(200):
                    held.enter_context(open_to(port, said=part))
                assert asked(main) == asked(room) == b"HTTP/1.1 200", (port, part)
        _, said = program.communicate("\n", timeout=PATIENCE_S)
        assert (program.returncode, said) == (0, "")
    finally:
        program.kill()
        program.communicate()


def test_who_has_many_connections_takes_no_place_from_another_address(monkeypatch) -> None:
    monkeypatch.setattr(server, "CLASS_SHARE", 16 / 1024)
    with served(StubViewers()) as made, contextlib.ExitStack() as held:
        _, port = doors(made)
        other = held.enter_context(open_to(port, "127.0.0.2"))
        crowd = [held.enter_context(open_to(port)) for _ in range(100)]
        assert asked(port) == b"HTTP/1.1 200"  # when the crowd is in
        assert all(ended(line) for line in crowd[:-8])  # those of its own half, who came first
        other.settimeout(0.1)
        assert not ended(other)
        assert asked(port, "127.0.0.2") == b"HTTP/1.1 200"


def test_headers_bodies_and_goodbyes_have_a_time_limit_and_a_page_that_is_open_has_none(monkeypatch) -> None:
    monkeypatch.setattr(connections, "HEADERS_S", 0.5)
    monkeypatch.setattr(connections, "STALLED_S", 0.5)
    monkeypatch.setattr(server, "LOOK_EVERY", 1)
    with served(StubViewers()) as made, contextlib.ExitStack() as held:
        (origin, where), (port, _) = ours(made), doors(made)
        page = held.enter_context(connect_now(f"{where}/api/stream?page={'p' * 22}", origin=origin))  # type: ignore[arg-type]
        silent, slow, stalled, again = (
            held.enter_context(open_to(port, said=said))
            for said in ("", "GET / HTTP/1.1\r\nX: ", f"{POST}\r\n{{{{", f"{GET}\r\nGET")
        )

        def drip() -> None:
            with contextlib.suppress(OSError):
                while not over.wait(0.05):
                    slow.sendall(b"x")

        over = threading.Event()
        dripping = threading.Thread(target=drip)
        dripping.start()
        try:
            assert [ended(line) for line in (silent, slow, stalled, again)] == [True] * 4
        finally:
            over.set()
            dripping.join()
        page.send('{"type": "tabs", "names": [], "id": 5}')
        while '"id":5' not in str(page.recv(timeout=PATIENCE_S)):
            pass


def test_a_connection_that_cannot_be_accepted_is_told_of_once_and_tried_again(monkeypatch, caplog) -> None:
    monkeypatch.setattr(connections, "BACK_OFF_S", 0.0)

    async def full() -> bytes:
        loop, tries = asyncio.get_running_loop(), iter(range(50))
        accept = loop.sock_accept

        async def refused(listener: socket.socket) -> Any:
            if next(tries, None) is not None:
                raise OSError(errno.EMFILE, "Too many open files")
            return await accept(listener)

        monkeypatch.setattr(loop, "sock_accept", refused)
        listener, made = server.listening_socket("127.0.0.1", 0), asyncio.Protocol
        door = connections.Door(listener, connections.Places(9, 9), made, set())  # type: ignore[arg-type]
        reader, writer = await asyncio.open_connection(*listener.getsockname())
        writer.close()
        left = await reader.read()
        await door.close()
        return left

    with caplog.at_level(logging.WARNING):
        assert asyncio.run(full()) == b""
    (said,) = caplog.messages
    assert "Too many open files" in said
