"""The dashboard: one loopback port with the page, the API and the way to viser, from bind to a clean end; if it was asked for,
a second one in the local network, for a class."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import signal
import socket
import sys
import threading
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from types import FrameType
from typing import Literal

import uvicorn
from starlette.types import ASGIApp

from web.http.api import create_app
from web.http.brains import Offered
from web.http.class_door import ClassDoor, Classroom
from web.http.connections import (
    MAX_HEADER_BYTES,
    CannotListen,
    Connection,
    Door,
    Places,
    WebSocketProtocol,
    class_socket,
    listening_socket,
    places,
)
from web.http.export import Exports
from web.http.gallery import Gallery, Lessons
from web.http.proxy import ViewersLike
from web.http.recordings import Opener
from web.http.security import Guard
from web.http.situations import Situations
from web.http.stream import Submit
from web.latest import Latest
from web.messages import Snapshot

MAX_FRAME_BYTES = 64 * 1024
MAIN_SHARE = 3 / 16  # of the descriptors: 192 connections of the usual 1024 ...
CLASS_SHARE, CLASS_FROM_ONE = 1 / 8, 1 / 2  # ... and 128, half of which one address can have
LOOK_EVERY = 10  # of uvicorn's ticks, which take 0.1 s
_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@dataclass(frozen=True, slots=True)
class ForClass:
    """Where a class is to be let in. address: None: that of this machine in its local network."""

    address: str | None = None
    port: int = 8001


class Dashboard:
    """Owns the port and the viewers while it runs. `run` blocks until SIGINT, SIGTERM or `stop`."""

    def __init__(
        self,
        latest: Latest[Snapshot],
        submit: Submit,
        viewers: ViewersLike,
        host: str = "127.0.0.1",
        port: int = 8000,
        on_ready: Callable[[str], None] | None = None,
        offered: Offered | None = None,
        experiments: Gallery | None = None,
        exports: Exports | None = None,
        opener: Opener | None = None,
        situations: Situations | None = None,
        lessons: Lessons | None = None,
        for_class: ForClass | None = None,
    ) -> None:
        """offered: the brain of an earlier program, for whoever opens the page. experiments: for the page's gallery.
        exports: the formats in which the run can be had. opener: for recordings that are dropped on the page. situations:
        links to moments. lessons: those of the page. for_class: where a class votes and looks on; None: nowhere."""
        self._latest = latest
        self._submit = submit
        self._viewers = viewers
        self._host = host
        self._port = port
        self.on_ready = on_ready
        self._offered, self._experiments, self._exports, self._opener = offered, experiments, exports, opener
        self._situations = situations
        self._lessons, self._for_class = lessons, for_class
        self.classroom: Classroom | None = None  # known after `bind`
        self._class_socket: socket.socket | None = None
        self._socket: socket.socket | None = None
        self._server: _Server | None = None
        self._ended = False

    @property
    def url(self) -> str:
        """The page's address; with port 0 it is known after `bind`."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"http://{host}:{self._port}/"

    def bind(self) -> None:
        """Bind the port now, before anything slow starts. Raises CannotListen with a sentence."""
        self._socket = listening_socket(self._host, self._port)
        self._port = self._socket.getsockname()[1]
        if self._for_class is not None:
            self._class_socket = class_socket(self._for_class.address, self._for_class.port)
            self.classroom = Classroom(*self._class_socket.getsockname()[:2])

    def run(self) -> None:
        """Serve until told to stop. Exits with code 2 and a sentence when the address is not available."""
        try:
            if self._socket is None:
                self.bind()
        except CannotListen as error:
            print(error, file=sys.stderr)
            raise SystemExit(2) from None
        assert self._socket is not None
        try:
            self._viewers.start()
            guard = self._guard()
            beside: list[_DoorServer] = []
            if self.classroom is not None and self._class_socket is not None:
                door = _config(ClassDoor(guard.app, self.classroom), lifespan="off")
                beside.append(_BesideServer(door, self._class_socket, places(CLASS_SHARE, CLASS_FROM_ONE)))
            room = places(MAIN_SHARE)
            self._server = _Server(_config(guard), self._socket, room, self._announce, beside)
            self._server.should_exit = self._ended
            self._server.run()
        finally:
            self._socket.close()
            if self._class_socket is not None:
                self._class_socket.close()
            self._viewers.stop()

    def stop(self) -> None:
        """End `run` from any thread, also before it has begun."""
        self._ended = True
        if self._server is not None:
            self._server.should_exit = True

    def _announce(self) -> None:
        if self.on_ready is not None:
            self.on_ready(self.url)

    def _guard(self) -> Guard:
        return create_app(
            self._latest, self._submit, self._viewers, self._port, self._offered, self._experiments, self._exports,
            self._opener, self._situations, self._lessons, self.classroom,
        )  # fmt: skip


# After its second of grace uvicorn calls it an error that a browser reads nothing. Whoever ends the program need not know.
logging.getLogger("uvicorn.error").addFilter(lambda record: "graceful shutdown exceeded" not in str(record.msg))


def _config(app: ASGIApp, lifespan: Literal["auto", "off"] = "auto") -> uvicorn.Config:
    return uvicorn.Config(
        app,
        loop="asyncio",
        http=Connection,
        ws=WebSocketProtocol,
        lifespan=lifespan,
        h11_max_incomplete_event_size=MAX_HEADER_BYTES,
        ws_max_size=MAX_FRAME_BYTES,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=1,
        access_log=False,
        log_level="error",  # what others do wrong is told to them, and fills no log
        server_header=False,
        proxy_headers=False,
    )


class _DoorServer(uvicorn.Server):
    """A uvicorn server that takes its connections through a door of its own."""

    def __init__(self, config: uvicorn.Config, listener: socket.socket, room: Places) -> None:
        super().__init__(config)
        self._listener, self._room = listener, room
        self._door: Door | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:  # noqa: ARG002
        await super().startup([])
        self._door = Door(self._listener, self._room, self._connection, self.server_state.connections)

    async def on_tick(self, counter: int) -> bool:
        if self._door is not None and counter % LOOK_EVERY == 0:
            self._door.look()
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        if self._door is not None:
            await self._door.close()
        await super().shutdown(sockets)

    def _connection(self) -> Connection:
        return Connection(self.config, self.server_state, self.lifespan.state)


class _Server(_DoorServer):
    """One that says when it listens, and that ends quietly on a signal instead of raising it again."""

    def __init__(
        self,
        config: uvicorn.Config,
        listener: socket.socket,
        room: Places,
        on_ready: Callable[[], None],
        beside: Sequence[uvicorn.Server] = (),
    ) -> None:
        """beside: servers that begin and end with this one."""
        super().__init__(config, listener, room)
        self._on_ready, self._beside = on_ready, beside
        self._serving: list[asyncio.Task[None]] = []

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._serving = [asyncio.create_task(server.serve()) for server in self._beside]
        await asyncio.to_thread(self._on_ready)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        for server in self._beside:
            server.should_exit = True
        await asyncio.gather(super().shutdown(sockets), *self._serving)

    @contextlib.contextmanager
    def capture_signals(self) -> Generator[None, None, None]:
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.signal(number, self._leave) for number in _SIGNALS}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _leave(self, _number: int, _frame: FrameType | None) -> None:
        self.should_exit = True


class _BesideServer(_DoorServer):
    """One that leaves signals to the server that it stands beside."""

    @contextlib.contextmanager
    def capture_signals(self) -> Generator[None, None, None]:
        yield
