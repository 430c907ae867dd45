"""One page that listens to the stream."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Coroutine
from typing import Any

from starlette.websockets import WebSocket

from web.http.security import Limits
from web.panel.panel import PanelReader

SEND_TIMEOUT_S = 5.0


class Client:
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
