"""MCAP files, read from the beginning: one that was cut off is read up to its last whole chunk."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import lz4.frame  # pyright: ignore[reportMissingTypeStubs]
import zstandard
from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, Footer, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from app.recordings.formats.lines import open_whole
from app.recordings.formats.problems import Problems, plain
from app.recordings.formats.ros_packets import MOST_CHUNK, SONAR_ANGLES, Packet, type_of

BROKEN = (McapError, ValueError, struct.error, EOFError, OSError, OverflowError, MemoryError)
MAGIC = b"\x89MCAP0\r\n"


def mcap_packets(path: Path, problems: Problems) -> Iterator[Packet]:
    """Messages of ROS 1 and ROS 2 in the order of the file. Others are left out; the rest after a fault is a problem."""
    schemas: dict[int, str] = {}
    channels: dict[int, tuple[str, str, bool] | None] = {}
    number = 0
    for record in _records(path, problems):
        if isinstance(record, Schema):
            schemas[record.id] = type_of(record.name)
        elif isinstance(record, Channel):
            kind = {"cdr": False, "ros1": True}.get(record.message_encoding)
            known = kind is not None and record.schema_id in schemas
            channels[record.id] = (plain(record.topic, 100), schemas[record.schema_id], bool(kind)) if known else None
        elif isinstance(record, Metadata):
            if record.name == "ratslam" and "sonar_angles_rad" in record.metadata:
                yield Packet("ratslam", SONAR_ANGLES, False, 0, record.metadata["sonar_angles_rad"].encode(), number)
        elif isinstance(record, Message):
            channel = channels.get(record.channel_id)
            if channel is not None:
                yield Packet(*channel, record.log_time, record.data, number)
            number += 1


def said_of_run(path: Path) -> dict[str, str]:
    """What a run of ours says of itself before its first message; empty in other recordings."""
    for record in _records(path, Problems()):
        if isinstance(record, Metadata) and record.name == "ratslam":
            return dict(record.metadata)
        if isinstance(record, Message):
            break
    return {}


def _records(path: Path, problems: Problems) -> Iterator[McapRecord]:
    with open_whole(path) as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise ValueError(f"{path.name}: not an MCAP file")
        stream: Any = file
        records = iter(StreamReader(stream, skip_magic=True, emit_chunks=True, record_size_limit=MOST_CHUNK).records)
        chunks = 0
        while True:
            try:
                record = next(records)
            except StopIteration:
                return
            except BROKEN as error:
                problems.add(
                    "the rest of the file", path.name, f"cut off or broken after chunk {chunks}: {_words(error)}"
                )
                return
            if isinstance(record, Chunk):
                yield from _unpacked(record, f"{path.name}: chunk {chunks}", problems)
                chunks += 1
            elif isinstance(record, Footer):
                return
            else:
                yield record


def _unpacked(chunk: Chunk, where: str, problems: Problems) -> list[McapRecord]:
    """The records of a chunk; none if it is broken."""
    try:
        if chunk.uncompressed_size > MOST_CHUNK:
            raise ValueError(f"{chunk.uncompressed_size} bytes unpacked; at most {MOST_CHUNK}")
        data = _data(chunk)
        if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
            raise ValueError("its checksum does not fit")
        return breakup_chunk(replace(chunk, compression="", data=data))
    except (*BROKEN, zstandard.ZstdError, RuntimeError) as error:
        problems.add("chunks left out", where, f"left out: {_words(error)}")
        return []


def _data(chunk: Chunk) -> bytes:
    """Unpacked, and never more than the chunk says."""
    if chunk.compression == "zstd":
        unpacker: Any = zstandard.ZstdDecompressor().decompressobj()
        return _limited(unpacker, chunk)
    if chunk.compression == "lz4":
        return lz4_unpacked(chunk.data, chunk.uncompressed_size)
    if chunk.compression:
        raise ValueError(f"packed by {chunk.compression[:20]!r}; zstd and lz4 are read")
    return chunk.data


def _limited(unpacker: Any, chunk: Chunk) -> bytes:
    """Fed piece by piece, since it has no limit of its own: a piece of 1 kB unpacks to some 16 MB at most."""
    out = bytearray()
    for at in range(0, len(chunk.data), 1024):
        out += unpacker.decompress(chunk.data[at : at + 1024])
        if len(out) > chunk.uncompressed_size:
            raise ValueError(f"more than the {chunk.uncompressed_size} bytes that it says")
        if unpacker.eof:
            break
    return bytes(out)


def lz4_unpacked(data: bytes, most: int) -> bytes:
    """ValueError: it is broken, or unpacks to more than `most` bytes."""
    unpacker: Any = lz4.frame.LZ4FrameDecompressor()
    out: bytes = unpacker.decompress(data, max_length=most + 1)
    if len(out) > most:
        raise ValueError(f"more than the {most} bytes that it says")
    return out


def _words(error: BaseException) -> str:
    return plain(str(error), 150) or type(error).__name__
