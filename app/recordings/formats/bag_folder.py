"""Bags of ROS 2: a folder with `.db3` or `.mcap` files, or one such file."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

from app.recordings.formats.image_folder import by_number
from app.recordings.formats.mcap_file import mcap_packets
from app.recordings.formats.problems import Problems, plain
from app.recordings.formats.ros_packets import MOST_CHUNK, Packet, type_of

METADATA = "metadata.yaml"


def bag_files(folder: Path) -> list[Path]:
    """The files of a bag in their order."""
    names = sorted(os.listdir(folder), key=by_number)
    files = [folder / name for name in names if Path(name).suffix in (".db3", ".mcap")]
    if not files:
        raise ValueError(
            f"{folder}: a bag of ROS 2 without a .db3 or .mcap file; packed files (.zstd) have to be unpacked first"
        )
    return files


def folder_packets(folder: Path, problems: Problems) -> Iterator[Packet]:
    """Messages of one file after the other."""
    for path in bag_files(folder):
        try:
            yield from mcap_packets(path, problems) if path.suffix == ".mcap" else db3_packets(path, problems)
        except ValueError as error:
            problems.add("files left out", folder.name, f"a file is left out: {error}")


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
        steps = [0]
        base.set_progress_handler(lambda: _count(steps), 10_000_000)
        topics = {
            id_: (plain(str(name), 100), type_of(str(type_)), False)
            for id_, name, type_ in base.execute("SELECT id, name, type FROM topics LIMIT 10000")
        }
        for id_, time, data in base.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id"):
            if id_ in topics and isinstance(time, int) and isinstance(data, bytes):
                yield Packet(*topics[id_], time, data, number)
            else:
                problems.add("messages left out", f"{path.name}: message {number}", "left out: no topic, time or data")
            number += 1
    except (sqlite3.Error, sqlite3.Warning, OverflowError, MemoryError) as error:
        problems.add("the rest of the file", path.name, f"cut off or broken after message {number}: {error}")
    finally:
        base.close()


def _text(data: bytes) -> str:
    return data.decode(errors="replace")


def _count(steps: list[int]) -> int:
    """Ends a query that goes on for ever, as one of a view that somebody put in the place of a table."""
    steps[0] += 1
    return int(steps[0] > 100_000)
