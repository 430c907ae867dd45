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
from typing import Any

import pytest

from tests.fake_snapshots import fake_snapshot
from tests.patience import PATIENCE_S, until
from tests.unit.web.doubles import StubEngine, StubViewers
from web.http.server import Dashboard, listening_socket
from web.latest import Latest


def dashboard(port: int = 0, **options) -> Dashboard:
    latest = Latest()
    latest.put(fake_snapshot(3))
    return Dashboard(latest, StubEngine().submit, StubViewers(), port=port, **options)


def test_a_taken_port_is_a_sentence_and_code_2(capsys):
    with listening_socket("localhost", 0) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(SystemExit) as ended:
            dashboard(port).run()
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert f"Port {port}" in said
    assert "--port" in said


def test_an_ipv6_address_is_written_in_brackets():
    assert Dashboard(Latest(), StubEngine().submit, StubViewers(), host="::1", port=8000).url == "http://[::1]:8000/"


@pytest.fixture(scope="module")
def running():
    ready = threading.Event()
    made = dashboard(on_ready=lambda _url: ready.set())
    thread = threading.Thread(target=made.run)
    thread.start()
    assert ready.wait(PATIENCE_S)
    yield made
    made.stop()
    thread.join(PATIENCE_S)
    assert not thread.is_alive()
    assert made._viewers.calls == ["start", "stop"]


@pytest.fixture
def complaints():
    """What uvicorn logs meanwhile."""
    heard: list[str] = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: heard.append(record.getMessage())  # type: ignore[method-assign]
    logger = logging.getLogger("uvicorn.error")
    logger.addHandler(handler)
    yield heard
    logger.removeHandler(handler)


def say(server: Dashboard, raw: bytes) -> bytes:
    """The answer to these bytes."""
    with socket.create_connection(("127.0.0.1", server._port), timeout=PATIENCE_S) as connection:
        connection.sendall(raw)
        parts = []
        with contextlib.suppress(ConnectionResetError):
            while part := connection.recv(65536):
                parts.append(part)
        return b"".join(parts)


UPGRADE = b"Upgrade: websocket\r\nConnection: Upgrade\r\n"
UPGRADE += b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"


@pytest.mark.parametrize(
    "lines",
    [
        b"GET /healthz HTTP/1.0\r\n",
        b"GET /healthz HTTP/1.1\r\nHost: \xff\xfe\r\nConnection: close\r\n",
        b"GET /healthz HTTP/1.1\r\nHost: evil.example\r\nHost: {host}\r\nConnection: close\r\n",
        b"GET /healthz HTTP/1.1\r\nHost: {host}\r\nOrigin: \xff\r\nConnection: close\r\n",
        b"GET /../../../etc/passwd HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n",
        b"GET /viser/..%2f..%2f..%2fetc/passwd HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n",
        b"GET /static/%2e%2e/%2e%2e/pyproject.toml HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n",
        b"GET /static/..\\..\\pyproject.toml HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n",
        b"GET /static//etc/passwd HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n",
        b"GET /\x00 HTTP/1.1\r\nHost: {host}\r\n",
        b"GET / HTTP/1.1\r\nHost: {host}\r\n: nothing\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n",
        b"GET /api/stream HTTP/1.1\r\nHost: {host}\r\nOrigin: http://evil.example\r\n" + UPGRADE,
        b"GET /api/stream HTTP/1.1\r\nHost: {host}\r\nOrigin: null\r\n" + UPGRADE,
        b"GET /api/stream HTTP/1.1\r\nHost: {host}\r\n" + UPGRADE,
        b"GET /viser/ws/pppppppppppppppppppppp HTTP/1.1\r\nHost: {host}\r\nOrigin: http://evil.example\r\n" + UPGRADE,
        b"GET /viser/ws/pppppppppppppppppppppp HTTP/1.1\r\nHost: evil.example\r\nOrigin: http://evil.example\r\n"
        + UPGRADE,
        b"GET /nothing HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n" + UPGRADE,
    ],
)
def test_malformed_and_foreign_requests_get_4xx_and_the_server_lives(running, lines):
    host = f"127.0.0.1:{running._port}".encode()
    answer = say(running, lines.replace(b"{host}", host) + b"\r\n")
    assert answer.startswith(b"HTTP/1.1 4"), answer[:300]
    assert b"root:" not in answer
    alive = b"GET /healthz HTTP/1.1\r\nHost: " + host + b"\r\nConnection: close\r\n\r\n"
    assert say(running, alive).startswith(b"HTTP/1.1 200")


def test_endless_headers_are_cut_off(running):
    host = f"127.0.0.1:{running._port}".encode()
    answer = say(running, b"GET / HTTP/1.1\r\nHost: " + host + b"\r\nA: " + b"a" * 200_000 + b"\r\n\r\n")
    assert not answer or answer.startswith(b"HTTP/1.1 4")
    assert running._server is not None
    assert running._server.started


OURS = b"Host: {host}\r\nOrigin: http://{host}\r\n" + UPGRADE


@pytest.mark.parametrize(
    ("status", "reason", "lines"),
    [
        (403, b"answers to", b"GET /api/stream HTTP/1.1\r\nHost: " + b"h" * 9_000 + b"\r\n" + UPGRADE),
        (
            403,
            b"another origin",
            b"GET /api/stream HTTP/1.1\r\nOrigin: " + b"h" * 9_000 + b"\r\nHost: {host}\r\n" + UPGRADE,
        ),
        (404, b"no websocket", b"GET /" + b"p" * 9_000 + b" HTTP/1.1\r\n" + OURS),
        (431, b"128 headers", b"GET /api/stream HTTP/1.1\r\n" + OURS + b"A: b\r\n" * 200),
        (400, b"GET and without", b"POST /api/stream HTTP/1.1\r\nContent-Length: 2\r\n" + OURS),
        (400, b"GET and without", b"GET /api/stream HTTP/1.1\r\nContent-Length: 2\r\n" + OURS),
        (400, b"GET and without", b"GET /api/stream HTTP/1.1\r\nTransfer-Encoding: chunked\r\n" + OURS),
    ],
    ids=["host", "origin", "path", "number", "post", "body", "chunks"],
)
def test_a_websocket_request_that_is_too_much_is_answered(running, status, reason, lines):
    host = f"127.0.0.1:{running._port}".encode()
    answer = say(running, lines.replace(b"{host}", host) + b"\r\n")
    assert answer.startswith(b"HTTP/1.1 %d" % status), answer[:300]
    assert reason in answer
    alive = b"GET /healthz HTTP/1.1\r\nHost: " + host + b"\r\nConnection: close\r\n\r\n"
    assert say(running, alive).startswith(b"HTTP/1.1 200")


@pytest.mark.parametrize(
    ("path", "status"),
    [("/nothing", 404), ("/static/main.js", 404), ("/viser/ws/short", 404), ("/viser/ws/" + "p" * 22, 400)],
)
def test_a_websocket_that_is_refused_is_no_error(running, complaints, path, status):
    answer = say(running, f"GET {path} HTTP/1.1\r\n".encode() + own(running))
    assert answer.startswith(b"HTTP/1.1 %d" % status), answer[:300]
    assert b'"reason":' in answer
    assert not complaints


def own(running) -> bytes:
    """The rest of the request of a websocket that is allowed in."""
    return OURS.replace(b"{host}", b"127.0.0.1:%d" % running._port) + b"\r\n"


def test_cookies_of_the_machine_s_other_servers_keep_nobody_out(running):
    from websockets.sync.client import connect

    host = f"127.0.0.1:{running._port}"
    cookies = "; ".join(f"name{number}={'c' * 4_000}" for number in range(12))
    crumbs = b"GET /healthz HTTP/1.1\r\nHost: %b\r\nCookie: %b\r\nConnection: close\r\n\r\n" % (
        host.encode(),
        cookies.encode(),
    )
    assert say(running, crumbs).startswith(b"HTTP/1.1 200")
    with connect(f"ws://{host}/api/stream", origin=f"http://{host}", additional_headers={"Cookie": cookies}) as talk:  # type: ignore[arg-type]
        assert "hello" in str(talk.recv(timeout=PATIENCE_S))


def test_a_frame_over_64_kib_closes_the_socket(running):
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    url = f"ws://127.0.0.1:{running._port}/api/stream"
    with connect(url, origin=f"http://127.0.0.1:{running._port}", max_size=None) as talk:  # type: ignore[arg-type]
        talk.send("x" * 70_000)
        with pytest.raises(ConnectionClosed) as closed:
            drain(talk)
        told = closed.value.rcvd  # None: the connection was gone before its last frame was read
        assert told is None or told.code == 1009


def drain(talk):
    while True:
        talk.recv(timeout=PATIENCE_S)


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


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
@pytest.mark.slow
def test_a_signal_stops_the_robot_closes_the_sockets_and_ends_with_code_0(name):
    """With a page that drives, a viewer that is watched, one that is not, and a browser that reads nothing."""
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert program.stdout is not None
    try:
        host = program.stdout.readline().strip().removeprefix("http://").removesuffix("/")
        ours: dict[str, Any] = {"origin": f"http://{host}", "max_size": None}
        looks = connect(f"ws://{host}/viser/ws/{'p' * 22}", subprotocols=["viser-v1.1.1"], **ours)
        stalled = connect(
            f"ws://{host}/viser/ws/{'q' * 22}", subprotocols=["viser-v1.1.1"], max_queue=1, close_timeout=0.1, **ours
        )
        with connect(f"ws://{host}/api/stream", **ours) as talk, looks, stalled:
            looks.recv(timeout=PATIENCE_S)
            talk.send('{"type": "drive", "speed": 0.4, "yaw_rate": 0, "id": 1}')
            while '"answer"' not in str(talk.recv(timeout=PATIENCE_S)):
                pass
            program.send_signal(getattr(signal, name))
            for socket in (talk, looks):
                with pytest.raises(ConnectionClosed) as closed:
                    drain(socket)
                assert closed.value.rcvd is not None  # the connection was closed, not cut
            out, err = program.communicate(timeout=PATIENCE_S)
        assert (program.returncode, out, err) == (0, "drive 0.4, drive 0.0, ended\n", "")
    finally:
        program.kill()
        program.communicate()


def test_in_the_main_thread_a_signal_ends_run_and_the_old_handler_is_back():
    before = signal.getsignal(signal.SIGTERM)
    made = dashboard()
    made.stop()  # nothing runs yet: nothing happens
    made.bind()
    made.on_ready = lambda _url: os.kill(os.getpid(), signal.SIGTERM)
    made.run()
    assert signal.getsignal(signal.SIGTERM) is before


def test_without_anybody_to_tell_it_just_runs():
    made = dashboard()
    thread = threading.Thread(target=made.run)
    thread.start()
    until(lambda: made._server is not None and made._server.started)
    made.stop()
    thread.join(PATIENCE_S)
    assert not thread.is_alive()
