"""Hands the newest snapshot from the engine's thread to all readers, one slot in which the newest wins, and says how often
something may be shown: what is not due yet waits without being forgotten.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
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


class Throttle:
    """Shows its content when that is another object than was shown last, at most `hz` times a second."""

    def __init__(self, hz: float, show: Callable[..., object]) -> None:
        self._period_s, self._show = 1.0 / hz, show
        self._shown: tuple[object, ...] | None = None
        self._next_s = 0.0
        self.count = 0
        self.waiting = False  # the last offer was new and came too early

    def offer(self, now_s: float, *content: object) -> bool:
        """Shows `content` if it is new and due; True when it did."""
        new = not self._same(content)
        self.waiting = new and now_s < self._next_s
        if not new or self.waiting:
            return False
        self._shown = content  # keeping it also keeps its identity from being used again
        self._next_s = now_s + self._period_s * 0.95
        self.count += 1
        self._show(*content)
        return True

    def hurry(self) -> None:
        """The next offer is due, if it is new."""
        self._next_s = 0.0

    def forget(self) -> None:
        """The next offer is shown, whatever it is."""
        self._shown, self._next_s = None, 0.0

    def _same(self, content: tuple[object, ...]) -> bool:
        return self._shown is not None and all(a is b for a, b in zip(content, self._shown, strict=True))
