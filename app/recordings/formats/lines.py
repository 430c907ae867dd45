"""Text files line by line, packed or not, with a limit for each line and for all."""

from __future__ import annotations

import gzip
import os
import stat
import zlib
from collections.abc import Generator
from pathlib import Path
from typing import IO, cast

MOST_LINE, MOST_BYTES = 4_000_000, 4_000_000_000


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
    return cast(IO[bytes], gzip.GzipFile(fileobj=file)) if path.suffix.lower() == ".gz" else file


def lines_of(path: Path) -> Generator[tuple[int, str], None, None]:
    """Number (from 1) and text of each line, without its end. ValueError: the file is broken or far too large."""
    total, number = 0, 0
    with open_whole(path) as file:
        while True:
            try:
                line = file.readline(MOST_LINE + 1)
            except (OSError, EOFError, zlib.error) as error:
                raise ValueError(f"{path.name}: broken after line {number}: {error}") from None
            if not line:
                return
            number, total = number + 1, total + len(line)
            if len(line) > MOST_LINE or total > MOST_BYTES:
                raise ValueError(
                    f"{path.name}: line {number}: too long; at most {MOST_LINE} characters, {MOST_BYTES} in all"
                )
            yield number, line.decode("utf-8-sig" if number == 1 else "utf-8", errors="replace").rstrip("\r\n")
