"""Files of lines that are written while a program may be killed: each line carries a checksum of all lines up to it."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

MOST_BYTES = 64 << 20  # of a file; an hour has less than one MB
LONGEST = 16 << 20  # bytes of a line; the longest holds the text of a world
MOST_COMMAS = 500_000  # of a line; of more, the values would take up to a hundred times the room of their text


@dataclass(frozen=True, slots=True)
class Lines:
    """What could be read. size: bytes up to the end of the last whole line; check: the checksum there.

    damage: what is wrong behind it, as a sentence; empty when nothing is.
    """

    values: list[dict[str, Any]]
    size: int
    check: int
    damage: str


def line_of(value: dict[str, Any], check: int) -> tuple[bytes, int]:
    """A line, and the checksum with it. check: the checksum of the lines before, 0 at the beginning."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=True).encode()
    check = zlib.crc32(text, check)
    return b"%08x %s\n" % (check, text), check


def read_lines(path: Path) -> Lines:
    """All lines up to the first that is not whole. OSError: the file cannot be read. ValueError: it is too large."""
    values: list[dict[str, Any]] = []
    size = check = 0
    with path.open("rb") as file:
        while line := file.readline(LONGEST):
            value, after = _value_of(line, check)
            if value is None:
                return Lines(
                    values, size, check, f"line {len(values) + 1} is cut off or damaged; what follows is left out"
                )
            values.append(value)
            size, check = size + len(line), after
            if size > MOST_BYTES:
                raise ValueError(f"{path}: it has more than {MOST_BYTES >> 20} MiB, which no run has")
    return Lines(values, size, check, "")


def _value_of(line: bytes, check: int) -> tuple[dict[str, Any] | None, int]:
    """The value in a line; None when the line is not as it was written."""
    text = line[9:-1]
    after = zlib.crc32(text, check)
    if line[-1:] != b"\n" or line[:9] != b"%08x " % after or text.count(b",") > MOST_COMMAS:
        return None, check
    try:
        value: object = json.loads(text)
    except (ValueError, RecursionError):
        return None, check
    return (cast("dict[str, Any]", value), after) if isinstance(value, dict) else (None, check)
