"""Hands the newest snapshot from the engine's thread to all readers: one slot, the newest wins."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Latest(Generic[T]):
    """Holds the newest value only. `put` never waits for a reader; `wait` sleeps until something newer is there."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._value: T | None = None
        self._version = 0
        self.waking = "starting"  # what is going on until the first value is there, in words for people

    def put(self, value: T) -> None:
        with self._changed:
            self._value = value
            self._version += 1
            self._changed.notify_all()

    def get(self) -> tuple[int, T | None]:
        """The version (0 before the first `put`) and the value."""
        with self._changed:
            return self._version, self._value

    def wait(self, seen: int, timeout_s: float) -> tuple[int, T | None]:
        """The newest version after `seen`, or the unchanged one when `timeout_s` has passed."""
        with self._changed:
            self._changed.wait_for(lambda: self._version > seen, timeout_s)
            return self._version, self._value
