"""Sockets to listen on: at this machine alone, or, for a class, at one address in the local network; never a public one that
nobody named."""

from __future__ import annotations

import asyncio
import socket

import pytest

from web.http import listening
from web.http.listening import CannotListen, class_socket, listening_socket


@pytest.mark.parametrize(
    "host", ["0.0.0.0", "::", "", "0", "*", "192.168.1.1", "example.org", "127.0.0.2", "::ffff:0.0.0.0"]
)
def test_only_loopback(host):
    with pytest.raises(CannotListen, match="localhost or ::1 only"):
        listening_socket(host, 0)


@pytest.mark.parametrize("port", [-1, 65536, 10**9])
def test_a_port_must_exist(port):
    with pytest.raises(CannotListen, match="does not exist"):
        listening_socket("127.0.0.1", port)


def test_small_messages_are_sent_at_once():
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


@pytest.mark.parametrize(
    ("host", "words"),
    [
        ("0.0.0.0", "every address"),
        ("::", "every address"),
        ("", "takes one IP address"),
        ("0", "takes one IP address"),
        ("*", "takes one IP address"),
        ("localhost", "takes one IP address"),
        ("school.example", "takes one IP address"),
        ("::ffff:0.0.0.0", "takes one IP address"),
        ("fe80::1%eth0", "takes one IP address"),
        ("224.0.0.1", "takes one IP address"),
        ("203.0.113.9", "no address of this machine"),
    ],
)
def test_only_one_address_of_this_machine(host, words):
    with pytest.raises(CannotListen, match=words):
        class_socket(host, 0)


def test_a_taken_port_is_a_sentence():
    with class_socket("127.0.0.1", 0) as taken, pytest.raises(CannotListen, match="--class-port"):
        class_socket("127.0.0.1", taken.getsockname()[1])
    with pytest.raises(CannotListen, match="does not exist"):
        class_socket("127.0.0.1", 70_000)


class Probe:
    """A socket of a machine with this address; None: with none."""

    def __init__(self, address: str | None) -> None:
        self.address = address

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def connect(self, _to) -> None:
        if self.address is None:
            raise OSError("network is unreachable")

    def getsockname(self):
        return self.address, 1


@pytest.mark.parametrize(
    ("address", "words"),
    [(None, "in no network"), ("127.0.0.1", "in no network"), ("8.8.8.8", "whole internet; if that is meant")],
)
def test_the_address_is_found_out_and_never_a_public_one(monkeypatch, address, words):
    monkeypatch.setattr(listening.socket, "socket", lambda *_: Probe(address))
    with pytest.raises(CannotListen, match=words):
        listening._in_local_network()


def test_an_address_in_the_local_network_is_taken(monkeypatch):
    monkeypatch.setattr(listening.socket, "socket", lambda *_: Probe("192.168.1.5"))
    assert str(listening._in_local_network()) == "192.168.1.5"
    assert socket.socket(socket.AF_INET) is not None
