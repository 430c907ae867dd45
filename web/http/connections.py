"""Connections at a door: the sockets on which it listens, how many it has room for, and what they may owe.

There is a socket for whoever sits at this machine and, if it was asked for, one for a class in the local network. uvicorn
counts those that ask for something, and waits for the end of a request for ever. asyncio takes whatever comes, until no
descriptor is left, for anybody; then it complains thousands of times a second (cpython 151615). So each door takes its
connections itself, and ends those that keep others waiting.
"""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import logging
import socket
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import h11
import websockets.http11
from uvicorn._types import ASGISendEvent
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.exceptions import InvalidState, SecurityError

from web.http.commands import problem

try:
    import resource
except ImportError:  # a system without such limits
    resource = None


MAX_HEADER_BYTES = 64 * 1024  # of a request, all headers together
websockets.http11.MAX_LINE_LENGTH = MAX_HEADER_BYTES  # read anew for each request; 8 KiB by default
WAITING = 2048  # connections that the system keeps until they are accepted; what it drops comes again after a second

HEADERS_S = 10.0  # for all headers of a request, from the moment when it could begin
STALLED_S = 20.0  # without a byte of a body that is waited for, or without reading a byte of an answer
BACK_OFF_S = 0.5  # after a connection could not be accepted
MOST_DESCRIPTORS = 1024  # of this process, that the places are for
Address = ipaddress.IPv4Address | ipaddress.IPv6Address

_log = logging.getLogger(__name__)


class CannotListen(Exception):  # noqa: N818
    """The address is not available; the message says why and what to do."""


def listening_socket(host: str, port: int) -> socket.socket:
    """A bound socket on a loopback address (port 0: any free one). Raises CannotListen."""
    return _bound(_loopback(host), port, "--port")


def class_socket(host: str | None, port: int) -> socket.socket:
    """A bound socket on one address of this machine; None: that in its local network. Raises CannotListen."""
    return _bound(_own(host) if host is not None else _in_local_network(), port, "--class-port")


def _bound(address: Address, port: int, option: str) -> socket.socket:
    family = socket.AF_INET6 if address.version == 6 else socket.AF_INET
    # asyncio has small messages sent at once only where TCP is named: else each second one waits 40 ms
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((str(address), port))
        listener.listen(WAITING)  # at once: until then a second one could bind the same port
    except OverflowError:
        listener.close()
        reason = f"Port {port} does not exist; take one from 0 (any free one) to 65535 with {option}."
        raise CannotListen(reason) from None
    except OSError as error:
        listener.close()
        raise CannotListen(_why(address, port, option, error)) from None
    return listener


def _why(address: Address, port: int, option: str, error: OSError) -> str:
    if option == "--port" or _is_own(address):
        return f"Port {port} is not free ({error.strerror}). Choose another with {option}, or 0 for any free one."
    return f"{address} is no address of this machine ({error.strerror}); give one of its own with --class-address."


def _is_own(address: Address) -> bool:
    family = socket.AF_INET6 if address.version == 6 else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        try:
            probe.bind((str(address), 0))
        except OSError:
            return False
    return True


def _loopback(host: str) -> Address:
    """The address, which must be this machine's own: 127.0.0.1 or ::1."""
    address = _read("127.0.0.1" if host == "localhost" else host)
    if address is None or str(address) not in ("127.0.0.1", "::1"):
        reason = f"{host!r} would let other machines in; the dashboard listens on 127.0.0.1, localhost or ::1 only."
        raise CannotListen(reason)
    return address


def _own(host: str) -> Address:
    """One address, and no spelling of all addresses."""
    address = _read(host)
    if address is None or "%" in host or address.is_multicast or getattr(address, "ipv4_mapped", None) is not None:
        raise CannotListen(f"--class-address takes one IP address of this machine, as 192.168.1.5; got {host!r}.")
    if address.is_unspecified:
        raise CannotListen(f"{host} stands for every address of this machine; name one of them with --class-address.")
    return address


def _in_local_network() -> Address:
    """The address from which this machine would speak to others. Nothing is sent to find it out."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("198.51.100.1", 9))  # kept for documentation: it is nobody's
            address = ipaddress.ip_address(probe.getsockname()[0])
        except OSError:
            address = None
    if address is None or address.is_loopback or address.is_unspecified:
        reason = "This machine is in no network, so no class can reach it; give --class-address if it is in one."
        raise CannotListen(reason)
    if address.is_global:
        reason = f"{address} can be reached from the whole internet; if that is meant, say --class-address {address}."
        raise CannotListen(reason)
    return address


def _read(host: str) -> Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None


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
    """Accepts connections on one socket, one after the other, in the running loop, and has a number of places of its own.

    They are counted when they are accepted, before they have said anything. Where all places are taken, the one that has owed
    something for longest makes room: the rest of a request, or reading on. One that owes nothing never has to go.
    """

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
        # some at once: where a thousand come, each is looked through less often
        for one in first[: 1 + len(first) // 8]:
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


class WebSocketProtocol(WebSocketsSansIOProtocol):
    """uvicorn's protocol, with an answer to what websockets does not accept as a request: uvicorn leaves its sender waiting for
    ever.

    uvicorn reads a request with h11 and then has websockets read it again, which accepts fewer and shorter headers. Browsers
    send the cookies of every server at this address, whatever its port, so a long header need not be anybody's fault.

    It also completes a refusal: uvicorn takes a request that was answered with a sentence for one that was forgotten. And the
    program may end while a browser is closing a connection.
    """

    def shutdown(self) -> None:
        try:
            super().shutdown()
        except InvalidState:  # the browser's farewell was there first
            self.transport.close()

    async def send(self, message: ASGISendEvent) -> None:
        await super().send(message)
        if message["type"] == "websocket.http.response.body" and not message.get("more_body", False):
            self.handshake_complete = True

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        fault = self.conn.handshake_exc
        if fault is None or self.handshake_initiated or self.transport.is_closing():
            return
        if isinstance(fault.__cause__, SecurityError):
            status = "431 Request Header Fields Too Large"
            reason = (
                f"a websocket's request may have {websockets.http11.MAX_NUM_HEADERS} headers "
                f"of {MAX_HEADER_BYTES} bytes; this one has more"
            )
        else:
            status, reason = "400 Bad Request", "a websocket is asked for with GET and without a body"
        body = problem(reason)
        head = f"HTTP/1.1 {status}\r\nContent-Type: application/json\r\nContent-Length: {len(body)}\r\nConnection: close\r\n\r\n"
        self.transport.write(head.encode() + body)
        self.transport.close()
