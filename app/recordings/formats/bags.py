"""Bags of ROS 1, read from the beginning and without their index, so that one that was cut off can be read, too.

[ours] rosbags reads only bags with an index, and keeps that in memory; its writer makes the bags of the tests.
test_recording_ros.py.

Bags of ROS 2: a folder with `.db3` or `.mcap` files, or one such file.
"""

from __future__ import annotations

import bz2
import os
import shutil
import sqlite3
import stat
import struct
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, Any, cast
from urllib.parse import quote

import yaml
import zstandard

from app.recordings.formats.files import ZSTD, lz4_unpacked, open_whole
from app.recordings.formats.lying import by_number
from app.recordings.formats.mcap_file import mcap_packets
from app.recordings.formats.ros_messages import MOST_CHUNK, Packet, cdr_of, type_of
from app.recordings.formats.sensed import Problems
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


METADATA = "metadata.yaml"
_BAGS = (".db3", ".mcap", ".db3.zstd", ".mcap.zstd")
_BESIDE = ("-wal", "-journal")  # what SQLite has not yet written into the file itself
_OURS = ("-shm", *_BESIDE)
_MOST_METADATA = 300_000  # bytes
_FREE = 200_000_000  # bytes that are left on the disk of the temporary folder


def has_bag(path: Path) -> bool:
    """Whether it is a file of a bag by its name, or a folder with one."""
    return any(name.endswith(_BAGS) for name in (os.listdir(path) if path.is_dir() else (path.name,)))


class Bag:
    """The files of a bag in their order. Whatever has to be unpacked or put together lies in a folder of our own."""

    def __init__(self, path: Path) -> None:
        """path: a folder, or one file. ValueError: there is no such file in the folder."""
        self._path = path
        self._names = sorted(os.listdir(path), key=by_number) if path.is_dir() else [path.name]
        self._home = path if path.is_dir() else path.parent
        self.files = [self._home / name for name in self._names if name.endswith(_BAGS) or not path.is_dir()]
        if not self.files:
            raise ValueError(f"{path}: a bag of ROS 2 without a .db3 or .mcap file")
        self._copies: TemporaryDirectory[str] | None = None  # goes when nobody can read the bag any more
        self._whole: dict[Path, Path] = {}

    @property
    def names(self) -> set[str]:
        """Files of the folder that belong to the bag."""
        bag = {file.name for file in self.files}
        return bag | {METADATA} | {name + end for name in bag for end in _OURS}

    def packets(self, problems: Problems) -> Iterator[Packet]:
        """Messages of one file after the other."""
        count, whole = 0, True
        for path in self.files:
            try:
                file = self._readable(path)
                mcap = path.name.removesuffix(".zstd").endswith(".mcap")
                for packet in mcap_packets(file, problems) if mcap else db3_packets(file, problems):
                    count += packet.type != "attachment"
                    yield packet
            except (ValueError, OSError) as error:
                if len(self.files) == 1:
                    raise ValueError(str(error)) from None
                problems.add("files left out", self._path.name, f"a file is left out: {error}")
                whole = False
        if whole and self._path.is_dir():
            self._compare(count, problems)

    def _readable(self, path: Path) -> Path:
        """The file, or one of ours that has all of it. ValueError, OSError: there is no room, or it is broken."""
        beside = [part for part in (Path(f"{path}{end}") for end in _BESIDE) if _size(part) > 0]
        packed = _starts(path, ZSTD)
        if path not in self._whole and not packed and not beside:
            return path
        if path not in self._whole:
            self._copies = self._copies or TemporaryDirectory(prefix="ratslam-bag-")
            copy = Path(self._copies.name) / path.name.removesuffix(".zstd")
            if packed:
                _unpack(path, copy)
            else:
                _put_together(path, beside, copy)
            self._whole[path] = copy
        return self._whole[path]

    def _compare(self, count: int, problems: Problems) -> None:
        """With what the recorder says that it wrote."""
        said = _metadata(self._path / METADATA)
        named, there = said.get("relative_file_paths"), {file.name.removesuffix(".zstd") for file in self.files}
        for name in cast(list[Any], named) if isinstance(named, list) else []:
            if isinstance(name, str) and Path(name).name.removesuffix(".zstd") not in there:
                problems.add("files that are missing", METADATA, f"names {plain(name, 100)}, which is not there")
        told = said.get("message_count")
        if isinstance(told, int) and told > count:
            problems.add("messages that are missing", METADATA, f"tells of {told} messages, but there are {count}")


def _metadata(path: Path) -> dict[str, Any]:
    """What rosbag2 wrote beside the bag; empty if it cannot be read."""
    try:
        with open_whole(path) as file:
            text = file.read(_MOST_METADATA + 1)
        if len(text) > _MOST_METADATA:
            return {}
        told: Any = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        told = cast(dict[str, Any], told)["rosbag2_bagfile_information"] if isinstance(told, dict) else None
    except (ValueError, OSError, KeyError, yaml.YAMLError, RecursionError):
        return {}
    return cast(dict[str, Any], told) if isinstance(told, dict) else {}


def _size(path: Path) -> int:
    """Of a regular file; 0: it is none."""
    try:
        about = path.stat()
    except OSError:
        return 0
    return about.st_size if stat.S_ISREG(about.st_mode) else 0


def _starts(path: Path, magic: bytes) -> bool:
    with open_whole(path) as file:
        return file.read(len(magic)) == magic


def _unpack(path: Path, copy: Path) -> None:
    """A file that rosbag2 packed as a whole, as far as there is room for it."""
    with open_whole(path) as file, copy.open("wb") as out:
        try:
            unpacked = cast(IO[bytes], zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True))
            while piece := unpacked.read(1_000_000):
                _require_room(copy.parent, len(piece))
                out.write(piece)
        except zstandard.ZstdError as error:
            raise ValueError(f"{path.name}: cannot be unpacked: {error}") from None


def _put_together(path: Path, beside: list[Path], copy: Path) -> None:
    """The file with all that a recorder that was killed left beside it; SQLite would write into the folder of the bag."""
    _require_room(copy.parent, sum(_size(part) for part in (path, *beside)))
    for part in (path, *beside):
        with open_whole(part) as file, (copy.parent / part.name).open("wb") as out:
            shutil.copyfileobj(file, out)
    try:
        base = sqlite3.connect(copy)
        try:
            base.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()
            base.execute("PRAGMA journal_mode=DELETE").fetchall()
        finally:
            base.close()
    except sqlite3.Error as error:
        raise ValueError(f"{path.name}: cannot be put together with {beside[0].name}: {error}") from None


def _require_room(folder: Path, size: int) -> None:
    free = shutil.disk_usage(folder).free
    if size + _FREE > free:
        raise ValueError(f"{size} bytes would have to be unpacked into {folder.parent}, where only {free} are free")


def db3_packets(path: Path, problems: Problems) -> Iterator[Packet]:
    """Messages in the order in which they were written down."""
    try:
        # Read in one thread after the other, never in two: a kept run is played again before the engine goes on with it.
        where = f"file:{quote(str(path.absolute()))}?mode=ro&immutable=1"
        base = sqlite3.connect(where, uri=True, check_same_thread=False)
    except sqlite3.Error as error:
        raise ValueError(f"{path.name}: cannot be opened: {error}") from None
    number = 0
    try:
        base.text_factory = _text
        base.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MOST_CHUNK)
        topics, definitions = _topics(base), _definitions(base)
        for id_, time, data in base.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id"):
            number += 1
            try:
                if id_ not in topics or not isinstance(time, int) or not isinstance(data, bytes):
                    raise ValueError("no topic, time or data")
                topic, type_ = topics[id_]
                yield Packet(topic, type_, False, time, cdr_of(data), number - 1, definitions.get(type_, ""))
            except ValueError as error:
                problems.add("messages left out", f"{path.name}: message {number - 1}", f"left out: {error}")
    except (sqlite3.Error, sqlite3.Warning, OverflowError, MemoryError) as error:
        problems.add("the rest of the file", path.name, f"cut off or broken after message {number}: {error}")
    finally:
        base.close()


def _topics(base: sqlite3.Connection) -> dict[Any, tuple[str, str]]:
    """By their ids: name and type."""
    return {
        id_: (plain(str(name), 100), type_of(plain(str(type_), 100)))
        for id_, name, type_ in base.execute("SELECT id, name, type FROM topics LIMIT 10000")
    }


def _definitions(base: sqlite3.Connection) -> dict[str, str]:
    """By their types, of bags since ROS 2 Iron."""
    try:
        rows = base.execute("SELECT topic_type, encoded_message_definition FROM message_definitions LIMIT 10000")
        return {type_of(str(type_)): str(text) for type_, text in rows}
    except sqlite3.Error:
        return {}


def _text(data: bytes) -> str:
    return data.decode(errors="replace")
