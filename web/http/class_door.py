"""The door of a class (`ratslam run --class`): a second port, in the local network, for votes and for looking on.

It has a listener and a server of its own, so nothing that is said in a request decides through which door it came. What is not
listed here is refused, also whatever the application may learn to do later. Here, too:

- Host and Origin must be exactly this address and port: no name, so no name can be pointed here by others.
- A vote must have an Origin. (Browsers tell Sec-Fetch-Site to https and loopback alone, so the rules of the main door that
  need it say nothing here.)
- Websockets only look on, whatever they say (web/http/watching.py), and their number is limited by itself, so that a class
  takes no place from the main page. Whoever asks too often is told so, by address.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from web.http.security import PAGE_POLICY, VISER_POLICY, VOTE_PATH, Bucket, Refusal, bind_browser, refusal_of, refuse
from web.http.watching import FROM_CLASS

LOOKS = (
    r"/",
    r"/favicon\.ico",
    r"/static/.+",
    r"/viser/",
    r"/api/(state|world|lessons|class|class\.svg|stage\.svg)",
    r"/api/lessons/[^/]+",
)
SOCKETS = (r"/api/stream", r"/viser/ws/[^/]+")
OPEN = {"GET": re.compile("|".join(LOOKS)), "POST": re.compile(VOTE_PATH), "websocket": re.compile("|".join(SOCKETS))}
MOST_WATCHERS = 8  # of each kind of websocket
RATE_HZ = 60.0  # requests of the API from one address, behind which a whole class may be
MOST_ADDRESSES = 512


@dataclass(frozen=True, slots=True)
class Classroom:
    """Where a class finds the door."""

    address: str
    port: int

    @property
    def host(self) -> str:
        """As in a Host header; port 80 is left out by browsers."""
        name = f"[{self.address}]" if ":" in self.address else self.address
        return name if self.port == 80 else f"{name}:{self.port}"

    @property
    def url(self) -> str:
        return f"http://{self.host}/"


class ClassDoor:
    """ASGI middleware in front of the application, in the place of the main door's Guard."""

    def __init__(self, app: ASGIApp, classroom: Classroom) -> None:
        self._app, self._hosts = app, frozenset({classroom.host})
        self._watchers: dict[str, int] = {}
        self._buckets: dict[str, Bucket] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            return  # the main door's server begins and ends the application
        scope[FROM_CLASS] = True
        refusal = refusal_at_door(scope, self._hosts) or self._too_much(scope)
        if refusal is not None:
            await refuse(scope, receive, send, refusal, local=False)
        elif scope["type"] == "websocket":
            await self._socket(scope, receive, send)
        else:
            await self._http(scope, receive, send)

    def _too_much(self, scope: Scope) -> Refusal | None:
        if scope["type"] == "websocket":
            full = self._watchers.get(_kind(scope), 0) >= MOST_WATCHERS
            return Refusal(503, f"{MOST_WATCHERS} pages look on already; close one") if full else None
        address = (scope.get("client") or ("",))[0]
        bucket = self._buckets.pop(address, None) or Bucket(RATE_HZ)
        self._buckets[address] = bucket
        if len(self._buckets) > MOST_ADDRESSES:
            del self._buckets[next(iter(self._buckets))]  # that which has been quiet for longest
        if not scope["path"].startswith("/api/") or bucket.take():
            return None
        return Refusal(429, f"at most {RATE_HZ:g} requests a second; wait a moment and send it again")

    async def _socket(self, scope: Scope, receive: Receive, send: Send) -> None:
        kind = _kind(scope)
        self._watchers[kind] = self._watchers.get(kind, 0) + 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._watchers[kind] -= 1

    async def _http(self, scope: Scope, receive: Receive, send: Send) -> None:
        policy = (VISER_POLICY if scope["path"].startswith("/viser") else PAGE_POLICY).format(
            host=next(iter(self._hosts))
        )

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                bind_browser(MutableHeaders(scope=message), policy, local=False)
            await send(message)

        await self._app(scope, receive, send_with_headers)


def _kind(scope: Scope) -> str:
    return "viser" if scope["path"].startswith("/viser") else "stream"


def refusal_at_door(scope: Scope, hosts: frozenset[str]) -> Refusal | None:
    """Why this request may not enter, or None."""
    method = scope["type"] if scope["type"] == "websocket" else scope["method"]
    if method not in OPEN or not OPEN[method].fullmatch(scope["path"]):
        return Refusal(403, f"a class votes and looks on; {method} {scope['path'][:80]} is for the main page alone")
    if method == "POST" and "origin" not in Headers(scope=scope):
        return Refusal(403, f"a vote needs the header Origin: http://{next(iter(hosts))}")
    return refusal_of(scope, hosts)
