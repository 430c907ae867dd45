"""Expensive parts of a snapshot are rebuilt only as often as people can see a change."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Generic, TypeVar

REST = 30.0  # a part is built again only after this many times the time it took to build: a large map costs 3 % at most
Part = TypeVar("Part")


class Slow(Generic[Part]):
    """An expensive part, rebuilt when the session has moved on and enough time has passed."""

    def __init__(self, every_s: float, build: Callable[[], Part]) -> None:
        self.due = -math.inf
        self._every_s, self._build = every_s, build
        self._built: tuple[int, Part] | None = None

    def refresh(self) -> None:
        """Rebuild the part when it is next asked for."""
        self.due = -math.inf

    def part(self, tick: int) -> Part:
        began = time.perf_counter()
        if self._built is None or began >= self.due:
            if self._built is None or self._built[0] != tick or self.due == -math.inf:
                self._built = (tick, self._build())
            now = time.perf_counter()
            self.due = now + max(self._every_s, REST * (now - began))
        return self._built[1]
