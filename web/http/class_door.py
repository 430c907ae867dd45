"""The door of a class (`ratslam run --class`): a second port, in the local network, for votes and for looking on.

It has a listener and a server of its own, so nothing that is said in a request decides through which door it came. What is
not in `OPEN` is refused, also whatever the application may learn to do later. Host and Origin must be exactly this address and
port: no name, so no name can be pointed here by others.
"""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from typing import Annotated, Any

import segno
from fastapi import FastAPI, Request
from fastapi.responses import Response
from pydantic import BaseModel, Field
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from web.http.asking import Body, Submit, ask_engine, body_of, json_response, takes
from web.http.commands import CommandAccepted, Declined, Problem, check, read_object
from web.http.security import (
    FROM_CLASS,
    MAX_VOTE_BYTES,
    PAGE_POLICY,
    VISER_POLICY,
    VOTE_PATH,
    Bucket,
    Limits,
    Refusal,
    bind_browser,
    refusal_of,
    refuse,
)
from web.http.state import to_json
from web.messages.commands import Label

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
    """ASGI middleware in front of the application, in the place of the main door's Guard.

    Websockets only look on, whatever they say (web/http/security.py), and their number is limited by itself, so that a class
    takes no place from the main page. Whoever asks too often is told so, by address.
    """

    def __init__(self, app: ASGIApp, classroom: Classroom) -> None:
        self._app, self._hosts = app, frozenset({classroom.host})
        self._watchers: dict[str, int] = {}
        self._buckets: dict[str, Bucket] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            return  # the main door's server begins and ends the application
        scope[FROM_CLASS] = True
        refusal = _refusal_at_door(scope, self._hosts) or self._too_much(scope)
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
        policy = VISER_POLICY if _kind(scope) == "viser" else PAGE_POLICY
        policy = policy.format(host=next(iter(self._hosts)))

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                bind_browser(MutableHeaders(scope=message), policy, local=False)
            await send(message)

        await self._app(scope, receive, send_with_headers)


def _kind(scope: Scope) -> str:
    return "viser" if scope["path"].startswith("/viser") else "stream"


def _refusal_at_door(scope: Scope, hosts: frozenset[str]) -> Refusal | None:
    """Why this request may not enter, or None. A vote must have an Origin: browsers tell Sec-Fetch-Site to https and loopback
    alone, so the rules of the main door that need it say nothing here."""
    method = scope["type"] if scope["type"] == "websocket" else scope["method"]
    if method not in OPEN or not OPEN[method].fullmatch(scope["path"]):
        return Refusal(403, f"a class votes and looks on; {method} {scope['path'][:80]} is for the main page alone")
    if method == "POST" and "origin" not in Headers(scope=scope):
        return Refusal(403, f"a vote needs the header Origin: http://{next(iter(hosts))}")
    return refusal_of(scope, hosts)


class VoteBody(Body):
    """As the command `vote`: an option by its number, or a point on the plan. voter: a text that each page makes up."""

    lesson: Label
    voter: Annotated[Label, Field(min_length=8)]
    choice: int | None = None
    x: float | None = None
    y: float | None = None


class ClassAddress(BaseModel):
    """Where a class votes, and where it looks on; null: nowhere."""

    vote: str | None
    watch: str | None


def add_classroom(app: FastAPI, classroom: Classroom | None, submit: Submit) -> None:
    """The routes of votes, and of the address at which a class votes, also as a QR code."""
    limits = Limits()
    errors: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (403, 413, 415, 422, 429, 503)}

    @app.post(VOTE_PATH, tags=["lessons"], openapi_extra=takes(VoteBody),
              responses={200: {"model": CommandAccepted}, **errors})  # fmt: skip
    async def vote(request: Request) -> Response:
        """One vote of a class on the prediction; the same voter may change it until it is shown."""
        document = read_object(await body_of(request, MAX_VOTE_BYTES))
        limits.pass_on("vote")
        sender = request.client.host if request.client else ""
        answer = await ask_engine(submit, check({**document, "type": "vote", "sender": sender}))
        return json_response(to_json({"accepted": True, "tick": answer.tick}))

    @app.get("/api/class", tags=["lessons"], responses={200: {"model": ClassAddress}})
    def address() -> Response:
        """The addresses for a class, if there are any (`ratslam run --class`)."""
        url = None if classroom is None else classroom.url
        return json_response(to_json({"vote": url, "watch": url and f"{url}?watch"}))

    @app.get("/api/class.svg", include_in_schema=False)
    def code() -> Response:
        """The address for votes as a QR code, dark on light in both themes, since readers expect that."""
        if classroom is None:
            raise Declined.of(404, "no class can reach this program; start it with `ratslam run --class`")
        drawn, made = io.BytesIO(), segno.make(classroom.url, micro=False)
        made.save(drawn, kind="svg", xmldecl=False, omitsize=True, dark="#000", light="#fff")
        return Response(drawn.getvalue(), media_type="image/svg+xml", headers={"Cache-Control": "no-cache"})
