"""The dashboard: one loopback port with the page, the API and the way to viser, from bind to a clean end."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import signal
import socket
import sys
import threading
from collections.abc import Callable, Generator
from types import FrameType

import uvicorn

from web.http.api import create_app
from web.http.experiments import Gallery
from web.http.export import Exports
from web.http.handshake import MAX_HEADER_BYTES, WebSocketProtocol
from web.http.kept_offer import Offered
from web.http.proxy import ViewersLike
from web.http.recordings import Opener
from web.http.stream import Submit
from web.latest import Latest
from web.messages import Snapshot

MAX_FRAME_BYTES = 64 * 1024
_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class CannotListen(Exception):  # noqa: N818
    """The address is not available; the message says why and what to do."""


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
    ) -> None:
        """offered: the brain of an earlier program, for whoever opens the page. experiments: for the page's gallery.
        exports: the formats in which the run can be had. opener: for recordings that are dropped on the page."""
        self._latest = latest
        self._submit = submit
        self._viewers = viewers
        self._host = host
        self._port = port
        self.on_ready = on_ready
        self._offered, self._experiments, self._exports, self._opener = offered, experiments, exports, opener
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
            self._server = _Server(self._config(), self._announce)
            self._server.should_exit = self._ended
            self._server.run([self._socket])
        finally:
            self._socket.close()
            self._viewers.stop()

    def stop(self) -> None:
        """End `run` from any thread, also before it has begun."""
        self._ended = True
        if self._server is not None:
            self._server.should_exit = True

    def _announce(self) -> None:
        if self.on_ready is not None:
            self.on_ready(self.url)

    def _config(self) -> uvicorn.Config:
        return uvicorn.Config(
            create_app(
                self._latest,
                self._submit,
                self._viewers,
                self._port,
                self._offered,
                self._experiments,
                self._exports,
                self._opener,
            ),
            ws=WebSocketProtocol,
            h11_max_incomplete_event_size=MAX_HEADER_BYTES,
            ws_max_size=MAX_FRAME_BYTES,
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=1,
            limit_concurrency=256,
            access_log=False,
            log_level="warning",
            server_header=False,
            proxy_headers=False,
        )


class _Server(uvicorn.Server):
    """A uvicorn server that says when it listens, and that ends quietly on a signal instead of raising it again."""

    def __init__(self, config: uvicorn.Config, on_ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._on_ready = on_ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        await asyncio.to_thread(self._on_ready)

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


def listening_socket(host: str, port: int) -> socket.socket:
    """A bound socket on a loopback address (port 0: any free one). Raises CannotListen."""
    address = _loopback(host)
    family = socket.AF_INET6 if address.version == 6 else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((str(address), port))
        listener.listen(128)  # at once: until then a second one could bind the same port
    except (OSError, OverflowError) as error:
        listener.close()
        if isinstance(error, OverflowError):
            reason = f"Port {port} does not exist; take one from 0 (any free one) to 65535 with --port."
        else:
            reason = f"Port {port} is not free ({error.strerror}). Choose another with --port, or 0 for any free one."
        raise CannotListen(reason) from None
    return listener


def _loopback(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """The address, which must be this machine's own: 127.0.0.1 or ::1."""
    try:
        address = ipaddress.ip_address("127.0.0.1" if host == "localhost" else host)
    except ValueError:
        address = None
    if address is None or str(address) not in ("127.0.0.1", "::1"):
        reason = f"{host!r} would let other machines in; the dashboard listens on 127.0.0.1, localhost or ::1 only."
        raise CannotListen(reason)
    return address
