"""The file of a run that goes on. What a full disk does not take is kept and written later, so that no line is missing."""

from __future__ import annotations

import os
from pathlib import Path
from typing import IO, Any

from app.runs.folder import LINES
from app.runs.lines import line_of, too_much
from disk.locks import lock

MOST_WAITING = 16 << 20  # bytes that wait for a disk that takes nothing


class Journal:
    """Use it from one thread. OSError: the disk took nothing, or a part; the next `add` or `flush` tries again."""

    def __init__(self, folder: Path, size: int = 0, check: int = 0) -> None:
        """size, check: of the whole lines of a run that goes on. ValueError: another program is doing that."""
        folder.mkdir(parents=True, exist_ok=size > 0)
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
