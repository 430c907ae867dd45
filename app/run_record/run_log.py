"""The file of a run, line by line, written while a program may be killed: each line carries a checksum of all lines up to
it, and what a full disk does not take is kept and written later, so that no line is missing."""

from __future__ import annotations

import base64
import json
import os
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, cast

from app.orders import Order, overtakes
from app.run_record.folder import LINES
from app.run_record.order_rows import require_room, row_of
from disk.limits import LINE_BYTES, LINE_PARTS, RUN_BYTES
from disk.locks import lock

_TEXTS = re.compile(rb'"(?:[^"\\]|\\.)*+"', re.DOTALL)


def line_of(value: dict[str, Any], check: int) -> tuple[bytes, int]:
    """A line, and the checksum with it. check: the checksum of the lines before, 0 at the beginning."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=True).encode()
    check = zlib.crc32(text, check)
    return b"%08x %s\n" % (check, text), check


def parts_of(text: bytes, most: int) -> int:
    """How many commas, lists and objects a JSON text has outside of its texts, each of which takes up to a hundred times its
    room once it is read; exactly only where there are more than `most` with those in texts."""
    count = _signs(text)
    return count if count <= most else _signs(_TEXTS.sub(b"", text))


def _signs(text: bytes) -> int:
    return text.count(b",") + text.count(b"[") + text.count(b"{")


def too_much(line: bytes, size: int) -> str:
    """Why a line is not written, and not read, into a file that then has this size; empty: it may be."""
    if size > RUN_BYTES:
        return f"it has more than {RUN_BYTES >> 20} MiB, and no run may have more"
    if len(line) > LINE_BYTES:
        return f"a line has more than {LINE_BYTES >> 20} MiB, and none may have more"
    if parts_of(line, LINE_PARTS) > LINE_PARTS:
        return f"a line has more than {LINE_PARTS:,} values, and none may have more"
    return ""


class Lines:
    """The values in a file, to be taken one by one and once: all lines up to the first that is not whole.

    size: bytes up to the end of the last whole line so far; check: the checksum there. damage: what is wrong behind it, as a
    sentence; empty when nothing is.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.count, self.size, self.check, self.damage = path, 0, 0, 0, ""

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """OSError: the file cannot be read. ValueError: it is too large."""
        with self.path.open("rb") as file:
            while line := file.readline(LINE_BYTES + 1):
                value, after = _value_of(line, self.check)
                if value is None:
                    self.damage = f"line {self.count + 1} is cut off or damaged; what follows is left out"
                    return
                if self.size + len(line) > RUN_BYTES:
                    raise ValueError(f"{self.path}: {too_much(b'', self.size + len(line))}")
                self.count, self.size, self.check = self.count + 1, self.size + len(line), after
                yield value


def _value_of(line: bytes, check: int) -> tuple[dict[str, Any] | None, int]:
    """The value in a line; None when the line is not as it was written."""
    text = line[9:-1]
    after = zlib.crc32(text, check)
    if line[-1:] != b"\n" or line[:9] != b"%08x " % after or parts_of(text, LINE_PARTS) > LINE_PARTS:
        return None, check
    try:
        value: object = json.loads(text)
    except (ValueError, RecursionError):
        return None, check
    return (cast("dict[str, Any]", value), after) if isinstance(value, dict) else (None, check)


MOST_WAITING = 16 << 20  # bytes that wait for a disk that takes nothing


class LogFile:
    """Use it from one thread. OSError: the disk took nothing, or a part; the next `add` or `flush` tries again."""

    def __init__(self, folder: Path, size: int = 0, check: int = 0) -> None:
        """size, check: of the whole lines of a run that goes on. ValueError: another program is doing that."""
        folder.mkdir(parents=True, exist_ok=True)
        self._path = folder / LINES
        self._file: IO[bytes] = self._path.open("r+b" if size else "xb", buffering=0)
        self._size, self._check, self._waiting = size, check, b""
        locked = lock(self._file)
        self.without_locks = locked is None
        if locked is False:
            self._file.close()
            raise ValueError(f"the run {folder.name} is going on in another program")
        self._file.truncate(size)

    def add(self, value: dict[str, Any]) -> None:
        """ValueError, before anything of it is written: no reader would take such a line, or so long a file."""
        line, check = line_of(value, self._check)
        why = too_much(line, self._size + len(self._waiting) + len(line))
        if why:
            raise ValueError(f"{why}; it is kept up to there")
        self._waiting, self._check = self._waiting + line, check
        self.flush()

    def flush(self) -> None:
        """Write what waits. A full disk takes a part of a line first and fails then; the rest follows when there is room.

        Without locks, the file's age tells other programs that this one goes on.
        """
        try:
            while self._waiting:
                self._file.seek(self._size)
                written = self._file.write(self._waiting) or 0
                self._size, self._waiting = self._size + written, self._waiting[written:]
        except OSError:
            if len(self._waiting) > MOST_WAITING:
                raise ValueError("the disk has taken nothing for too long") from None
            raise
        if self.without_locks:
            os.utime(self._path)

    def close(self) -> None:
        self._file.close()


TICKS_A_LINE = 500  # at most: the ticks since the last flush are one line


class RunLog:
    """The entries of a run as lines: ticks are gathered, and every other line comes behind all ticks up to its own."""

    def __init__(self, file: LogFile, world: str, tick: int = 0, orders: int = 0, edited_bytes: int = 0) -> None:
        """world: as last edited; tick: the last one in the file, which has so many orders and such edits."""
        self._file, self._world, self._tick = file, world, tick
        self._checksums = b""
        self.is_empty = tick == 0
        self._orders, self._edited_bytes = orders, edited_bytes
        self._waiting: Order | None = None  # another may come that does alone what both do

    def tick(self, tick: int, checksum: bytes) -> None:
        try:
            self._settle()
        finally:  # a full disk keeps nothing out of the file: it waits in the log
            self._tick, self._checksums, self.is_empty = tick, self._checksums + checksum, False
        if tick % TICKS_A_LINE == 0:
            self.flush()

    def flush(self) -> None:
        """Write the ticks that wait for their line, and what waits for the disk."""
        try:
            self._ticks()
        finally:
            self._settle()
        self._file.flush()

    def _ticks(self) -> None:
        if self._checksums:
            checksums, self._checksums = base64.b64encode(self._checksums).decode(), b""
            self._file.add({"tick": self._tick, "pulses": checksums})

    def order(self, order: Order) -> None:
        """ValueError: a run has no room for so many."""
        try:
            if self._waiting is not None and not overtakes(order, self._waiting):
                self._settle()
        finally:
            self._waiting, self.is_empty = order, False

    def _settle(self) -> None:
        """The order that waits is one of its own."""
        order, self._waiting = self._waiting, None
        if order is None:
            return
        self._orders += 1
        try:
            require_room(self._orders, self._edited_bytes)
        except ValueError:
            self._ticks()  # the last that can be run again
            raise
        values, edit, self._world = row_of(order, self._world)
        line: dict[str, Any] = {"tick": order.tick, "order": order.name, "values": values}
        if edit is not None:
            self._edited_bytes += len(self._world)
            require_room(self._orders, self._edited_bytes)
            line["edit"] = edit
        self._add(line)

    def hash(self, tick: int, state_hash: str, experiences: int) -> None:
        self._add({"tick": tick, "hash": state_hash, "experiences": experiences})

    def again(self, version: str) -> None:
        """Another program goes on with the run."""
        self._add({"tick": self._tick, "again": version})

    def end(self, why: str) -> None:
        self._add({"tick": self._tick, "end": why})

    def _add(self, line: dict[str, Any]) -> None:
        try:
            self.flush()
        finally:
            self._file.add(line)
