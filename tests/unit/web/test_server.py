"""The port: who may use it, what is said when it is taken, raw requests to it, and a clean end."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S
from tests.unit.web.doubles import StubEngine, StubViewers
from web.http.server import Dashboard, listening_socket
from web.latest import Latest

UPGRADE = b"Upgrade: websocket\r\nConnection: Upgrade\r\n"
UPGRADE += b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
OURS = b"Host: {host}\r\nOrigin: http://{host}\r\n" + UPGRADE
CLOSE = b"Connection: close\r\n"


def dashboard(port: int = 0, viewers: StubViewers | None = None, **options: Any) -> Dashboard:
    latest = Latest()
    latest.put(fake_snapshot(3))
    return Dashboard(latest, StubEngine().submit, viewers or StubViewers(), port=port, **options)


def host_of(server: Dashboard) -> str:
    return server.url.removeprefix("http://").removesuffix("/")


@pytest.fixture(scope="module")
def running() -> Iterator[Dashboard]:
    ready, viewers = threading.Event(), StubViewers()
    made = dashboard(viewers=viewers, on_ready=lambda _url: ready.set())
    thread = threading.Thread(target=made.run)
    thread.start()
    assert ready.wait(PATIENCE_S)
    yield made
    made.stop()
    thread.join(PATIENCE_S)
    assert (thread.is_alive(), viewers.calls) == (False, ["start", "stop"])


@pytest.fixture
def complaints() -> Iterator[list[str]]:
    """What uvicorn logs meanwhile."""
    heard: list[str] = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: heard.append(record.getMessage())  # type: ignore[method-assign]
    logger = logging.getLogger("uvicorn.error")
    logger.addHandler(handler)
    yield heard
    logger.removeHandler(handler)


def say(server: Dashboard, lines: bytes) -> bytes:
    """The answer to a request of these lines."""
    host = host_of(server)
    with socket.create_connection(("127.0.0.1", int(host.partition(":")[2])), timeout=PATIENCE_S) as connection:
        connection.sendall(lines.replace(b"{host}", host.encode()) + b"\r\n")
        parts: list[bytes] = []
        with contextlib.suppress(ConnectionResetError):
            while part := connection.recv(65536):
                parts.append(part)
        return b"".join(parts)


def is_alive(server: Dashboard) -> bool:
    return say(server, b"GET /healthz HTTP/1.1\r\nHost: {host}\r\n" + CLOSE).startswith(b"HTTP/1.1 200")


def drain(talk: ClientConnection) -> None:
    while True:
        talk.recv(timeout=PATIENCE_S)


def test_a_taken_port_is_a_sentence_and_code_2(capsys: pytest.CaptureFixture[str]) -> None:
    with listening_socket("localhost", 0) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(SystemExit) as ended:
            dashboard(port).run()
    said = capsys.readouterr().err
    assert ended.value.code == 2
    assert f"Port {port}" in said
    assert "--port" in said


def test_an_ipv6_address_is_written_in_brackets() -> None:
    assert dashboard(8000, host="::1").url == "http://[::1]:8000/"


MALFORMED_OR_FOREIGN = [
    b"GET /healthz HTTP/1.0\r\n",
    b"GET /healthz HTTP/1.1\r\nHost: \xff\xfe\r\n" + CLOSE,
    b"GET /healthz HTTP/1.1\r\nHost: evil.example\r\nHost: {host}\r\n" + CLOSE,
    b"GET /healthz HTTP/1.1\r\nHost: {host}\r\nOrigin: \xff\r\n" + CLOSE,
    *(b"GET " + path + b" HTTP/1.1\r\nHost: {host}\r\n" + CLOSE
      for path in (b"/../../../etc/passwd", b"/viser/..%2f..%2f..%2fetc/passwd", b"/static/%2e%2e/%2e%2e/pyproject.toml",
                   b"/static/..\\..\\pyproject.toml", b"/static//etc/passwd")),
    b"GET /\x00 HTTP/1.1\r\nHost: {host}\r\n",
    b"GET / HTTP/1.1\r\nHost: {host}\r\n: nothing\r\n",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n",
    *(b"GET /api/stream HTTP/1.1\r\nHost: {host}\r\n" + origin + UPGRADE
      for origin in (b"Origin: http://evil.example\r\n", b"Origin: null\r\n", b"")),
    *(b"GET /viser/ws/pppppppppppppppppppppp HTTP/1.1\r\nHost: " + host + b"\r\nOrigin: http://evil.example\r\n" + UPGRADE
      for host in (b"{host}", b"evil.example")),
    b"GET /nothing HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n" + UPGRADE,
]  # fmt: skip


def test_malformed_and_foreign_requests_get_4xx_and_the_server_lives(
    running: Dashboard, subtests: pytest.Subtests
) -> None:
    for lines in MALFORMED_OR_FOREIGN:
        with subtests.test(msg=repr(lines)):
            answer = say(running, lines)
            assert answer.startswith(b"HTTP/1.1 4"), answer[:300]
            assert b"root:" not in answer
            assert is_alive(running)


@pytest.mark.parametrize(
    ("status", "reason", "lines"),
    [
        (403, b"answers to", b"GET /api/stream HTTP/1.1\r\nHost: " + b"h" * 9_000 + b"\r\n" + UPGRADE),
        (403, b"another origin",
         b"GET /api/stream HTTP/1.1\r\nOrigin: " + b"h" * 9_000 + b"\r\nHost: {host}\r\n" + UPGRADE),
        (404, b"no websocket", b"GET /" + b"p" * 9_000 + b" HTTP/1.1\r\n" + OURS),
        (431, b"128 headers", b"GET /api/stream HTTP/1.1\r\n" + OURS + b"A: b\r\n" * 200),
        (400, b"GET and without", b"POST /api/stream HTTP/1.1\r\nContent-Length: 2\r\n" + OURS),
        (400, b"GET and without", b"GET /api/stream HTTP/1.1\r\nContent-Length: 2\r\n" + OURS),
        (400, b"GET and without", b"GET /api/stream HTTP/1.1\r\nTransfer-Encoding: chunked\r\n" + OURS),
        *((status, b'"reason":', b"GET " + path + b" HTTP/1.1\r\n" + OURS)
          for path, status in ((b"/nothing", 404), (b"/static/main.js", 404), (b"/viser/ws/short", 404),
                               (b"/viser/ws/" + b"p" * 22, 400))),
    ],
    ids=["host", "origin", "path", "number", "post", "body", "chunks", "nothing", "file", "short", "protocol"],
)  # fmt: skip
def test_a_websocket_request_that_is_too_much_or_refused_is_answered_and_no_error(
    running: Dashboard, complaints: list[str], status: int, reason: bytes, lines: bytes
) -> None:
    answer = say(running, lines)
    assert answer.startswith(b"HTTP/1.1 %d" % status), answer[:300]
    assert reason in answer
    assert is_alive(running)
    assert not complaints


def test_endless_headers_are_cut_off(running: Dashboard) -> None:
    answer = say(running, b"GET / HTTP/1.1\r\nHost: {host}\r\nA: " + b"a" * 200_000 + b"\r\n")
    assert not answer or answer.startswith(b"HTTP/1.1 4")
    assert is_alive(running)


def test_cookies_of_the_machine_s_other_servers_keep_nobody_out(running: Dashboard) -> None:
    cookies, host = "; ".join(f"name{number}={'c' * 4_000}" for number in range(12)), host_of(running)
    crumbs = b"GET /healthz HTTP/1.1\r\nHost: {host}\r\nCookie: " + cookies.encode() + b"\r\n" + CLOSE
    assert say(running, crumbs).startswith(b"HTTP/1.1 200")
    ours: dict[str, Any] = {"origin": f"http://{host}", "additional_headers": {"Cookie": cookies}}
    with connect(f"ws://{host}/api/stream", **ours) as talk:
        assert "hello" in str(talk.recv(timeout=PATIENCE_S))


def test_a_frame_over_64_kib_closes_the_socket(running: Dashboard) -> None:
    ours: dict[str, Any] = {"origin": running.url.removesuffix("/"), "max_size": None}
    with connect(f"ws://{host_of(running)}/api/stream", **ours) as talk:
        talk.send("x" * 70_000)
        with pytest.raises(ConnectionClosed) as closed:
            drain(talk)
        told = closed.value.rcvd  # None: the connection was gone before its last frame was read
        assert told is None or told.code == 1009


# ---------------------------------------------------------------- the end

PROGRAM = """
from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S
from tests.unit.web.doubles import StubEngine
from web.latest import Latest
from web.http.server import Dashboard
from web.viewer import Viewers

latest, engine = Latest(), StubEngine()
latest.put(fake_snapshot(3))
stages = Viewers(latest, engine.submit)
stages.of("light")
Dashboard(latest, engine.submit, stages, port=0, on_ready=lambda url: print(url, flush=True)).run()
print(*(f"{command.type} {command.speed}" for command in engine.commands), "ended", sep=", ", flush=True)
"""


@pytest.mark.slow
def test_a_signal_stops_the_robot_closes_the_sockets_and_ends_with_code_0() -> None:
    """With a page that drives, a viewer that is watched, one that is not, and a browser that reads nothing."""
    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert program.stdout is not None
    try:
        host = program.stdout.readline().strip().removeprefix("http://").removesuffix("/")
        ours: dict[str, Any] = {"origin": f"http://{host}", "max_size": None}
        viser: dict[str, Any] = ours | {"subprotocols": ["viser-v1.1.1"]}
        looks = connect(f"ws://{host}/viser/ws/{'p' * 22}", **viser)
        stalled = connect(f"ws://{host}/viser/ws/{'q' * 22}", max_queue=1, close_timeout=0.1, **viser)
        with connect(f"ws://{host}/api/stream", **ours) as talk, looks, stalled:
            looks.recv(timeout=PATIENCE_S)
            talk.send('{"type": "drive", "speed": 0.4, "yaw_rate": 0, "id": 1}')
            while '"answer"' not in str(talk.recv(timeout=PATIENCE_S)):
                pass
            program.send_signal(signal.SIGTERM)
            for socket in (talk, looks):
                with pytest.raises(ConnectionClosed) as closed:
                    drain(socket)
                assert closed.value.rcvd is not None  # the connection was closed, not cut
            out, err = program.communicate(timeout=PATIENCE_S)
        assert (program.returncode, out, err) == (0, "drive 0.4, drive 0.0, ended\n", "")
    finally:
        program.kill()
        program.communicate()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_in_the_main_thread_a_signal_ends_run_and_the_old_handler_is_back(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    made = dashboard()
    made.bind()
    made.on_ready = lambda _url: os.kill(os.getpid(), number)
    made.run()
    assert signal.getsignal(number) is before


def test_who_is_told_to_stop_before_it_runs_ends_at_once_and_needs_nobody_to_tell() -> None:
    made = dashboard()
    made.stop()
    made.run()
