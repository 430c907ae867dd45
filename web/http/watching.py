"""Pages that only look on: what their websockets may say. Everything else is refused here, whatever the page itself offers.

Such a page has an id that begins with `watch-`. It says so itself, so that it stays one when the connection or the server
comes back. Whoever comes from the network of a class is one whatever it says (web/http/class_door.py).
"""

from __future__ import annotations

from typing import Any

import msgspec
from starlette.requests import HTTPConnection

from web.http.commands import Declined

WATCHER = "watch-"
PAGE_HEADER = "x-page"  # with it, every request of a page that looks on says whose it is
FROM_CLASS = "ratslam.from_class"  # in the scope of whatever comes through the door of the class
LOOKS = ("got", "view", "follow", "camera", "theme", "tabs")  # they concern the page alone
NO = "this page only looks on; whoever has the main page steers"


def looks_on(page: str) -> bool:
    """Whether a page with this id only looks on."""
    return page.startswith(WATCHER)


def comes_from_class(connection: HTTPConnection) -> bool:
    return bool(connection.scope.get(FROM_CLASS))


def must_look(kind: object) -> None:
    """Raises Declined when a message of this type is more than a look."""
    if kind not in LOOKS:
        raise Declined.of(403, NO)


def is_look(message: bytes) -> bool:
    """Whether a message of viser's client only tells where its own camera stands. It is read with viser's own reader, so that
    viser can understand nothing else by it."""
    try:
        said: dict[str, Any] | list[Any] | str | float | None = msgspec.msgpack.decode(message)
    except (msgspec.DecodeError, UnicodeDecodeError):
        return False
    return isinstance(said, dict) and said.get("type") == "ViewerCameraMessage"
