"""What memory has no room for, in a file without a name, which the system removes together with the program. [ours]
test_spill_file.py.

Places in it are given out at once; a thread of its own writes, so a slow disk holds nobody up, and what was not written yet
stays in memory. A full disk takes nothing more, and says nothing: what it does not take is thinned.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import msgspec

UNIT = 512  # bytes; places have sizes of whole units, so that one that is free fits another content
LEAVES_FREE = 1_000_000_000  # bytes that are left to others on the disk


class Place(msgspec.Struct, frozen=True, eq=False, gc=False):
    """Where a content lies, and its length in bytes."""

    file: int
    offset: int
    size: int

    def read(self) -> bytes:
        return os.pread(self.file, self.size, self.offset)


class SpillFile:
    """Use it from one thread; what it hands out can be read from any."""

    def __init__(self, folder: Path, budget_bytes: int) -> None:
        """folder: on the disk to use; it need not exist. Where it cannot be made, the file has no room."""
        self.nbytes = 0  # of all places that are taken
        self._budget_bytes, self._folder = budget_bytes, folder
        self._end, self._free = 0, dict[int, list[int]]()  # of the file; offsets by size
        self._refused = budget_bytes <= 0
        self._file = -1
        self._done: deque[Place] = deque()
        self._writer = ThreadPoolExecutor(1, "spill file")

    @property
    def has_room(self) -> bool:
        return not self._refused and self.nbytes < self._budget_bytes

    def put(self, content: bytes) -> Place | None:
        """A place that is written soon: it can be read when `written` has named it. None: there is no room."""
        if not self.has_room or not self._opened():
            return None
        room = _room(len(content))
        free = self._free.get(room)
        if free:
            offset = free.pop()
        else:
            offset, self._end = self._end, self._end + room
        self.nbytes += room
        place = Place(self._file, offset, len(content))
        self._writer.submit(self._write, place, content)
        return place

    def written(self) -> list[Place]:
        """Those that were written since the last call."""
        return [self._done.popleft() for _ in range(len(self._done))]

    def give_back(self, place: Place) -> None:
        """Nobody reads this any more."""
        room = _room(place.size)
        self.nbytes -= room
        self._free.setdefault(room, []).append(place.offset)

    def _opened(self) -> bool:
        if self._file < 0:
            try:
                self._folder.mkdir(parents=True, exist_ok=True)
                file = tempfile.TemporaryFile(dir=self._folder, buffering=0)  # noqa: SIM115 - closed with this object
            except OSError:
                self._refused = True
                return False
            self._file = file.fileno()
            weakref.finalize(self, file.close)
        return True

    def _write(self, place: Place, content: bytes) -> None:
        """In the thread. Contents follow one another as they were put, so a place that is used again holds the later one."""
        if self._refused:
            return
        try:
            is_free = shutil.disk_usage(self._folder).free >= LEAVES_FREE
            self._refused = not is_free or os.pwrite(place.file, content, place.offset) < len(content)
        except OSError:
            self._refused = True
        if not self._refused:
            self._done.append(place)


def _room(size: int) -> int:
    return -(-size // UNIT) * UNIT
