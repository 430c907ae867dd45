"""Sockets to listen on: one for whoever sits at this machine, and, if it was asked for, one for a class in the local network."""

from __future__ import annotations

import ipaddress
import socket

WAITING = 2048  # connections that the system keeps until they are accepted; what it drops comes again after a second
Address = ipaddress.IPv4Address | ipaddress.IPv6Address


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
        raise CannotListen(
            f"Port {port} does not exist; take one from 0 (any free one) to 65535 with {option}."
        ) from None
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
        raise CannotListen(
            "This machine is in no network, so no class can reach it; give --class-address if it is in one."
        )
    if address.is_global:
        reason = f"{address} can be reached from the whole internet; if that is meant, say --class-address {address}."
        raise CannotListen(reason)
    return address


def _read(host: str) -> Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None
