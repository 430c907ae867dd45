"""Ticks that were asked for by number. They are worked off one by one, so that other commands come in between."""

from __future__ import annotations

from collections import deque

from web.messages import Request


class Steps:
    """The requests that wait for ticks. A request is answered when its ticks are done or broken off."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[Request, int]] = deque()

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def add(self, request: Request, ticks: int) -> None:
        self._waiting.append((request, ticks))

    def ticked(self) -> list[Request]:
        """One tick is done. Returns the request that this completes, if any."""
        request, left = self._waiting.popleft()
        if left > 1:
            self._waiting.appendleft((request, left - 1))
            return []
        return [request]

    def end(self) -> list[Request]:
        """Drop all remaining ticks. Returns the requests that still waited for them."""
        ended = [request for request, _ in self._waiting]
        self._waiting.clear()
        return ended
