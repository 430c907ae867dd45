"""Connections at a door: counted when they are accepted, before they have said anything, and ended when they keep others waiting.

uvicorn counts those that ask for something, and waits for the end of a request for ever. asyncio takes whatever comes, until no
descriptor is left, for anybody; then it complains thousands of times a second (cpython 151615). So each door takes its
connections itself, one after the other, and has a number of places of its own. Where they are taken, the one that has owed
something for longest makes room: the rest of a request, or reading on. One that owes nothing never has to go.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

try:
    import resource
except ImportError:  # a system without such limits
    resource = None

HEADERS_S = 10.0  # for all headers of a request, from the moment when it could begin
STALLED_S = 20.0  # without a byte of a body that is waited for, or without reading a byte of an answer
BACK_OFF_S = 0.5  # after a connection could not be accepted
MOST_DESCRIPTORS = 1024  # of this process, that the places are for

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Places:
    """How many connections a door has room for at once, in all and from one address."""

    most: int
    from_one: int


def places(share: float, from_one: float = 1.0) -> Places:
    """share: of the descriptors of this process; a connection may need one more, for a file or on the way to viser.
    from_one: of these places."""
    soft = MOST_DESCRIPTORS if resource is None else resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    few = soft if 0 < soft < MOST_DESCRIPTORS else MOST_DESCRIPTORS  # -1: as many as one likes
    most = max(8, int(few * share))
    return Places(most, max(4, int(most * from_one)))


class Connection(H11Protocol):
    """uvicorn's protocol, which also knows since when the other side owes something."""

    since_s = 0.0

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        self.since_s = self.loop.time()
        super().connection_made(transport)

    def data_received(self, data: bytes) -> None:
        if self.conn.their_state is not h11.IDLE:  # headers are not given more time for coming in drops
            self.since_s = self.loop.time()
        super().data_received(data)

    def on_response_complete(self) -> None:
        self.since_s = self.loop.time()
        super().on_response_complete()

    def pause_writing(self) -> None:
        self.since_s = self.loop.time()
        super().pause_writing()

    @property
    def owes_s(self) -> float | None:
        """How long it may go on owing what it owes; None: nothing."""
        if self.flow.write_paused:
            return STALLED_S
        if self.conn.their_state is h11.IDLE:
            return HEADERS_S
        return STALLED_S if self.conn.their_state is h11.SEND_BODY and not self.flow.read_paused else None


class Door:
    """Accepts connections on one socket, in the running loop."""

    def __init__(self, listener: socket.socket, room: Places, made: Callable[[], Connection], kept: set[Any]) -> None:
        """made: a new connection. kept: those that are open, as uvicorn keeps them; some speak websocket by now."""
        self._listener, self._room, self._made, self._open = listener, room, made, kept
        self._leaving: dict[Any, float] = {}  # those that are told to go, and since when
        self._complained = False
        listener.setblocking(False)
        self._task = asyncio.create_task(self._accept())

    async def close(self) -> None:
        """Take no more connections. Those that are open stay."""
        self._task.cancel()
        await asyncio.wait({self._task})
        self._listener.close()

    def look(self) -> None:
        """End the connections that have owed something for too long. To be called now and then."""
        now_s = asyncio.get_running_loop().time()
        self._leaving = {one: self._leaving.get(one, now_s) for one in self._open if _leaves(one)}
        for one, (since_s, may_s) in self._owing().items():
            if now_s - since_s > may_s:
                one.transport.abort()

    async def _accept(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                connection, address = await loop.sock_accept(self._listener)
            except ConnectionAbortedError:  # it went while it waited
                continue
            except OSError as error:
                self._complain(error)
                await asyncio.sleep(BACK_OFF_S)
                continue
            if not self._makes_room(address[0]):
                connection.close()
                continue
            with contextlib.suppress(OSError):  # it has gone
                await loop.connect_accepted_socket(self._made, connection)

    def _makes_room(self, address: str) -> bool:
        """Whether there is a place for one more from this address; if need be, others go."""
        crowd = [one for one in self._open if one.client and one.client[0] == address]
        if len(crowd) < self._room.from_one:
            if len(self._open) < self._room.most:
                return True
            crowd = list(self._open)
        owing = self._owing()
        first = sorted((one for one in crowd if one in owing), key=lambda one: owing[one][0])
        for one in first[
            : 1 + len(first) // 8
        ]:  # some at once: where a thousand come, each is looked through less often
            one.transport.abort()
        return bool(first)

    def _owing(self) -> dict[Any, tuple[float, float]]:
        """Those that owe something: since when, and for how long they may."""
        found = {one: (since_s, STALLED_S) for one, since_s in self._leaving.items() if one in self._open}
        for one in self._open:
            if isinstance(one, Connection) and one not in found and one.owes_s is not None:
                found[one] = one.since_s, one.owes_s
        return found

    def _complain(self, error: OSError) -> None:
        if not self._complained:
            self._complained = True
            _log.warning("no connection can be accepted for now (%s); it is tried again and again", error.strerror)


def _leaves(one: Any) -> bool:
    """Whether it only has to take what is left for it, or, with a websocket, to say goodbye."""
    return one.transport.is_closing() or getattr(one, "close_sent", False)
