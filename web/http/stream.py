"""The page's websocket: the newest state to everyone, ten to twenty times a second, and commands back.

Each browser has its own sender, and the newest state wins. A browser that takes nothing for five seconds is disconnected. A
page that connects with `got=1` says {"type": "got"} after each state and gets no other before, so that a slow page never falls
behind because of what lies in buffers.
"""

from __future__ import annotations

import asyncio
import contextlib
import secrets
import time
from collections.abc import Coroutine
from typing import Any

import numpy as np
from pydantic import ValidationError
from starlette.websockets import WebSocket, WebSocketDisconnect

from web.http.asking import Submit, ask_engine
from web.http.commands import Declined, Malformed, check, read_object, wrong
from web.http.proxy import VIEWS, Cameras, close_quietly, end_all
from web.http.security import Limits, must_look
from web.http.state import StateText, event_fields, to_json
from web.latest import Latest
from web.messages import CameraAt, Command, Drawn, Drive, Inspect, SetGoal, Snapshot, StageClick
from web.panel.panel import TABS, Panel, PanelReader
from web.switches import NAMES, Switches
from web.themes import THEMES, Theme, Themes
from web.viewer.camera_views import Camera
from web.viewer.picture import meant

SEND_TIMEOUT_S = 5.0
PERIOD_S = 0.045  # at x1 the engine ticks ten times a second; the effect of a command is shown sooner
MOST_CLIENTS = 32


class Stream:
    """All pages that listen to one session.

    Out: {"type": "hello", ...} once; {"type": "waking", "doing"} before the first tick; {"type": "state", "state": <contract>,
    "page": ...}; {"type": "events", ...}; {"type": "panel", ...}: what the open tabs of the side panel show, framed with arrays
    (web/panel); {"type": "answer", "id", ...} to every message that carried an id or went wrong; {"type": "notice", "text"}: why
    something done on this page's plates was refused; {"type": "presenting", "on"} to pages that only look on.

    In: any command of `POST /api/commands` with an optional "id". Messages that concern this page alone, and the only ones of a
    page that only looks on: {"type": "view", "name"}; {"type": "follow", "on"}: its camera goes with the robot; {"type": "theme",
    "name", "still"}, still: its reader wants little motion; {"type": "tabs", "names"}: the open tabs of the panel, since only
    those are sent; {"type": "camera", "name", "at"}: where a camera had been turned from a view. {"type": "replay", "event"}
    plays the correction of a loop closure again, for all pages of its look. {"type": "click", "at", "shift", "drawn"}: on the
    plates, or on the drawing in their place; it does what a pointer there means, and its answer says if not, and why. {"type":
    "hover", "at"} is answered by {"type": "hint", "words"}: what a click there would do. {"type": "switch", "name", "on"}
    concerns all pages, and {"type": "present", "on"} those that only look on.
    """

    def __init__(
        self, latest: Latest[Snapshot], submit: Submit, cameras: Cameras, themes: Themes, switches: Switches
    ) -> None:
        self.text = StateText()
        self._launch = secrets.token_urlsafe(12)
        self._latest, self._submit = latest, submit
        self._cameras, self._themes, self._switches = cameras, themes, switches
        cameras.on_notice = self.notify
        self._panel = Panel(switches)
        self._clients: set[Client] = set()
        self._driver: Client | None = None

    @property
    def full(self) -> bool:
        return len(self._clients) >= MOST_CLIENTS

    async def publish(self) -> None:
        """Wake every client's sender when there is a newer snapshot; runs for as long as the server does."""
        seen = 0
        while True:
            version, snapshot = await asyncio.to_thread(self._latest.wait, seen, 0.25)
            if version == seen:
                if version == 0:
                    self._wake()  # to say how far the start has come
                continue
            seen = version
            if snapshot is not None:
                self._panel.remember(snapshot)
            self._wake()
            await asyncio.sleep(PERIOD_S)

    async def serve(self, socket: WebSocket, page: str, confirms: bool = False, watches: bool = False) -> None:
        """Serve one page until it leaves. watches: it only looks on."""
        await socket.accept()
        client = Client(socket, page, confirms, PanelReader(self._panel), watches)
        self._clients.add(client)
        client.news.set()
        tasks = {asyncio.create_task(self._tell(client)), asyncio.create_task(self._listen(client))}
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._clients.discard(client)
            self._stop_robot_of(client)
            self._wake()  # it may have been the one that presents
            await end_all(tasks | client.tasks)
            await close_quietly(socket)

    def notify(self, page: str, text: str) -> None:
        """Send a sentence to one page alone."""
        for client in self._clients:
            if client.page == page:
                client.background(client.send(_text({"type": "notice", "text": text})))

    def _wake(self) -> None:
        for client in self._clients:
            client.news.set()

    async def _tell(self, client: Client) -> None:
        await client.send(
            _text({"type": "hello", "launch": self._launch, "themes": THEMES, "views": VIEWS, "tabs": TABS})
        )
        said, last, presented = "", None, None
        while True:
            await client.wait_for_news(client.reader.soon_s)
            presenting = any(other.presents for other in self._clients)
            if client.watches and presenting != presented:
                presented = presenting
                self._themes.enlarge(client.page, presenting)
                await client.send(_text({"type": "presenting", "on": presenting}))
            _, snapshot = self._latest.get()
            if snapshot is None:
                if said != self._latest.waking:
                    said = self._latest.waking
                    await client.send(_text({"type": "waking", "doing": said}))
                continue
            if snapshot is not last:
                client.got.clear()
                await self._tell_state(client, snapshot)
            for message in client.reader.news(snapshot, time.monotonic()):
                await client.send(message)
            if snapshot is not last and client.confirms:
                await client.got.wait()
            last = snapshot

    async def _tell_state(self, client: Client, snapshot: Snapshot) -> None:
        state, page = self.text.light(snapshot).decode(), self.text.page(snapshot).decode()
        await client.send(f'{{"type":"state","state":{state},"page":{page}}}')
        tail = self._events_for(client, snapshot)
        if tail is not None:
            await client.send(tail)

    def _events_for(self, client: Client, snapshot: Snapshot) -> str | None:
        run, number = client.events_of
        fresh = run != snapshot.run
        news = [event_fields(event) for event in snapshot.events if fresh or event.number > number]
        if not news and not fresh:
            return None
        client.events_of = (snapshot.run, news[-1]["number"] if news else -1)
        return _text({"type": "events", "run": snapshot.run, "fresh": fresh, "events": news})

    async def _listen(self, client: Client) -> None:
        while True:
            try:
                text = await client.socket.receive_text()
            except (WebSocketDisconnect, KeyError):  # KeyError: a binary message, which no page sends
                return
            identity = None
            try:
                document = read_object(text)
                identity = document.pop("id", None)
                await self._take(client, document, identity)
            except Declined as error:
                await client.send(_answer(identity, error))

    async def _take(self, client: Client, document: dict[str, Any], identity: object) -> None:
        kind = document.get("type")
        if kind == "got":
            client.got.set()
            await self._confirm(client, identity)
            return
        client.limits.pass_on(kind if isinstance(kind, str) else "")
        if client.watches:
            must_look(kind)
        if kind == "click":
            client.background(self._click(client, document, identity))
        elif kind == "hover":
            client.background(self._hover(client, document))
        elif self._page_says(client, kind, document):
            await self._confirm(client, identity)
        else:
            command = check(document)
            if isinstance(command, Drive):
                client.moving = command.speed != 0 or command.yaw_rate != 0
                self._driver = client
            client.background(self._command(client, command, identity))

    def _page_says(self, client: Client, kind: object, document: dict[str, Any]) -> bool:
        """Do what concerns pages alone; False when the message is none of these."""
        page = client.page
        if kind == "view":
            client.background(self._cameras.show(page, _choice(document, VIEWS)))
        elif kind == "follow":
            self._cameras.follow(page, _flag(document))
        elif kind == "replay":
            self._cameras.replay(page, _event(document))
        elif kind == "camera":
            client.background(self._cameras.turn(page, *_turned(document)))
        elif kind == "theme":
            self._themes.choose(page, *_theme(document))
        elif kind == "tabs":
            client.reader.tabs = _tabs(document)
            client.news.set()
        elif kind == "present":
            client.presents = _flag(document)
            self._themes.enlarge(page, client.presents)
            self._wake()
        elif kind == "switch":
            self._turn(document)
        else:
            return False
        return True

    async def _command(self, client: Client, command: Command, identity: object) -> None:
        try:
            answer = await ask_engine(self._submit, command)
        except Declined as error:
            await client.send(_answer(identity, error))
            return
        if identity is not None:
            await client.send(_text({"type": "answer", "id": identity, "accepted": True, "tick": answer.tick}))

    async def _click(self, client: Client, document: dict[str, Any], identity: object) -> None:
        """On the stage. It is answered: carried out, or why not."""
        try:
            click = StageClick.model_validate(document)
        except ValidationError as error:
            reason = f"click takes at, shift and drawn: {error.errors()[0]['msg']}"
            await client.send(_answer(identity, Malformed([wrong("at", None, reason)])))
            return
        if click.drawn is None:
            why = await self._cameras.press(client.page, click.at, click.shift)
        else:
            order = self._meant(click, click.drawn)
            if not isinstance(order, str):
                await self._command(client, order, identity)
                return
            why = order
        if why is None:
            await self._confirm(client, identity)
        else:
            await client.send(_answer(identity, Declined.of(422, why)))

    async def _hover(self, client: Client, document: dict[str, Any]) -> None:
        """The page points there. What is no place has no meaning."""
        with contextlib.suppress(ValidationError):
            words = await self._cameras.hover(client.page, StageClick.model_validate(document).at)
            await client.send(_text({"type": "hint", "words": words}))

    def _meant(self, click: StageClick, drawn: Drawn) -> SetGoal | Inspect | str:
        _, snapshot = self._latest.get()
        if snapshot is None:
            return "No goal set: the robot has not begun yet"
        inspecting = click.shift or self._switches.is_on("click_inspects")
        return meant(snapshot, drawn.view, drawn.aspect, click.at, inspecting)

    def _turn(self, document: dict[str, Any]) -> None:
        name, on = document.get("name"), document.get("on")
        for known in NAMES:
            if document == {"type": "switch", "name": known, "on": on} and isinstance(on, bool):
                self._switches.turn(known, on)
                self._wake()
                return
        raise Malformed([wrong("name", name, f"switch takes on, true or false, and name, one of: {', '.join(NAMES)}")])

    async def _confirm(self, client: Client, identity: object) -> None:
        """Answer a message that concerns pages alone, when it had an id."""
        if identity is not None:
            _, snapshot = self._latest.get()
            tick = None if snapshot is None else snapshot.tick
            await client.send(_text({"type": "answer", "id": identity, "accepted": True, "tick": tick}))

    def _stop_robot_of(self, client: Client) -> None:
        if self._driver is client:
            self._driver = None
            if client.moving:
                self._submit(Drive(type="drive", speed=0.0, yaw_rate=0.0))


class Client:
    """One page that listens to the stream."""

    def __init__(
        self, socket: WebSocket, page: str, confirms: bool, reader: PanelReader, watches: bool = False
    ) -> None:
        self.socket = socket
        self.confirms = confirms  # says "got" to each state
        self.got = asyncio.Event()
        self.page = page
        self.watches = watches  # it only looks on
        self.presents = False  # in larger type, for a class
        self.reader = reader  # the side panel's, for this page
        self.news = asyncio.Event()
        self.limits = Limits()
        self.moving = False  # its last drive command asked for motion
        self.events_of: tuple[int, int] = (-1, -1)  # run and number of the last event it got
        self.tasks: set[asyncio.Task[None]] = set()

    async def send(self, message: bytes | str) -> None:
        """Text, or bytes where a panel's part has arrays."""
        async with asyncio.timeout(SEND_TIMEOUT_S):  # not wait_for, which may swallow a cancellation
            if isinstance(message, str):
                await self.socket.send_text(message)
            else:
                await self.socket.send_bytes(message)

    async def wait_for_news(self, at_most_s: float | None) -> None:
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(at_most_s):
                await self.news.wait()
        self.news.clear()

    def background(self, work: Coroutine[Any, Any, None]) -> None:
        """Run work beside the page's listening. It ends with the page, and its failure ends nothing else."""
        task = asyncio.create_task(work)
        self.tasks.add(task)
        task.add_done_callback(lambda done: (self.tasks.discard(done), done.cancelled() or done.exception()))


def _choice(document: dict[str, Any], names: tuple[str, ...]) -> str:
    for name in names:
        if document == {"type": document["type"], "name": name}:
            return name
    reason = f"{document['type']} takes name, one of: {', '.join(names)}"
    raise Malformed([wrong("name", document.get("name"), reason)])


def _theme(document: dict[str, Any]) -> tuple[Theme, bool]:
    """The theme, and whether little motion is wanted."""
    still = document.pop("still", False)
    if not isinstance(still, bool):
        raise Malformed([wrong("still", still, "still is true or false")])
    return "light" if _choice(document, THEMES) == "light" else "dark", still


def _flag(document: dict[str, Any]) -> bool:
    on = document.get("on")
    if document != {"type": document["type"], "on": on} or not isinstance(on, bool):
        raise Malformed([wrong("on", on, f"{document['type']} takes on, true or false")])
    return on


def _event(document: dict[str, Any]) -> int:
    event = document.get("event")
    if document != {"type": document["type"], "event": event} or type(event) is not int:
        raise Malformed([wrong("event", event, f"{document['type']} takes event, the number of a loop closure")])
    return event


def _turned(document: dict[str, Any]) -> tuple[str, Camera]:
    """The view, and where the camera had been turned from it."""
    name = document.get("name")
    try:
        at = CameraAt.model_validate(document.get("at"))
    except ValidationError as error:
        raise Malformed([wrong("at", None, f"camera takes at: {error.errors()[0]['msg']}")]) from None
    if name not in VIEWS:
        raise Malformed([wrong("name", name, f"camera takes name, one of: {', '.join(VIEWS)}")])
    return str(name), Camera(np.array(at.position), np.array(at.look_at), at.fov_rad)


def _tabs(document: dict[str, Any]) -> frozenset[str]:
    names: list[Any] | dict[str, Any] | str | float | None = document.get("names")
    if document != {"type": "tabs", "names": names} or not isinstance(names, list) or not all(n in TABS for n in names):
        raise Malformed([wrong("names", names, f"tabs takes names, a list of: {', '.join(TABS)}")])
    return frozenset(names)


def _answer(identity: object, declined: Declined) -> str:
    fields = {"type": "answer", "id": identity, "accepted": False, "status": declined.status}
    return _text({**fields, "detail": declined.wrongs})


def _text(document: object) -> str:
    return to_json(document).decode()
