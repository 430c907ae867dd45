"""Files of lines that are written while a program may be killed: each line carries a checksum of all lines up to it."""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

from disk.limits import LINE_BYTES, LINE_PARTS, RUN_BYTES

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
