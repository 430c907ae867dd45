"""Stand-ins for the engine, the viewer and viser, to test the page's server without them."""

from __future__ import annotations

import contextlib
import itertools
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass, field
from http import HTTPStatus
from types import MappingProxyType
from typing import Any

from starlette.testclient import TestClient
from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve

from tests.fake_snapshots import fake_snapshot
from web.http.api import create_app
from web.latest import Latest
from web.messages import Accepted, Command, Refused, Snapshot
from web.switches import Switches
from web.viewer.camera_views import Camera
from web.viewer.viser_server import knows

PORT = 8000
ORIGIN = f"http://127.0.0.1:{PORT}"
PAGE = "p" * 22
OURS = MappingProxyType({"Host": f"127.0.0.1:{PORT}", "Origin": ORIGIN})  # headers of a websocket that is allowed in


class StubEngine:
    """Notes every command and gives the next answer at once (None: never; a function: its result)."""

    def __init__(self) -> None:
        self.commands: list[Command] = []
        self.answer: Accepted | Refused | Exception | Callable[[Any], Accepted | Refused] | None = Accepted(5)

    def submit(self, command: Command) -> Future[Accepted | Refused]:
        self.commands.append(command)
        future: Future[Accepted | Refused] = Future()
        if isinstance(self.answer, Exception):
            future.set_exception(self.answer)
        elif callable(self.answer):
            future.set_result(self.answer(command))
        elif self.answer is not None:
            future.set_result(self.answer)
        return future


@dataclass
class StubViewer:
    port: int = 0
    secret: str = "known to the proxy alone"
    on_connect: Callable[[int], None] | None = None
    on_complaint: Callable[[int, str], None] | None = None
    calls: list[tuple[Any, ...]] = field(default_factory=list)
    called: threading.Event = field(default_factory=threading.Event)
    cameras: dict[int, Camera] = field(default_factory=dict)  # those that have been turned
    comes_of_clicks: list[str | None] = field(default_factory=list)  # then nothing is said of them

    def _note(self, *call: Any) -> None:
        self.calls.append(call)
        self.called.set()

    def fly(self, client_id: int, view: str, at_once: bool = False, turned: Camera | None = None) -> None:
        self._note("jump" if at_once else "fly", client_id, view, *[turned] * (turned is not None))

    def follow(self, client_id: int, on: bool) -> None:
        self._note("follow", client_id, on)

    def replay(self, event: int) -> None:
        self._note("replay", event)

    def press(
        self, client_id: int, at: tuple[float, float], inspecting: bool, on_answer: Callable[[str | None], None]
    ) -> None:
        self._note("press", client_id, at, inspecting)
        if self.comes_of_clicks:
            on_answer(self.comes_of_clicks.pop(0))

    def hover(self, client_id: int, at: tuple[float, float], on_words: Callable[[str], None]) -> None:
        on_words(f"client {client_id} points at {at}")

    def turned(self, client_id: int) -> Camera | None:
        return self.cameras.get(client_id)


class StubViewers:
    """One viewer for both themes, unless another is given for the light one."""

    def __init__(self, dark: StubViewer | None = None, light: StubViewer | None = None) -> None:
        self.dark = dark or StubViewer()
        self.light = light or self.dark
        self.switches = Switches()
        self.calls: list[str] = []

    def of(self, theme: str, _large: bool = False, _still: bool = False) -> StubViewer:
        return {"dark": self.dark, "light": self.light}[theme]

    def start(self) -> None:
        self.calls.append("start")

    def stop(self) -> None:
        self.calls.append("stop")


@dataclass
class House:
    """A whole server behind the test client."""

    engine: StubEngine
    stage: StubViewer
    latest: Latest[Snapshot]
    client: TestClient
    switches: Switches

    def post(self, body: bytes, **headers: str) -> tuple[int, Any]:
        answer = self.client.post(
            "/api/commands", content=body, headers={"Content-Type": "application/json", **headers}
        )
        return answer.status_code, answer.json()

    def stream(self, path: str = f"/api/stream?page={PAGE}") -> Any:
        return self.client.websocket_connect(path, headers=dict(OURS))


@contextlib.contextmanager
def house(
    *, empty: bool = False, stage: StubViewer | None = None, light: StubViewer | None = None, **parts: Any
) -> Iterator[House]:
    """parts: what app hands over, as `create_app` takes it."""
    engine, stage, latest = StubEngine(), stage or StubViewer(), Latest[Snapshot]()
    if not empty:
        latest.put(fake_snapshot(12))
    viewers = StubViewers(stage, light)
    app = create_app(latest, engine.submit, viewers, PORT, **parts)
    with TestClient(app, base_url=ORIGIN) as client:
        yield House(engine, stage, latest, client, viewers.switches)


@contextlib.contextmanager
def viser_double(stage: StubViewer, greet: int = 1) -> Iterator[list[bytes]]:
    """A loopback server like viser's: its websocket requires the secret and numbers its client at the `greet`th message.

    It echoes what it receives; yields the list of what it has received.
    """
    got: list[bytes] = []
    secret = stage.secret
    numbers = itertools.count()

    def check(connection: ServerConnection, request: Request) -> Response | None:
        return None if knows(request, secret) else connection.respond(HTTPStatus.FORBIDDEN, "")

    def talk(connection: ServerConnection) -> None:
        for count, message in enumerate(connection, 1):
            got.append(message.encode() if isinstance(message, str) else bytes(message))
            if count == greet and stage.on_connect is not None:
                stage.on_connect(next(numbers))
            if message == b"text":
                connection.send("text")
            elif message == b"leave":
                return
            else:
                connection.send(message)

    def choose(_connection: ServerConnection, names: Any) -> Any:
        return names[0]

    with serve(talk, "127.0.0.1", 0, process_request=check, select_subprotocol=choose, compression=None) as server:
        stage.port = server.socket.getsockname()[1]
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield got
        finally:
            server.shutdown()
            thread.join()
