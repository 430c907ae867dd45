"""viser's port: closed to all but the proxy, and nothing that a browser sends is kept."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator
from itertools import product
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
import websockets.asyncio.server
from viser import ViserServer
from viser.infra import _infra
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from tests.patience import until
from tests.unit.web.doubles import OURS, PAGE, StubEngine, house
from web.latest import Latest
from web.switches import Switches
from web.viewer import Viewer
from web.viewer.viser_server import MOST_SILENT, SECRET_HEADER, guarded_server

pytestmark = pytest.mark.slow

PROTOCOL: Any = "viser-v1.1.1"


@pytest.fixture(scope="module")
def stage() -> Iterator[Viewer]:
    made = Viewer(Latest(), StubEngine().submit, Switches())
    made.start()
    yield made
    made.stop()


def say(port: int, *lines: str) -> bytes:
    """The answer to a request of these lines."""
    with socket.create_connection(("127.0.0.1", port), timeout=30) as connection:
        connection.sendall("\r\n".join((*lines, "", "")).encode("latin-1"))
        parts = []
        with contextlib.suppress(ConnectionResetError):
            while part := connection.recv(65536):
                parts.append(part)
        return b"".join(parts)


UPGRADE = (
    "Upgrade: websocket",
    "Connection: Upgrade",
    "Sec-WebSocket-Version: 13",
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
    f"Sec-WebSocket-Protocol: {PROTOCOL}",
)


def test_a_raw_socket_gets_neither_page_nor_websocket(subtests: pytest.Subtests, stage: Viewer) -> None:
    ours = "http://127.0.0.1:{port}", "http://127.0.0.1:8000", "http://localhost:{port}"
    hosts, upgrades = ("127.0.0.1:{port}", "evil.example"), ((), UPGRADE, tuple(map(str.lower, UPGRADE)))
    for origin, host, upgrade in product(("", "null", "http://evil.example", *ours), hosts, upgrades):
        with subtests.test(origin=origin, host=host, upgrade=upgrade):
            lines = ["GET / HTTP/1.1", f"Host: {host}", *([f"Origin: {origin}"] if origin else []), *upgrade]
            answer = say(stage.port, *(line.replace("{port}", str(stage.port)) for line in lines))
            assert answer.startswith(b"HTTP/1.1 403 "), answer[:200]
            assert len(answer) < 500


def test_no_path_leads_past_the_secret_and_none_to_a_file(stage: Viewer) -> None:
    for path in ("/index.html", "/../../pyproject.toml", "/%2e%2e/%2e%2e/etc/passwd", "/..\\..\\x", "//etc/passwd"):
        asked = f"GET {path} HTTP/1.1", "Host: x"
        assert say(stage.port, *asked).startswith(b"HTTP/1.1 403 ")
        knowing = say(stage.port, *asked, f"{SECRET_HEADER}: {stage.secret}")
        assert knowing.startswith(b"HTTP/1.1 426 "), knowing[:200]


def test_a_near_miss_of_the_secret_is_refused(stage: Viewer) -> None:
    secret, other = stage.secret, "A" if stage.secret[0] != "A" else "B"
    wrong = ["", "x", secret[:-1], secret + "A", other + secret[1:], secret.swapcase(), "\xff" + secret, f'"{secret}"']
    for given in [*([text] for text in wrong), [secret, secret], [secret, "x"], ["x", secret]]:
        lines = [f"{SECRET_HEADER}: {text}" for text in given]
        answer = say(stage.port, "GET / HTTP/1.1", "Host: x", *UPGRADE, *lines)
        assert answer.startswith(b"HTTP/1.1 403 "), (given, answer[:200])


def enter(stage: Viewer, secret: str) -> ClientConnection:
    return connect(f"ws://127.0.0.1:{stage.port}/", subprotocols=[PROTOCOL], additional_headers={SECRET_HEADER: secret})


def test_who_knows_the_secret_enters_and_each_server_has_its_own(stage: Viewer) -> None:
    with enter(stage, stage.secret) as talk:
        assert talk.recv(timeout=30)
    other, secret = guarded_server()
    other.stop()
    assert secret != stage.secret
    assert len(stage.secret) >= 32 * 4 / 3
    with pytest.raises(InvalidStatus):
        enter(stage, secret)


def is_open(connection: socket.socket) -> bool:
    connection.setblocking(False)
    try:
        return connection.recv(1) != b""
    except BlockingIOError:
        return True
    except ConnectionResetError:
        return False


def test_those_that_say_nothing_hold_few_descriptors_and_keep_nobody_out(stage: Viewer) -> None:
    with contextlib.ExitStack() as crowd:
        address = "127.0.0.1", stage.port
        silent = [crowd.enter_context(socket.create_connection(address)) for _ in range(4 * MOST_SILENT)]
        with enter(stage, stage.secret):
            assert sum(map(is_open, silent)) <= MOST_SILENT


def test_a_viser_that_cannot_be_guarded_is_not_let_loose(monkeypatch) -> None:
    """A viser that imported the function that makes its server earlier, so that our check is never called."""
    made: list[ViserServer] = []
    init = ViserServer.__init__

    def noted(self: ViserServer, *arguments: Any, **options: Any) -> None:
        init(self, *arguments, **options)
        made.append(self)

    maker = SimpleNamespace(server=SimpleNamespace(serve=websockets.asyncio.server.serve))
    monkeypatch.setattr(_infra, "websockets", SimpleNamespace(asyncio=maker))
    monkeypatch.setattr(ViserServer, "__init__", noted)
    with pytest.raises(ValueError, match=r"viser>=1.1,<1.2"):
        guarded_server()
    with pytest.raises(OSError):
        socket.create_connection(("127.0.0.1", made[0].get_port()), timeout=30).close()


# ---------------------------------------------------------------- what a browser sends is not kept


def message(kind: str, **fields: object) -> bytes:
    return msgspec.msgpack.encode({"type": kind, **fields})


def camera(height: float = 9.0) -> bytes:
    place = {"position": (0.0, 0.0, height), "look_at": (0.0, 0.0, 0.0), "up_direction": (0.0, 0.0, 1.0)}
    lens = {"fov": 1.0, "near": 0.1, "far": 900.0, "image_height": 80, "image_width": 120}
    return message("ViewerCameraMessage", wxyz=(1.0, 0.0, 0.0, 0.0), **place, **lens)


def test_nothing_that_is_uploaded_through_the_proxy_is_kept(stage: Viewer) -> None:
    viser, box = stage.server, "a form that somebody makes up"
    buffer = viser._websock_server._broadcast_buffer.message_from_id
    upload = {"source_component_uuid": box, "transfer_uuid": "one"}
    start = {"filename": "f", "mime_type": "m", "part_count": 1000, "size_bytes": 10**9}
    with house(stage=stage) as server:  # type: ignore[arg-type]
        path, headers = f"/viser/ws/{PAGE}", dict(OURS)
        with server.client.websocket_connect(path, subprotocols=[PROTOCOL], headers=headers) as browser:
            browser.send_bytes(camera())
            until(viser.get_clients)
            kept = len(buffer)
            browser.send_bytes(message("FileTransferStartUpload", **upload, **start))
            for part in range(100):
                browser.send_bytes(message("FileTransferPart", **upload, part_index=part, content=b"p" * 50_000))
                browser.send_bytes(message("GuiFormDirtyMessage", uuid=f"form {part}"))
                browser.send_bytes(message("ShareUrlRequest"))
            browser.send_bytes(message("GuiUpdateMessage", uuid=box, updates={"value": True}))
            (client,) = viser.get_clients().values()

            def moved() -> bool:
                browser.send_bytes(camera(7.0))  # again: the stage may place a new page's camera meanwhile
                return client.camera.position[2] == 7.0

            until(moved)  # messages are handled in order: those above are done
            assert [gui._current_file_upload_states for gui in (viser.gui, client.gui)] == [{}, {}]
            assert len(buffer) <= kept + 1
            assert viser._share_tunnel is None
        until(lambda: not viser.get_clients())
