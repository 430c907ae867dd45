"""Who may talk to the server: exact Host and Origin, JSON only, bounded bodies, and the headers that bind the browser.

A local server can be reached by every page that its user has open (DNS rebinding, cross-site websockets). The check is
therefore pure ASGI: it runs before a websocket is accepted, which ordinary HTTP middleware does not. A page that only looks on
changes nothing: what is more than a look is refused here, whatever the page itself offers.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from disk.limits import SITUATION_BYTES
from web.http.commands import Declined, problem, wrong

MAX_BODY_BYTES = 64 * 1024
BRAIN_PATH, MAX_BRAIN_BYTES = "/api/brain", 256 * 1024 * 1024
RECORDING_PATH, MAX_RECORDING_BYTES = "/api/recordings", 900_000_000
PLAN_PATH, MAX_PLAN_BYTES = "/api/worlds/open", 24 * 1024 * 1024  # a picture of 16 MB in base64
OPEN_SITUATION_PATH, MAX_SITUATION_BYTES = "/api/situation/open", 2 * SITUATION_BYTES  # as a text in JSON
VOTE_PATH, MAX_VOTE_BYTES = "/api/vote", 4096
_MOST = {
    VOTE_PATH: MAX_VOTE_BYTES,
    BRAIN_PATH: MAX_BRAIN_BYTES,
    PLAN_PATH: MAX_PLAN_BYTES,
    RECORDING_PATH: MAX_RECORDING_BYTES,
    OPEN_SITUATION_PATH: MAX_SITUATION_BYTES,
}
COSTLY_PATHS = (
    BRAIN_PATH, "/api/state", "/api/experience/", "/api/experiments", "/api/export", "/api/world", "/api/picture/",
)  # fmt: skip
HOST_NAMES = ("127.0.0.1", "localhost", "[::1]")
WATCHER = "watch-"
PAGE_HEADER = "x-page"  # with it, every request of a page that looks on says whose it is
FROM_CLASS = "ratslam.from_class"  # in the scope of whatever comes through the door of the class
LOOKS = ("got", "view", "follow", "camera", "theme", "tabs")  # they concern the page alone
NO = "this page only looks on; whoever has the main page steers"

PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self' ws://{host}; "
    "frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)
# viser's client is one page that unpacks its own code and style with WebAssembly, whose glue code makes functions from
# text, and that runs its socket in a blob worker. Nothing that a person types ever becomes part of it.
VISER_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval' blob:; style-src 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src data:; connect-src 'self' data: blob: ws://{host}; worker-src blob: data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)


@dataclass(frozen=True, slots=True)
class Refusal:
    status: int
    reason: str


class Guard:
    """ASGI middleware in front of everything. The rules:

    - Host must be one of ours with our port, once. Missing or repeated: 400. Anything else: 403.
    - Origin, where there is one, must be "http://" + that Host. A websocket must have one (browsers always send it, so
      whoever leaves it out is a program and can add it); other requests may come without, as curl's do.
    - What is costly to make (a brain, a whole map, a world) is not read for another site (Sec-Fetch-Site).
    - A request that is neither GET nor HEAD must not be cross-site (Sec-Fetch-Site) and must carry JSON of at most 64 KiB,
      24 MiB with plans and 256 MiB with situations; a brain that is uploaded is application/octet-stream (no form can send
      that either) of at most 256 MiB. So is a recording, of at most 900 MB, which goes to a file part by part.
    - It must not come from a page that only looks on; such a page sends its id with every request (X-Page).
    """

    def __init__(self, app: ASGIApp, port: int) -> None:
        self.app = app
        self._hosts = own_hosts(port)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        refusal = refusal_of(scope, self._hosts)
        if refusal is not None:
            await refuse(scope, receive, send, refusal)
        elif scope["type"] == "websocket":
            await self.app(scope, receive, send)
        else:
            await self._http(scope, receive, send)

    async def _http(self, scope: Scope, receive: Receive, send: Send) -> None:
        host = Headers(scope=scope)["host"]
        policy = VISER_POLICY if scope["path"].startswith("/viser") else PAGE_POLICY

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                bind_browser(MutableHeaders(scope=message), policy.format(host=host))
            await send(message)

        await self.app(scope, receive, send_with_headers)


def own_hosts(port: int) -> frozenset[str]:
    """Every spelling of our own address in a Host header; port 80 is left out by browsers."""
    hosts = {f"{name}:{port}" for name in HOST_NAMES}
    return frozenset(hosts | set(HOST_NAMES) if port == 80 else hosts)


def refusal_of(scope: Scope, hosts: frozenset[str]) -> Refusal | None:
    """Why this request may not enter, or None."""
    headers = Headers(scope=scope)
    host, origin = headers.getlist("host"), headers.getlist("origin")
    if len(host) != 1 or len(origin) > 1:
        return Refusal(400, "a request needs one Host header and at most one Origin header")
    if host[0] not in hosts:
        return Refusal(403, _by_these_names(hosts))
    if origin and origin[0] != f"http://{host[0]}":
        return Refusal(403, f"requests from another origin are refused; the right one is http://{host[0]}")
    if scope["type"] == "websocket":
        return None if origin else Refusal(403, f"a websocket needs the header Origin: http://{host[0]}")
    if scope["method"] in ("GET", "HEAD"):
        costly = scope["path"].startswith(COSTLY_PATHS) and _from_elsewhere(headers)
        return Refusal(403, "this is too costly to be asked for by another site") if costly else None
    return _refusal_of_change(headers, scope["path"])


def _by_these_names(hosts: frozenset[str]) -> str:
    """How to come in. Through a tunnel a browser still says by which name and port it came."""
    local = next((host for host in hosts if host.startswith("localhost:")), None)
    words = f"this server answers to {', '.join(sorted(hosts))} only; open it by one of these names"
    if local is None:
        return words
    port = local.removeprefix("localhost:")
    return (
        f"{words}. From another machine: a tunnel with the same port at both ends, `ssh -L {port}:localhost:{port} MACHINE`, "
        f"and then http://{local}/. If {port} is taken there, start `ratslam run --port N` with one that is free at both ends. "
        "Another port at one end, https and a path before ours are not possible yet"
    )


def _from_elsewhere(headers: Mapping[str, str]) -> bool:
    return headers.get("sec-fetch-site", "none") not in ("same-origin", "none")


def _refusal_of_change(headers: Headers, path: str) -> Refusal | None:
    if _from_elsewhere(headers):
        return Refusal(403, "changes from another site are refused")
    if any(looks_on(page) for page in headers.getlist(PAGE_HEADER)):
        return Refusal(403, NO)
    what = {BRAIN_PATH: "a brain", RECORDING_PATH: "a recording"}.get(path, "a JSON body")
    kind = "application/json" if what == "a JSON body" else "application/octet-stream"
    most = _MOST.get(path, MAX_BODY_BYTES)
    if headers.get("content-type", "").partition(";")[0].strip().lower() != kind:
        return Refusal(415, f"a change needs {what} with the header Content-Type: {kind}")
    length = headers.get("content-length", "0")
    if not (length.isascii() and length.isdigit()):
        return Refusal(400, "Content-Length must be a whole number")
    if len(length) > 9 or int(length) > most:
        return Refusal(413, f"a body may have at most {most} bytes")
    return None


async def refuse(scope: Scope, receive: Receive, send: Send, refusal: Refusal, *, local: bool = True) -> None:
    if "text/html" in Headers(scope=scope).get("accept", ""):  # a person reads it, in a browser
        response = Response(f"{refusal.reason}\n", refusal.status, media_type="text/plain")
    else:
        response = Response(problem(refusal.reason), refusal.status, media_type="application/json")
    bind_browser(response.headers, "default-src 'none'; frame-ancestors 'none'", local)
    if scope["type"] == "websocket" and "websocket.http.response" not in scope.get("extensions", {}):
        await send({"type": "websocket.close", "code": 1008, "reason": refusal.reason[:120]})
    else:  # starlette turns this into the websocket's denial response
        await response(scope, receive, send)


def bind_browser(headers: MutableHeaders, policy: str, local: bool = True) -> None:
    """local: on this machine; browsers complain of an opener policy from elsewhere without https."""
    headers["Content-Security-Policy"] = policy
    headers["X-Content-Type-Options"] = "nosniff"
    headers["Referrer-Policy"] = "no-referrer"
    headers["X-Frame-Options"] = "SAMEORIGIN"
    if local:
        headers["Cross-Origin-Opener-Policy"] = "same-origin"
    headers["Cross-Origin-Resource-Policy"] = "same-origin"
    headers["Permissions-Policy"] = "camera=(), microphone=(), geolocation=(), payment=(), usb=()"


class Bucket:
    """A token bucket: `rate_hz` a second on average, up to one second's worth at once."""

    def __init__(self, rate_hz: float) -> None:
        self._rate_hz = rate_hz
        self._tokens = rate_hz
        self._at_s = time.monotonic()

    def take(self) -> bool:
        """True when one more is within the limit."""
        now_s = time.monotonic()
        self._tokens = min(self._rate_hz, self._tokens + (now_s - self._at_s) * self._rate_hz)
        self._at_s = now_s
        if self._tokens < 1.0:
            return False
        self._tokens -= 1.0
        return True


class Limits:
    """One sender's limits: drive, seek, vote and hover 60 a second each, all other commands 10 a second."""

    def __init__(self) -> None:
        self._often = {"drive": Bucket(60.0), "seek": Bucket(60.0), "vote": Bucket(60.0), "hover": Bucket(60.0)}
        self._other = Bucket(10.0)

    def refusal(self, kind: str) -> str | None:
        """Why a command of this type may not go on now, or None."""
        if kind in self._often:
            return None if self._often[kind].take() else f"at most 60 {kind} commands a second; send them less often"
        return None if self._other.take() else "at most 10 commands a second; wait a moment and send it again"

    def pass_on(self, kind: str) -> None:
        """Raises Declined when a command of this type may not go on now."""
        refusal = self.refusal(kind)
        if refusal is not None:
            raise Declined([wrong("type", kind, refusal)], 429)


def looks_on(page: str) -> bool:
    """Whether a page with this id only looks on. It says so itself, so that it stays one when the connection or the server comes
    back. Whoever comes from the network of a class is one whatever it says (web/http/class_door.py)."""
    return page.startswith(WATCHER)


def comes_from_class(connection: HTTPConnection) -> bool:
    return bool(connection.scope.get(FROM_CLASS))


def must_look(kind: object) -> None:
    """Raises Declined when a message of this type is more than a look."""
    if kind not in LOOKS:
        raise Declined.of(403, NO)
