"""MCAP files, read from the beginning: one that was cut off is read up to its last whole chunk."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Chunk, Footer, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from app.recordings.formats.files import lz4_unpacked, open_whole, zstd_unpacked
from app.recordings.formats.ros_messages import MOST_CHUNK, SONAR_ANGLES, Packet, cdr_of, type_of
from app.recordings.formats.sensed import Problems
from disk.words import plain

BROKEN = (McapError, ValueError, struct.error, EOFError, OSError, OverflowError, MemoryError)
MAGIC = b"\x89MCAP0\r\n"


def mcap_packets(path: Path, problems: Problems) -> Iterator[Packet]:
    """Messages in the order of the file; those that are not of ROS have their encoding in their type, attachments no topic.

    The rest after a fault is a problem.
    """
    schemas: dict[int, Schema] = {}
    channels: dict[int, tuple[Channel, str, str]] = {}
    number = 0
    for record in _records(path, problems):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            schema, encoding = schemas.get(record.schema_id), record.message_encoding
            type_ = "unknown" if schema is None else type_of(schema.name)
            text = "" if schema is None else schema.data.decode(errors="replace")
            if encoding not in ("cdr", "ros1"):
                type_, text = f"{type_} ({plain(encoding, 20)})", ""
            channels[record.id] = record, plain(type_, 100), text
        elif isinstance(record, Attachment):
            yield Packet(plain(record.name, 100), "attachment", False, record.log_time, b"", number)
        elif isinstance(record, Metadata):
            if record.name == "ratslam" and "sonar_angles_rad" in record.metadata:
                yield Packet("ratslam", SONAR_ANGLES, False, 0, record.metadata["sonar_angles_rad"].encode(), number)
        elif isinstance(record, Message):
            number += 1
            try:
                channel, type_, text = channels[record.channel_id]
                data = cdr_of(record.data) if channel.message_encoding == "cdr" else record.data
            except (KeyError, ValueError) as error:
                what = "no channel has told of its topic" if isinstance(error, KeyError) else str(error)
                problems.add("messages left out", f"{path.name}: message {number - 1}", f"left out: {what}")
                continue
            ros1 = channel.message_encoding == "ros1"
            yield Packet(plain(channel.topic, 100), type_, ros1, record.log_time, data, number - 1, text)


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
    except (*BROKEN, RuntimeError) as error:
        problems.add("chunks left out", where, f"left out: {_words(error)}")
        return []


def _data(chunk: Chunk) -> bytes:
    """Unpacked, and never more than the chunk says."""
    if chunk.compression == "zstd":
        return zstd_unpacked(chunk.data, chunk.uncompressed_size)
    if chunk.compression == "lz4":
        return lz4_unpacked(chunk.data, chunk.uncompressed_size)
    if chunk.compression:
        raise ValueError(f"packed by {chunk.compression[:20]!r}; zstd and lz4 are read")
    return chunk.data


def _words(error: BaseException) -> str:
    return plain(str(error), 150) or type(error).__name__
