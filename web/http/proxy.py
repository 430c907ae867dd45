"""viser's client and websocket through our own port, to the viewer of each page's look, and which viser client is whose.

viser listens on loopback on a port of its own and admits only who knows its secret, so everything reaches it through
here, after the guard. Its client is a single page. Only this one path of it is served, so there is nothing to traverse.
Every page brings an unguessable id. viser numbers its clients when their first camera message arrives. That message is
let through for one page at a time, so the number that then appears is that page's.
"""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import hashlib
import re
from collections.abc import Awaitable, Callable
from typing import Any, Protocol

import websockets
from starlette.requests import Request
from starlette.responses import Response
from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState
from websockets.asyncio.client import ClientConnection

from web.switches import Switches
from web.themes import Theme, Themes
from web.viewer.camera_views import Camera
from web.viewer.pointer import NOT_THERE
from web.viewer.viser_server import SECRET_HEADER, client_page, is_look

VIEWS = ("all", "office", "pose", "map")
PROTOCOL = re.compile(r"viser-v[\w.+-]{1,32}", re.ASCII)  # the client's version; viser refuses any but its own
PAGE_ID = re.compile(r"[A-Za-z0-9_-]{22,64}")
SEND_TIMEOUT_S = 10.0
CLOSE_TIMEOUT_S = 1.0
PAIRING_S = 2.0
CLICK_S = 5.0
AGAIN_S = 0.5  # a browser that was let in tries again without waiting
MOST_CLIENTS = 32


class ViewerLike(Protocol):
    """What the page needs from a 3-D viewer."""

    on_connect: Callable[[int], None] | None  # set by us; called with viser's client number when a browser connects
    on_complaint: Callable[[int, str], None] | None  # set by us; called with that number and why something was refused

    @property
    def port(self) -> int: ...
    @property
    def secret(self) -> str: ...  # the secret that viser's port requires
    def fly(self, client_id: int, view: str, at_once: bool = False, turned: Camera | None = None) -> None: ...
    def follow(self, client_id: int, on: bool) -> None: ...
    def replay(self, event: int) -> None: ...
    def press(
        self, client_id: int, at: tuple[float, float], inspecting: bool, on_answer: Callable[[str | None], None]
    ) -> None: ...  # calls `on_answer` once, from a thread of its own: None, or why nothing came of the click
    # Calls `on_words` once, from a thread of its own: what a click there would do.
    def hover(self, client_id: int, at: tuple[float, float], on_words: Callable[[str], None]) -> None: ...
    def turned(self, client_id: int) -> Camera | None: ...  # where somebody has turned this camera by hand


class ViewersLike(Protocol):
    """A viewer for each look."""

    def of(self, theme: Theme, large: bool = False, still: bool = False) -> ViewerLike: ...  # ConnectionError: stopped
    def start(self) -> None: ...
    def stop(self) -> None: ...
    @property
    def switches(self) -> Switches: ...  # shared by all pages


class Cameras:
    """Which viser client is whose, the view that each page asked for last, and where its camera was turned when it left."""

    def __init__(self) -> None:
        self._one_at_a_time = asyncio.Lock()
        self._arrival: tuple[ViewerLike, asyncio.Future[int]] | None = None
        self._overdue: dict[str, ViewerLike] = {}  # pages whose message got no number in time
        self._client_of: dict[str, tuple[ViewerLike, int]] = {}
        self._wanted: dict[str, str] = {}
        self._turned: dict[str, Camera] = {}
        self._following: dict[str, bool] = {}  # pages whose camera goes with the robot
        self.on_notice: Callable[[str, str], None] | None = None  # called with a page and what it should be told

    def listen(self, viewer: ViewerLike) -> None:
        """From now on, hear of a viewer's new clients and of refusals in the running loop; they happen in other threads."""
        loop = asyncio.get_running_loop()
        viewer.on_connect = lambda client_id: _call(loop, self._arrived, viewer, client_id)
        viewer.on_complaint = lambda client_id, text: _call(loop, self._complained, viewer, client_id, text)

    async def show(self, page: str, view: str) -> None:
        """Fly this page's camera to a view; remembered for later when its viewer is not connected yet."""
        self._turned.pop(page, None)
        self._following.pop(page, None)
        _remember(self._wanted, page, view)
        if page in self._client_of:
            viewer, client_id = self._client_of[page]
            await asyncio.to_thread(viewer.fly, client_id, view)

    def follow(self, page: str, on: bool) -> None:
        """This page's camera goes with the robot from now on, also in the viewer of another theme, or no longer."""
        _remember(self._following, page, on)
        if page in self._client_of:
            viewer, client_id = self._client_of[page]
            viewer.follow(client_id, on)

    def replay(self, page: str, event: int) -> None:
        """Play the correction after this loop closure again, in the viewer that this page looks at."""
        if page in self._client_of:
            self._client_of[page][0].replay(event)

    async def press(self, page: str, at: tuple[float, float], inspecting: bool) -> str | None:
        """A click on what this page's camera shows: why nothing came of it, None when it was carried out."""
        if page not in self._client_of:
            return NOT_THERE
        viewer, client_id = self._client_of[page]
        late = f"The click was not answered within {CLICK_S:g} s; it may still take effect"
        return await _said(lambda tell: viewer.press(client_id, at, inspecting, tell), late)

    async def hover(self, page: str, at: tuple[float, float]) -> str:
        """What a click there would do, in words; empty where it does nothing, or when nobody answers in time."""
        if page not in self._client_of:
            return ""
        viewer, client_id = self._client_of[page]
        return await _said(lambda tell: viewer.hover(client_id, at, tell), "") or ""

    async def turn(self, page: str, view: str, camera: Camera) -> None:
        """Fly this page's camera to where it had been turned from a view; remembered as in `show`."""
        _remember(self._wanted, page, view)
        if page in self._client_of:
            viewer, client_id = self._client_of[page]
            await asyncio.to_thread(viewer.fly, client_id, view, turned=camera)
        else:
            _remember(self._turned, page, camera)

    def turned(self, page: str) -> Camera | None:
        """Where somebody has turned this page's camera by hand; None when it stands at its view."""
        viewer, client_id = self._client_of.get(page, (None, 0))
        return None if viewer is None else viewer.turned(client_id)

    async def pair(self, page: str, viewer: ViewerLike, pass_on: Callable[[], Awaitable[None]]) -> bool:
        """Let one message of this page through (`pass_on`); True when viser numbered its client on it."""
        async with self._one_at_a_time:
            number: asyncio.Future[int] = asyncio.get_running_loop().create_future()
            self._arrival = viewer, number
            self._overdue.pop(page, None)
            try:
                await pass_on()
                async with asyncio.timeout(PAIRING_S):
                    client_id = await number
                self._client_of[page] = viewer, client_id
            except TimeoutError:
                self._overdue[page] = viewer
                return False
            finally:
                self._arrival = None
        if page in self._wanted:  # the page comes from another viewer or comes back: no flight
            turned = self._turned.pop(page, None)
            await asyncio.to_thread(viewer.fly, client_id, self._wanted[page], at_once=True, turned=turned)
        if self._following.get(page):
            viewer.follow(client_id, True)
        return True

    def paired(self, page: str) -> bool:
        return page in self._client_of

    def unpair(self, page: str, viewer: ViewerLike) -> None:
        """This page has left this viewer; it may already be connected to another."""
        if page in self._client_of and self._client_of[page][0] is viewer:
            turned = viewer.turned(self._client_of.pop(page)[1])
            if turned is not None:
                _remember(self._turned, page, turned)
        if self._overdue.get(page) is viewer:
            del self._overdue[page]

    def _arrived(self, viewer: ViewerLike, client_id: int) -> None:
        late = [page for page, its in self._overdue.items() if its is viewer]
        if self._arrival is not None and self._arrival[0] is viewer and not self._arrival[1].done():
            self._arrival[1].set_result(client_id)
        elif len(late) == 1:  # there is no doubt whose number it is
            del self._overdue[late[0]]
            self._client_of[late[0]] = viewer, client_id

    def _complained(self, viewer: ViewerLike, client_id: int, text: str) -> None:
        for page, (its, number) in self._client_of.items():
            if its is viewer and number == client_id and self.on_notice is not None:
                self.on_notice(page, text)


def _remember(kept: dict[str, Any], page: str, what: object) -> None:
    kept.pop(page, None)
    kept[page] = what
    if len(kept) > 2 * MOST_CLIENTS:
        del kept[next(iter(kept))]  # that of the page that has been quiet for longest


async def _said(ask: Callable[[Callable[[str | None], None]], None], late: str) -> str | None:
    """What `ask` is told, once, from another thread; `late` when that takes too long."""
    loop = asyncio.get_running_loop()
    said: asyncio.Future[str | None] = loop.create_future()

    def settle(words: str | None) -> None:
        if not said.done():
            said.set_result(words)

    ask(lambda words: _call(loop, settle, words))
    try:
        async with asyncio.timeout(CLICK_S):
            return await said
    except TimeoutError:
        return late


class ViserProxy:
    """The two ways to viser: its page and its websocket."""

    def __init__(self, viewers: ViewersLike, cameras: Cameras, themes: Themes) -> None:
        self._viewers, self._cameras, self._themes = viewers, cameras, themes
        self._client_page: tuple[bytes, bytes, str] | None = None  # as it is, gzipped, its ETag
        self._open = 0

    @property
    def full(self) -> bool:
        return self._open >= MOST_CLIENTS

    async def page(self, request: Request) -> Response:
        """viser's client, read once."""
        if self._client_page is None:
            body = await asyncio.to_thread(client_page)
            tag = f'"{hashlib.sha256(body).hexdigest()[:24]}"'
            self._client_page = body, await asyncio.to_thread(gzip.compress, body), tag
        body, packed, tag = self._client_page
        headers = {"ETag": tag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(packed, headers={**headers, "Content-Encoding": "gzip"}, media_type="text/html")
        return Response(body, headers=headers, media_type="text/html")

    async def relay(self, browser: WebSocket, page: str, watches: bool = False) -> None:
        """Relay both directions until one side ends or the page wants another look; its browser then reconnects at once.

        It is accepted before anything else: viser's client gives up what is not open within a second, and a viewer that has
        still to be built, or a busy machine, takes longer each time. watches: it only looks on; viser hears where its camera
        stands, and no drag. The guard has checked Host and Origin before this.
        """
        self._open += 1
        try:
            await browser.accept(subprotocol=spoken(browser)[0])
            with self._themes.shown(page) as (look, turned):
                viewer = await asyncio.to_thread(self._viewers.of, *look)
                await self._relay(browser, page, viewer, turned, watches)
        except (
            OSError,
            websockets.InvalidHandshake,
            WebSocketDisconnect,
        ):  # viser is gone or going: the browser tries again, at once
            await asyncio.sleep(AGAIN_S)
            with contextlib.suppress(WebSocketDisconnect):  # unless it has gone, too
                await browser.close(1013)
        finally:
            self._open -= 1
            await close_quietly(browser)

    async def _relay(
        self, browser: WebSocket, page: str, viewer: ViewerLike, turned: asyncio.Event, watches: bool
    ) -> None:
        self._cameras.listen(viewer)
        async with websockets.connect(
            f"ws://127.0.0.1:{viewer.port}/",
            subprotocols=spoken(browser)[:1],
            additional_headers={SECRET_HEADER: viewer.secret},
            compression=None,
            max_size=None,
            max_queue=1,  # what a browser does not take waits in viser, where the newest wins
            ping_interval=None,
            close_timeout=CLOSE_TIMEOUT_S,
            proxy=None,
        ) as viser:
            tasks = {
                asyncio.create_task(self._to_viser(browser, viser, page, viewer, watches)),
                asyncio.create_task(_to_browser(viser, browser)),
                asyncio.create_task(turned.wait()),
            }
            try:
                await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            finally:
                await end_all(tasks)
                self._cameras.unpair(page, viewer)

    async def _to_viser(
        self, browser: WebSocket, viser: ClientConnection, page: str, viewer: ViewerLike, watches: bool
    ) -> None:
        while True:
            try:
                message = await browser.receive_bytes()
            except (WebSocketDisconnect, KeyError):  # KeyError: text, which viser's client never sends
                return
            if watches and not is_look(message):
                continue
            if self._cameras.paired(page):
                await viser.send(message)
            else:
                await self._cameras.pair(page, viewer, lambda data=message: viser.send(data))


def spoken(browser: WebSocket) -> list[websockets.Subprotocol]:
    """Those of the subprotocols offered by a browser that viser may understand."""
    return [websockets.Subprotocol(name) for name in browser.scope["subprotocols"] if PROTOCOL.fullmatch(name)]


async def _to_browser(viser: ClientConnection, browser: WebSocket) -> None:
    async for message in viser:
        data = message if isinstance(message, bytes) else message.encode()
        async with asyncio.timeout(SEND_TIMEOUT_S):  # not wait_for, which may swallow a cancellation
            await browser.send_bytes(data)


async def end_all(tasks: set[asyncio.Task[Any]]) -> None:
    """Cancel these tasks and wait for their end. What they raised concerned a browser that is gone."""
    for task in tasks:
        task.cancel()
    await asyncio.wait(tasks)
    for task in tasks:
        if not task.cancelled():
            task.exception()


async def close_quietly(socket: WebSocket, code: int = 1000) -> None:
    """Close the socket of a browser that is still there, without waiting for one that reads nothing."""
    if socket.client_state is WebSocketState.CONNECTED:
        with contextlib.suppress(Exception):
            async with asyncio.timeout(CLOSE_TIMEOUT_S):
                await socket.close(code)


def _call(loop: asyncio.AbstractEventLoop, function: Callable[..., None], *arguments: object) -> None:
    if not loop.is_closed():
        loop.call_soon_threadsafe(function, *arguments)
