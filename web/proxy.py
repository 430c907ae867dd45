"""viser's client and websocket through our own port, and which of viser's clients belongs to which page.

viser listens on loopback on a port of its own and checks nobody; everything reaches it through here, after the guard.
Its client is a single page, so that one path is all that is served of it: there is nothing to traverse.
Every page brings an unguessable id; viser numbers its clients when their first camera message arrives, so that message
is let through one page at a time and the number that appears then is that page's.
"""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import hashlib
import re
import urllib.request
from collections.abc import Awaitable, Callable
from typing import Literal, Protocol

import websockets
from starlette.requests import Request
from starlette.responses import Response
from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState
from websockets.asyncio.client import ClientConnection

VIEWS = ("all", "office", "pose", "map")
Theme = Literal["dark", "light"]
PAGE_ID = re.compile(r"[A-Za-z0-9_-]{22,64}")
SEND_TIMEOUT_S = 10.0
CLOSE_TIMEOUT_S = 1.0
PAIRING_S = 2.0
MOST_CLIENTS = 32


class StageLike(Protocol):
    """What the page needs from the 3-D stage."""

    on_connect: Callable[[int], None] | None  # set by us; called with viser's client number when a browser is there

    @property
    def port(self) -> int: ...
    def start(self) -> None: ...
    def stop(self) -> None: ...
    def fly(self, client_id: int, view: str) -> None: ...
    def set_theme(self, theme: Theme) -> None: ...


class Cameras:
    """Which viser client is whose, and the view each page asked for last."""

    def __init__(self, stage: StageLike) -> None:
        self._stage = stage
        self._one_at_a_time = asyncio.Lock()
        self._arrival: asyncio.Future[int] | None = None
        self._overdue: list[str] = []  # pages whose message got no number in time
        self._client_of: dict[str, int] = {}
        self._wanted: dict[str, str] = {}

    def listen(self) -> None:
        """Hear of viser's new clients (their thread) from now on, in the running loop."""
        loop = asyncio.get_running_loop()
        self._stage.on_connect = lambda client_id: _call(loop, self._arrived, client_id)

    async def show(self, page: str, view: str) -> None:
        """Fly this page's camera; remembered when its stage is not there yet."""
        self._wanted.pop(page, None)
        self._wanted[page] = view
        if len(self._wanted) > 2 * MOST_CLIENTS:
            del self._wanted[next(iter(self._wanted))]  # the page that has been quiet for longest
        client_id = self._client_of.get(page)
        if client_id is not None:
            await asyncio.to_thread(self._stage.fly, client_id, view)

    async def pair(self, page: str, pass_on: Callable[[], Awaitable[None]]) -> bool:
        """Let one message of this page through (`pass_on`); True when viser numbered its client on it."""
        async with self._one_at_a_time:
            self._arrival = asyncio.get_running_loop().create_future()
            if page in self._overdue:
                self._overdue.remove(page)
            try:
                await pass_on()
                async with asyncio.timeout(PAIRING_S):
                    self._client_of[page] = await self._arrival
            except TimeoutError:
                self._overdue.append(page)
                return False
            finally:
                self._arrival = None
        if page in self._wanted:
            await self.show(page, self._wanted[page])
        return True

    def paired(self, page: str) -> bool:
        return page in self._client_of

    def unpair(self, page: str) -> None:
        self._client_of.pop(page, None)
        self._overdue = [other for other in self._overdue if other != page]

    def _arrived(self, client_id: int) -> None:
        if self._arrival is not None and not self._arrival.done():
            self._arrival.set_result(client_id)
        elif len(self._overdue) == 1:  # late, and there is no doubt whose it is
            self._client_of[self._overdue.pop()] = client_id


class ViserProxy:
    """The two ways to viser: its page and its websocket."""

    def __init__(self, stage: StageLike, cameras: Cameras) -> None:
        self._stage = stage
        self._cameras = cameras
        self._client_page: tuple[bytes, bytes, str] | None = None  # as it is, gzipped, its ETag
        self._open = 0

    @property
    def full(self) -> bool:
        return self._open >= MOST_CLIENTS

    async def page(self, request: Request) -> Response:
        """viser's client, fetched from it once."""
        if self._client_page is None:
            body = await asyncio.to_thread(_fetch, f"http://127.0.0.1:{self._stage.port}/")
            tag = f'"{hashlib.sha256(body).hexdigest()[:24]}"'
            self._client_page = body, await asyncio.to_thread(gzip.compress, body), tag
        body, packed, tag = self._client_page
        headers = {"ETag": tag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(packed, headers={**headers, "Content-Encoding": "gzip"}, media_type="text/html")
        return Response(body, headers=headers, media_type="text/html")

    async def relay(self, browser: WebSocket, page: str) -> None:
        """Both directions until one side ends. The guard has checked Host and Origin before this."""
        self._open += 1
        try:
            async with websockets.connect(
                f"ws://127.0.0.1:{self._stage.port}/",
                subprotocols=[websockets.Subprotocol(name) for name in browser.scope["subprotocols"]],
                compression=None,
                max_size=None,
                ping_interval=None,
                proxy=None,
            ) as viser:
                await browser.accept(subprotocol=viser.subprotocol)
                await self._both_ways(browser, viser, page)
        except OSError:  # viser is gone: the browser tries again
            await browser.close(1013)
        finally:
            self._open -= 1
            self._cameras.unpair(page)
            await close_quietly(browser)

    async def _both_ways(self, browser: WebSocket, viser: ClientConnection, page: str) -> None:
        tasks = {
            asyncio.create_task(self._to_viser(browser, viser, page)),
            asyncio.create_task(_to_browser(viser, browser)),
        }
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            await end_all(tasks)

    async def _to_viser(self, browser: WebSocket, viser: ClientConnection, page: str) -> None:
        while True:
            try:
                message = await browser.receive_bytes()
            except (WebSocketDisconnect, KeyError):  # KeyError: text, which viser's client never sends
                return
            if self._cameras.paired(page):
                await viser.send(message)
            else:
                await self._cameras.pair(page, lambda data=message: viser.send(data))


async def _to_browser(viser: ClientConnection, browser: WebSocket) -> None:
    async for message in viser:
        data = message if isinstance(message, bytes) else message.encode()
        async with asyncio.timeout(SEND_TIMEOUT_S):  # not wait_for, which may swallow a cancellation
            await browser.send_bytes(data)


async def end_all(tasks: set[asyncio.Task[None]]) -> None:
    """Cancel these tasks and see them end; what they raised concerned a browser that is gone."""
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)
    for task in tasks:
        if not task.cancelled():
            task.exception()


async def close_quietly(socket: WebSocket, code: int = 1000) -> None:
    """Say goodbye to a browser that is still there, without waiting for one that takes nothing."""
    if socket.client_state is WebSocketState.CONNECTED:
        with contextlib.suppress(Exception):
            async with asyncio.timeout(CLOSE_TIMEOUT_S):
                await socket.close(code)


def _fetch(url: str) -> bytes:
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # never through a proxy
    with opener.open(url, timeout=10) as answer:
        return answer.read()


def _call(loop: asyncio.AbstractEventLoop, function: Callable[[int], None], argument: int) -> None:
    if not loop.is_closed():
        loop.call_soon_threadsafe(function, argument)
