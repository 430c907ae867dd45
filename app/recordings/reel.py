"""The moments of a recording by their numbers, so that any of them can be had again without keeping all of them. [ours]

The papers play a recording once, from its beginning. Going back is ours: test_reel.py.
"""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Iterator

import numpy as np

from app.recordings.recording import Moment, Recording

BUDGET_BYTES = 48_000_000  # of moments that are held, most of it pictures
MOST_CURSORS = 4  # places at which it is being read: the present, the past, and what they are compared with


class Reel:
    """Reads on where it has read before; to go back it reads from the beginning, without unpacking pictures on the way.

    To be used from one thread at a time.
    """

    def __init__(self, recording: Recording, budget_bytes: int = BUDGET_BYTES) -> None:
        self._recording, self._budget_bytes = recording, budget_bytes
        self._cursors: list[_Cursor] = []  # the one that was used last is the last
        self._held: OrderedDict[int, Moment] = OrderedDict()  # the same
        self._held_bytes = 0
        self._times = array("d")  # s, of all moments up to the farthest that was passed
        self._length: int | None = None  # once the end was seen

    @property
    def nbytes(self) -> int:
        """Of the moments that are held."""
        return self._held_bytes

    def has(self, number: int) -> bool:
        """Whether there is a moment of this number. It is read, if nobody has been so far yet."""
        if number < len(self._times):
            return True
        return self._length is None and self._read(number) is not None

    def at(self, number: int) -> Moment:
        """The moment of this number, from 0. ValueError: there is none, or it cannot be read again."""
        moment = self._held.get(number)
        if moment is not None:
            self._held.move_to_end(number)
            return moment
        moment = self._read(number)
        if moment is None:
            raise ValueError(f"{self._recording.about.name}: moment {number} is not there, or not any more")
        return moment

    def number_at(self, time_s: float) -> int:
        """The last moment at or before a time, among those that were passed; 0 before all of them."""
        return max(0, bisect_right(self._times, time_s + 1e-9) - 1)

    # ------------------------------------------------------------ inside

    def _read(self, number: int) -> Moment | None:
        """None: the recording ends before it."""
        cursor = self._cursor_to(number)
        try:
            moment = cursor.read(number, self._times)
        except BaseException:
            self._cursors.remove(cursor)
            raise
        if moment is None:
            self._length = len(self._times)
            self._cursors.remove(cursor)
            return None
        self._hold(number, moment)
        return moment

    def _cursor_to(self, number: int) -> _Cursor:
        """The nearest one before a moment, or a new one at the beginning."""
        before = [cursor for cursor in self._cursors if cursor.next <= number]
        if before:
            cursor = max(before, key=lambda each: each.next)
            self._cursors.remove(cursor)
        else:
            cursor = _Cursor(self._recording)
            if len(self._cursors) == MOST_CURSORS:
                self._cursors.pop(0).close()
        self._cursors.append(cursor)
        return cursor

    def _hold(self, number: int, moment: Moment) -> None:
        self._held[number] = moment
        self._held_bytes += _size(moment)
        while self._held_bytes > self._budget_bytes and len(self._held) > 2:  # a tick needs its own and the next
            _, dropped = self._held.popitem(last=False)
            self._held_bytes -= _size(dropped)


class _Cursor:
    """A place at which a recording is being read."""

    def __init__(self, recording: Recording) -> None:
        self._moments: Iterator[Moment] = recording.moments(lambda number: number >= self._goal)
        self._goal = self.next = 0  # numbers of the moment that is wanted, and of the one that comes next

    def read(self, number: int, times: array[float]) -> Moment | None:
        """Go on to this moment. times: those of all moments that were passed before, to which new ones are added."""
        self._goal = number
        for moment in self._moments:
            if self.next == len(times):
                times.append(moment.time_s)
            self.next += 1
            if self.next > number:
                return moment
        return None

    def close(self) -> None:
        close = getattr(self._moments, "close", None)  # a generator may hold a file open
        if close is not None:
            close()


def _size(moment: Moment) -> int:
    """Bytes."""
    parts = (moment.image, moment.ranges_m)
    return 500 + sum(part.nbytes for part in parts if isinstance(part, np.ndarray))
