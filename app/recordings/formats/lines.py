"""Text files line by line, packed or not, in any encoding that programs write, with a limit for each line and for all."""

from __future__ import annotations

import codecs
import gzip
import io
import os
import stat
import zlib
from collections.abc import Generator
from pathlib import Path
from typing import IO, Any, cast

MOST_LINE, MOST_BYTES = 1_000_000, 4_000_000_000
UNPACKED = 40  # times its size; more is a bomb
_LOOK = 4096  # bytes, to find the encoding
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"), (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip


def open_whole(path: Path) -> IO[bytes]:
    """A regular file, unpacked if its name ends with .gz. ValueError: it is none, or may not be read."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        file = os.fdopen(handle, "rb")
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            file.close()
            raise ValueError(f"{path}: not a file")
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror or error}") from None
    if path.suffix.lower() != ".gz":
        return file
    unpacked = gzip.GzipFile(fileobj=file)
    unpacked.myfileobj = cast(Any, file)  # so that it is closed with it
    return cast(IO[bytes], unpacked)


def encoding_of(start: bytes) -> str:
    """Of a text that begins so: by its mark, by its zeros, UTF-8 where it is that, and else what Windows writes in the west."""
    for mark, name in _MARKS:
        if start.startswith(mark):
            return name
    if start[1:200:2].count(0) * 4 > len(start[1:200]):  # every other byte of Latin text
        return "utf-16-le"
    if start[0:200:2].count(0) * 4 > len(start[:200]):
        return "utf-16-be"
    try:
        codecs.getincrementaldecoder("utf-8")().decode(start)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def lines_of(path: Path) -> Generator[tuple[int, str], None, None]:
    """Number (from 1) and text of each line, without its end: CR, LF or both. ValueError: the file is broken or far too large."""
    total, number = 0, 0
    packed = path.suffix.lower() == ".gz"
    try:
        with open_whole(path) as file:
            start = file.read(_LOOK)
        file = open_whole(path)
    except (OSError, EOFError, zlib.error) as error:
        raise ValueError(f"{path.name}: broken after line 0: {error}") from None
    with io.TextIOWrapper(file, encoding_of(start), errors="replace") as text:
        most = UNPACKED * path.stat().st_size + MOST_LINE if packed else MOST_BYTES
        while True:
            try:
                line = text.readline(MOST_LINE + 1)
            except (OSError, EOFError, zlib.error) as error:
                raise ValueError(f"{path.name}: broken after line {number}: {error}") from None
            if not line:
                return
            number, total = number + 1, total + len(line)
            if packed and total > most:
                raise ValueError(f"{path.name}: unpacks to more than {UNPACKED} times its size; no log of a robot does")
            if len(line) > MOST_LINE or total > most:
                raise ValueError(
                    f"{path.name}: line {number}: too long; at most {MOST_LINE} characters, {MOST_BYTES} in all"
                )
            yield number, line.rstrip("\r\n")
