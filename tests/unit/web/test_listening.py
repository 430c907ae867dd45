"""Sockets to listen on: at this machine alone, or, for a class, at one address in the local network; never a public one that
nobody named."""

from __future__ import annotations

import asyncio
import socket
from typing import Any

import pytest

from web.http import connections
from web.http.connections import CannotListen, class_socket, listening_socket


def test_where_one_cannot_listen_is_a_sentence(subtests) -> None:
    def refused(open_socket: Any, host: str, port: int, words: str) -> None:
        with subtests.test(door=open_socket.__name__, host=host, port=port), pytest.raises(CannotListen, match=words):
            open_socket(host, port)

    for host in ("0.0.0.0", "::", "", "0", "*", "192.168.1.1", "example.org", "127.0.0.2", "::ffff:0.0.0.0"):
        refused(listening_socket, host, 0, "localhost or ::1 only")
    for port in (-1, 65536, 10**9):
        refused(listening_socket, "127.0.0.1", port, "does not exist")
        refused(class_socket, "127.0.0.1", port, "does not exist")
    for host in ("0.0.0.0", "::"):
        refused(class_socket, host, 0, "every address")
    for host in ("", "0", "*", "localhost", "school.example", "::ffff:0.0.0.0", "fe80::1%eth0", "224.0.0.1"):
        refused(class_socket, host, 0, "takes one IP address")
    refused(class_socket, "203.0.113.9", 0, "no address of this machine")
    with class_socket("127.0.0.1", 0) as taken:
        refused(class_socket, "127.0.0.1", taken.getsockname()[1], "is not free .* --class-port")
        refused(listening_socket, "127.0.0.1", taken.getsockname()[1], "is not free .* --port")


def test_small_messages_are_sent_at_once() -> None:
    """Else the second of two waits for 40 ms, until the browser has confirmed the first."""

    async def is_sent_at_once(listener: socket.socket) -> bool:
        told: asyncio.Future[int] = asyncio.get_running_loop().create_future()

        def met(_: object, writer: asyncio.StreamWriter) -> None:
            told.set_result(writer.get_extra_info("socket").getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
            writer.close()

        async with await asyncio.start_server(met, sock=listener):
            _, writer = await asyncio.open_connection(*listener.getsockname())
            writer.close()
            return bool(await told)

    with listening_socket("localhost", 0) as listener:
        assert asyncio.run(is_sent_at_once(listener))


class Socket:
    """A socket of a machine with this address; None: with none."""

    def __init__(self, address: str | None) -> None:
        self.address, self.bound = address, None

    def __enter__(self) -> Socket:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def connect(self, _to: object) -> None:
        if self.address is None:
            raise OSError("network is unreachable")

    def getsockname(self) -> tuple[str | None, int]:
        return self.address, 1

    def setsockopt(self, *_: object) -> None:
        pass

    def bind(self, at: tuple[str, int]) -> None:
        self.bound = at

    def listen(self, _most: int) -> None:
        pass


def test_the_address_in_the_local_network_is_found_out_and_never_a_public_one(monkeypatch, subtests) -> None:
    for address, words in (
        (None, "in no network"),
        ("127.0.0.1", "in no network"),
        ("0.0.0.0", "in no network"),
        ("8.8.8.8", "whole internet; if that is meant"),
    ):
        monkeypatch.setattr(connections.socket, "socket", lambda *_, address=address: Socket(address))
        with subtests.test(address=address), pytest.raises(CannotListen, match=words):
            class_socket(None, 8001)
    monkeypatch.setattr(connections.socket, "socket", lambda *_: Socket("192.168.1.5"))
    assert class_socket(None, 8001).bound == ("192.168.1.5", 8001)  # type: ignore[attr-defined]
