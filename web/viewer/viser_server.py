"""viser's server as a viewer uses it: for our proxy alone, silent, and deaf to messages that we do not use.

viser checks nobody, and any page open in a browser on this machine can find a port on the loopback within seconds. So
every request, for a page or a websocket, is refused before anything is served or accepted unless it carries the
server's secret. viser itself has no place for such a check. It makes its server with `websockets.asyncio.server.serve`,
which has one: while viser starts, that name leads through here. A viser that makes its server in another way is not
used.
"""

# What we have to reach in viser is private there.
# pyright: reportPrivateUsage=false, reportUnknownMemberType=false, reportUnknownArgumentType=false

from __future__ import annotations

import contextlib
import logging
import pathlib
import secrets
from collections.abc import Generator
from http import HTTPStatus
from typing import Any

import msgspec
import rich  # viser's printer
import viser
import websockets.asyncio.server as serving
from viser import _messages
from viser.infra import WebsockMessageHandler
from websockets.http11 import Request, Response

SECRET_HEADER = "X-Stage-Secret"
MOST_SILENT = 32  # connections that may leave open whether they are ours: each holds a descriptor
# The only messages of a browser that are handled. viser would also open a public tunnel, keep whatever is uploaded, and
# store for good that any form was touched.
HEARD: set[type[Any]] = {
    _messages.ViewerCameraMessage,
    _messages.SceneNodeClickMessage,
    _messages.SceneNodeDragMessage,
}


def guarded_server() -> tuple[viser.ViserServer, str]:
    """A server at a free port of the loopback, and its secret. Raises ValueError when it cannot be guarded."""
    rich.get_console().quiet = True  # viser's banner and goodbye; nobody else prints there
    logging.getLogger("websockets.server").addFilter(_worth_telling)
    secret = secrets.token_urlsafe(32)
    with _asking_for(secret) as asks:
        server = viser.ViserServer(host="127.0.0.1", port=0, label="RatSLAM", verbose=False)
    if not asks:
        server.stop()
        raise ValueError(
            f"viser {viser.__version__} opens its port in another way than viser 1.1 does, so that the viewer would be open "
            "to every page in your browser; install viser>=1.1,<1.2"
        )
    _hear_little(server._websock_server)
    server._websock_server.on_client_connect(_hear_little)  # after viser has given the client its own handlers
    server.scene.world_axes.visible = False
    return server, secret


def client_page() -> bytes:
    """viser's client, which is one page."""
    return (pathlib.Path(viser.__file__).parent / "client" / "build" / "index.html").read_bytes()


def knows(request: Request, secret: str) -> bool:
    """Whether a request carries the secret, once. The comparison takes as long for a near miss as for any other."""
    given = request.headers.get_all(SECRET_HEADER)
    return len(given) == 1 and secrets.compare_digest(given[0].encode(errors="surrogateescape"), secret.encode())


def is_look(message: bytes) -> bool:
    """Whether a message of viser's client only tells where its own camera stands. It is read with viser's own reader, so that
    viser can understand nothing else by it."""
    try:
        said: dict[str, Any] | list[Any] | str | float | None = msgspec.msgpack.decode(message)
    except (msgspec.DecodeError, UnicodeDecodeError):
        return False
    return isinstance(said, dict) and said.get("type") == "ViewerCameraMessage"


def _hear_little(handlers: WebsockMessageHandler) -> None:
    for message in set(handlers._incoming_handlers) - HEARD:
        handlers.unregister_handler(message)


def _worth_telling(record: logging.LogRecord) -> bool:
    return record.getMessage() != "opening handshake failed"  # somebody connected who does not speak websocket


@contextlib.contextmanager
def _asking_for(secret: str) -> Generator[list[str], None, None]:
    """Servers that are made meanwhile require the secret and serve no pages; yields where they listen."""
    plain: Any = serving.serve
    asks: list[str] = []

    silent = dict[serving.ServerConnection, None]()  # those that have not told the secret yet

    class Counted(serving.ServerConnection):
        def connection_made(self, transport: Any) -> None:
            super().connection_made(transport)
            silent[self] = None
            if len(silent) > MOST_SILENT:
                longest = next(iter(silent))
                del silent[longest]
                longest.transport.abort()

        def connection_lost(self, exc: Exception | None) -> None:
            silent.pop(self, None)
            super().connection_lost(exc)

    def check(connection: serving.ServerConnection, request: Request) -> Response | None:
        if not knows(request, secret):
            return connection.respond(HTTPStatus.FORBIDDEN, "not for you\n")
        silent.pop(connection, None)
        return None

    def serve(handler: Any, host: str, port: int, **options: Any) -> serving.serve:
        asks.append(f"{host}:{port}")
        return plain(handler, host, port, **{**options, "process_request": check, "create_connection": Counted})

    serving.serve = serve
    try:
        yield asks
    finally:
        serving.serve = plain
