"""The port: who may have it, what it says when it is taken, raw sockets against it, and a clean end."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.doubles import StubEngine, StubStage
from web.latest import Latest
from web.server import CannotListen, Dashboard, listening_socket


@pytest.mark.parametrize(
    "host", ["0.0.0.0", "::", "", "0", "*", "192.168.1.1", "example.org", "127.0.0.2", "::ffff:0.0.0.0"]
)
def test_only_loopback(host):
    with pytest.raises(CannotListen, match="localhost or ::1 only"):
        listening_socket(host, 0)


@pytest.mark.parametrize("port", [-1, 65536, 10**9])
def test_a_port_must_exist(port):
    with pytest.raises(CannotListen, match="does not exist"):
        listening_socket("127.0.0.1", port)


def dashboard(port: int = 0, **options) -> Dashboard:
    latest = Latest()
    latest.put(fake_snapshot(3))
    return Dashboard(latest, StubEngine().submit, StubStage(), port=port, **options)


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
    assert Dashboard(Latest(), StubEngine().submit, StubStage(), host="::1", port=8000).url == "http://[::1]:8000/"


@pytest.fixture(scope="module")
def running():
    ready = threading.Event()
    made = dashboard(on_ready=lambda _url: ready.set())
    thread = threading.Thread(target=made.run)
    thread.start()
    assert ready.wait(10)
    yield made
    made.stop()
    thread.join(5)
    assert not thread.is_alive()
    assert made._stage.calls == [("start",), ("stop",)]


def say(server: Dashboard, raw: bytes) -> bytes:
    """What comes back to these bytes."""
    with socket.create_connection(("127.0.0.1", server._port), timeout=5) as connection:
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


def test_a_frame_over_64_kib_closes_the_socket(running):
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    url = f"ws://127.0.0.1:{running._port}/api/stream"
    with connect(url, origin=f"http://127.0.0.1:{running._port}", max_size=None) as talk:  # type: ignore[arg-type]
        talk.send("x" * 70_000)
        with pytest.raises(ConnectionClosed) as closed:
            drain(talk)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1009


def drain(talk):
    while True:
        talk.recv(timeout=5)


PROGRAM = """
import sys
from tests.unit.web.test_server import dashboard
dashboard(on_ready=lambda url: print(url, flush=True)).run()
print("ended", flush=True)
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_signal_ends_it_within_3_s_with_code_0(name):
    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert program.stdout is not None
    try:
        url = program.stdout.readline().strip()
        host = url.removeprefix("http://").removesuffix("/")
        from websockets.sync.client import connect

        with connect(f"ws://{host}/api/stream", origin=f"http://{host}") as talk:  # type: ignore[arg-type]
            talk.recv(timeout=5)
            began = time.monotonic()
            program.send_signal(getattr(signal, name))
            out, err = program.communicate(timeout=5)
        assert time.monotonic() - began < 3
        assert (program.returncode, out, err) == (0, "ended\n", "")
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
    while made._server is None or not made._server.started:
        time.sleep(0.01)
    made.stop()
    thread.join(5)
    assert not thread.is_alive()
