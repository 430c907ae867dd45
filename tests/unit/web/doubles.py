"""Stand-ins for the engine, the stage and viser, to test the page's server without them."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import Any

from starlette.testclient import TestClient
from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve

from tests.fake_snapshots import fake_snapshot
from web.api import create_app
from web.latest import Latest
from web.messages import Accepted, Command, Refused, Snapshot

PORT = 8000
ORIGIN = f"http://127.0.0.1:{PORT}"
PAGE = "p" * 22
OURS = {"Host": f"127.0.0.1:{PORT}", "Origin": ORIGIN}  # of a websocket that may enter


class StubEngine:
    """Takes down every command and gives the next answer at once (None: never; a function: what it says)."""

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
class StubStage:
    port: int = 0
    on_connect: Callable[[int], None] | None = None
    calls: list[tuple[Any, ...]] = field(default_factory=list)
    called: threading.Event = field(default_factory=threading.Event)

    def _note(self, *call: Any) -> None:
        self.calls.append(call)
        self.called.set()

    def start(self) -> None:
        self._note("start")

    def stop(self) -> None:
        self._note("stop")

    def fly(self, client_id: int, view: str) -> None:
        self._note("fly", client_id, view)

    def set_theme(self, theme: str) -> None:
        self._note("set_theme", theme)


@dataclass
class House:
    """A whole server in the test client's hands."""

    engine: StubEngine
    stage: StubStage
    latest: Latest[Snapshot]
    client: TestClient

    def post(self, body: bytes, **headers: str) -> tuple[int, Any]:
        answer = self.client.post(
            "/api/commands", content=body, headers={"Content-Type": "application/json", **headers}
        )
        return answer.status_code, answer.json()

    def stream(self, path: str = f"/api/stream?page={PAGE}") -> Any:
        return self.client.websocket_connect(path, headers=OURS)


@contextlib.contextmanager
def house(*, empty: bool = False, stage: StubStage | None = None) -> Iterator[House]:
    engine, stage, latest = StubEngine(), stage or StubStage(), Latest[Snapshot]()
    if not empty:
        latest.put(fake_snapshot(12))
    app = create_app(latest, engine.submit, stage, PORT)
    with TestClient(app, base_url=ORIGIN) as client:
        yield House(engine, stage, latest, client)


@contextlib.contextmanager
def viser_double(stage: StubStage, greet: int = 1) -> Iterator[list[bytes]]:
    """A loopback server like viser's: a page, and a websocket that numbers its client at the `greet`th message.

    Echoes what it gets; yields the list of what it got.
    """
    got: list[bytes] = []
    numbers = iter(range(100))

    def page(_connection: ServerConnection, request: Request) -> Response | None:
        if request.headers.get("Upgrade") == "websocket":
            return None
        return Response(HTTPStatus.OK, "OK", Headers({"Content-Length": "4"}), b"page")

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
        return next((name for name in names if name.startswith("viser-v")), None)

    with serve(talk, "127.0.0.1", 0, process_request=page, select_subprotocol=choose, compression=None) as server:
        stage.port = server.socket.getsockname()[1]
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield got
        finally:
            server.shutdown()
            thread.join()
