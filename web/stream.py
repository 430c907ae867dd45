"""The page's websocket: the newest state to everyone, ten to twenty times a second, and commands back.

Out: {"type": "hello", ...} once, {"type": "state", "state": <contract>, "page": ...}, {"type": "events", ...} and
{"type": "answer", "id", ...} to a command that carried an id or went wrong. In: any command of `POST /api/commands`
with an optional "id", and two that concern pages alone: {"type": "view", "name"} and {"type": "theme", "name"}.
Each browser has its own sender, newest wins; one that takes nothing for five seconds is let go. A page that connects with
`got=1` says {"type": "got"} after each state and gets no other before: a slow one never falls behind in what lies in buffers.
"""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from web.commands import Malformed, check, problem_of, read_object, wrong
from web.latest import Latest
from web.messages import Accepted, Command, Drive, Errand, Refused, Snapshot
from web.proxy import VIEWS, Cameras, StageLike, Theme, close_quietly, end_all
from web.security import Limits
from web.state import StateText, event_fields, to_json

Submit = Callable[[Command | Errand], "Future[Accepted | Refused]"]

PERIOD_S = 0.045  # at x1 the engine ticks ten times a second; what a command changes need not wait for that
SEND_TIMEOUT_S = 5.0
ANSWER_TIMEOUT_S = 3.0
MOST_CLIENTS = 32
THEMES: tuple[Theme, ...] = ("dark", "light")


class NoAnswer(Exception):  # noqa: N818
    """The engine did not answer in time, or failed at the command; `status` is what HTTP calls that."""

    def __init__(self, status: int, reason: str) -> None:
        super().__init__(reason)
        self.status = status


async def ask(submit: Submit, command: Command | Errand, timeout_s: float | None = None) -> Accepted | Refused:
    """Hand a command to the engine and wait for what it says. Raises NoAnswer."""
    answer = asyncio.wrap_future(submit(command))
    timeout_s = ANSWER_TIMEOUT_S if timeout_s is None else timeout_s
    done, _ = await asyncio.wait({answer}, timeout=timeout_s)
    if not done:
        raise NoAnswer(
            503, f"the engine did not answer within {timeout_s:g} s; the command may still take effect, see /api/state"
        )
    error = answer.exception()
    if error is not None:
        raise NoAnswer(500, f"the engine failed at this command: {type(error).__name__}: {error}")
    return answer.result()


class Client:
    """One page that listens."""

    def __init__(self, socket: WebSocket, page: str, confirms: bool) -> None:
        self.socket = socket
        self.confirms = confirms  # says "got" to each state
        self.got = asyncio.Event()
        self.page = page
        self.news = asyncio.Event()
        self.limits = Limits()
        self.moving = False  # its last drive command asked for motion
        self.events_of: tuple[int, int] = (-1, -1)  # run and number of the last event it got
        self.answers: set[asyncio.Task[None]] = set()

    async def send(self, text: bytes) -> None:
        async with asyncio.timeout(SEND_TIMEOUT_S):  # not wait_for, which may swallow a cancellation
            await self.socket.send_text(text.decode())


class Stream:
    """All pages that listen to one session."""

    def __init__(self, latest: Latest[Snapshot], submit: Submit, stage: StageLike, cameras: Cameras) -> None:
        self.text = StateText()
        self.theme: Theme | None = None  # of all pages and the stage, once somebody chose
        self._launch = secrets.token_urlsafe(12)
        self._latest = latest
        self._submit = submit
        self._stage = stage
        self._cameras = cameras
        self._clients: set[Client] = set()
        self._driver: Client | None = None

    @property
    def full(self) -> bool:
        return len(self._clients) >= MOST_CLIENTS

    async def publish(self) -> None:
        """Wake every client's sender when there is a newer snapshot; runs for as long as the server does."""
        seen = 0
        while True:
            version, _ = await asyncio.to_thread(self._latest.wait, seen, 0.25)
            if version == seen:
                continue
            seen = version
            self._wake()
            await asyncio.sleep(PERIOD_S)

    async def serve(self, socket: WebSocket, page: str, confirms: bool = False) -> None:
        """One page from its arrival to its end."""
        await socket.accept()
        client = Client(socket, page, confirms)
        self._clients.add(client)
        client.news.set()
        tasks = {asyncio.create_task(self._tell(client)), asyncio.create_task(self._listen(client))}
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._clients.discard(client)
            self._stop_robot_of(client)
            await end_all(tasks | client.answers)
            await close_quietly(socket)

    # ------------------------------------------------------------ out

    def _wake(self) -> None:
        for client in self._clients:
            client.news.set()

    async def _tell(self, client: Client) -> None:
        await client.send(to_json({"type": "hello", "launch": self._launch, "themes": THEMES, "views": VIEWS}))
        while True:
            await client.news.wait()
            client.news.clear()
            _, snapshot = self._latest.get()
            if snapshot is None:
                continue
            client.got.clear()
            await client.send(self._state_message(snapshot))
            tail = self._events_for(client, snapshot)
            if tail is not None:
                await client.send(tail)
            if client.confirms:
                await client.got.wait()

    def _state_message(self, snapshot: Snapshot) -> bytes:
        parts = (b'{"type":"state","theme":', to_json(self.theme), b',"state":', self.text.light(snapshot))
        return b"".join((*parts, b',"page":', self.text.page(snapshot), b"}"))

    def _events_for(self, client: Client, snapshot: Snapshot) -> bytes | None:
        run, number = client.events_of
        fresh = run != snapshot.run
        news = [event_fields(event) for event in snapshot.events if fresh or event.number > number]
        if not news and not fresh:
            return None
        client.events_of = (snapshot.run, news[-1]["number"] if news else -1)
        return to_json({"type": "events", "run": snapshot.run, "fresh": fresh, "events": news})

    # ------------------------------------------------------------ in

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
            except Malformed as error:
                await client.send(_answer(identity, 422, error.wrongs))

    async def _take(self, client: Client, document: dict[str, Any], identity: object) -> None:
        kind = document.get("type")
        if kind == "got":
            client.got.set()
            return
        refusal = client.limits.refusal(kind if isinstance(kind, str) else "")
        if refusal is not None:
            await client.send(_answer(identity, 429, [wrong("type", kind, refusal)]))
        elif kind == "view":
            name = _choice(document, VIEWS)
            self._background(client, self._cameras.show(client.page, name))
        elif kind == "theme":
            theme: Theme = "light" if _choice(document, THEMES) == "light" else "dark"
            self.theme = theme
            self._stage.set_theme(theme)  # only posts it, and must not be lost with a page that closes
            self._wake()
        else:
            command = check(document)
            if isinstance(command, Drive):
                client.moving = command.speed != 0 or command.yaw_rate != 0
                self._driver = client
            self._background(client, self._command(client, command, identity))

    async def _command(self, client: Client, command: Command, identity: object) -> None:
        try:
            answer = await ask(self._submit, command)
        except NoAnswer as error:
            await client.send(_answer(identity, error.status, [wrong(None, None, str(error))]))
            return
        if isinstance(answer, Refused):
            await client.send(_answer(identity, 422, problem_of(answer)))
        elif identity is not None:
            await client.send(to_json({"type": "answer", "id": identity, "accepted": True, "tick": answer.tick}))

    def _background(self, client: Client, work: Any) -> None:
        task = asyncio.create_task(work)
        client.answers.add(task)
        task.add_done_callback(lambda done: (client.answers.discard(done), done.cancelled() or done.exception()))

    def _stop_robot_of(self, client: Client) -> None:
        if self._driver is client:
            self._driver = None
            if client.moving:
                self._submit(Drive(type="drive", speed=0.0, yaw_rate=0.0))


def _choice(document: dict[str, Any], names: tuple[str, ...]) -> str:
    for name in names:
        if document == {"type": document["type"], "name": name}:
            return name
    reason = f"{document['type']} takes name, one of: {', '.join(names)}"
    raise Malformed([wrong("name", document.get("name"), reason)])


def _answer(identity: object, status: int, detail: list[dict[str, Any]]) -> bytes:
    return to_json({"type": "answer", "id": identity, "accepted": False, "status": status, "detail": detail})
