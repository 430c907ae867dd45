"""Ticks that were asked for one by one: worked off in their order, so that other commands come between two of them."""

from __future__ import annotations

from collections import deque

from web.messages import Request


class Steps:
    """Who asked for how many more. A request is answered when its ticks are done, or when they are broken off."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[Request, int]] = deque()

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def add(self, request: Request, ticks: int) -> None:
        self._waiting.append((request, ticks))

    def ticked(self) -> list[Request]:
        """One of them is done; the request that is satisfied by it, if one is."""
        request, left = self._waiting.popleft()
        if left > 1:
            self._waiting.appendleft((request, left - 1))
            return []
        return [request]

    def end(self) -> list[Request]:
        """The rest is not wanted any more, or cannot be; all whose requests are open."""
        ended = [request for request, _ in self._waiting]
        self._waiting.clear()
        return ended
