"""Bags of ROS 1, read from the beginning and without their index, so that one that was cut off can be read, too.

[ours] rosbags reads only bags with an index, and keeps that in memory; its writer makes the bags of the tests.
test_recording_ros.py.
"""

from __future__ import annotations

import bz2
import struct
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

from app.recordings.formats.lines import open_whole
from app.recordings.formats.packed import lz4_unpacked
from app.recordings.formats.problems import Problems
from app.recordings.formats.ros_packets import MOST_CHUNK, Packet, type_of
from disk.words import plain

MAGIC = b"#ROSBAG V2.0\n"
_MESSAGE, _CHUNK, _CONNECTION = 2, 5, 7
_BROKEN = (ValueError, struct.error, EOFError, OSError, RuntimeError, KeyError)

Fields = dict[bytes, bytes]


def bag_packets(path: Path, problems: Problems) -> Iterator[Packet]:
    """Messages in the order of the file."""
    connections: dict[int, tuple[str, str, str]] = {}
    number = 0
    for fields, data in _all_records(path, problems):
        try:
            if fields[b"op"][0] == _CONNECTION:
                about = _fields(data)
                topic = plain(fields[b"topic"].decode(errors="replace"), 100)
                type_ = type_of(plain(about[b"type"].decode(errors="replace"), 100))
                definition = about.get(b"message_definition", b"").decode(errors="replace")
                connections[_uint(fields[b"conn"])] = topic, type_, definition
            else:
                number += 1
                topic, type_, definition = connections[_uint(fields[b"conn"])]
                seconds, nanoseconds = struct.unpack("<II", fields[b"time"])
                yield Packet(topic, type_, True, seconds * 10**9 + nanoseconds, data, number - 1, definition)
        except (*_BROKEN, IndexError) as error:
            problems.add(
                "records left out", f"{path.name}: after message {number}", f"a record is left out: {_words(error)}"
            )


def _all_records(path: Path, problems: Problems) -> Iterator[tuple[Fields, bytes]]:
    """Connections and messages, out of chunks and beside them."""
    chunks = 0
    with open_whole(path) as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise ValueError(f"{path.name}: not a bag of ROS 1, version 2.0")
        try:
            for fields, data in _records(file):
                if fields.get(b"op") == bytes([_CHUNK]):
                    yield from _chunk(fields, data, f"{path.name}: chunk {chunks}", problems)
                    chunks += 1
                elif fields.get(b"op") in (bytes([_MESSAGE]), bytes([_CONNECTION])):
                    yield fields, data
        except _BROKEN as error:
            problems.add("the rest of the file", path.name, f"cut off or broken after chunk {chunks}: {_words(error)}")


def _chunk(fields: Fields, data: bytes, where: str, problems: Problems) -> list[tuple[Fields, bytes]]:
    """The records of a chunk, up to the first that is broken."""
    found: list[tuple[Fields, bytes]] = []
    try:
        size = _uint(fields[b"size"])
        if size > MOST_CHUNK:
            raise ValueError(f"{size} bytes unpacked; at most {MOST_CHUNK}")
        packed = fields.get(b"compression", b"none")
        if packed == b"bz2":
            data = bz2.BZ2Decompressor().decompress(data, max_length=size + 1)
        elif packed == b"lz4":
            data = lz4_unpacked(data, size)
        elif packed != b"none":
            raise ValueError(f"packed by {packed[:20]!r}; bz2 and lz4 are read")
        if len(data) > size:
            raise ValueError(f"more than the {size} bytes that it says")
        for fields_, content in _records(BytesIO(data)):
            if fields_.get(b"op") in (bytes([_MESSAGE]), bytes([_CONNECTION])):
                found.append((fields_, content))
    except _BROKEN as error:
        problems.add("chunks left out", where, f"left out from message {len(found)} on: {_words(error)}")
    return found


def _records(file: IO[bytes]) -> Iterator[tuple[Fields, bytes]]:
    while length := file.read(4):
        fields = _fields(_exactly(file, _uint(length)))
        yield fields, _exactly(file, _uint(_exactly(file, 4)))


def _fields(data: bytes) -> Fields:
    """name=value, each with its length before it."""
    fields: Fields = {}
    at = 0
    while at < len(data):
        (size,) = struct.unpack_from("<I", data, at)
        if size > len(data) - at - 4:
            raise ValueError("a field is longer than its record")
        name, _, value = data[at + 4 : at + 4 + size].partition(b"=")
        fields[name] = value
        at += 4 + size
    return fields


def _exactly(file: IO[bytes], size: int) -> bytes:
    if size > MOST_CHUNK:
        raise ValueError(f"a record of {size} bytes; at most {MOST_CHUNK}")
    data = file.read(size)
    if len(data) < size:
        raise EOFError("the file ends within a record")
    return data


def _uint(data: bytes) -> int:
    return int(struct.unpack("<I", data)[0])


def _words(error: BaseException) -> str:
    if isinstance(error, KeyError):
        return f"no field {error}"
    return plain(str(error), 150) or type(error).__name__
