"""Parts of a snapshot that cost much are built no more often than people can see them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Generic, TypeVar

REST = 30.0  # times what it cost to build a part is waited before it is built again, however large it has grown
Part = TypeVar("Part")


class Slow(Generic[Part]):
    """A part that costs much: built anew when the session has moved on and the time has come."""

    def __init__(self, every_s: float, build: Callable[[], Part]) -> None:
        self.due = -math.inf
        self._every_s, self._build = every_s, build
        self._built: tuple[int, Part] | None = None

    def refresh(self) -> None:
        """Build it anew when it is asked for next."""
        self.due = -math.inf

    def part(self, tick: int) -> Part:
        began = time.perf_counter()
        if self._built is None or began >= self.due:
            if self._built is None or self._built[0] != tick or self.due == -math.inf:
                self._built = (tick, self._build())
            now = time.perf_counter()
            self.due = now + max(self._every_s, REST * (now - began))
        return self._built[1]
