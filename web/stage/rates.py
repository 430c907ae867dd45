"""How often each layer may be drawn: newest wins, and what is not due waits without being forgotten."""

from __future__ import annotations

from collections.abc import Callable


class Layer:
    """Draws its content when that is another object than the last drawn, at most `hz` times a second."""

    def __init__(self, hz: float, draw: Callable[..., object]) -> None:
        self._period_s, self._draw = 1.0 / hz, draw
        self._drawn: tuple[object, ...] | None = None
        self._next_s = 0.0
        self.draws = 0

    def offer(self, now_s: float, *content: object) -> bool:
        """Draws `content` if it is new and due; True when it drew."""
        if now_s < self._next_s or self._same(content):
            return False
        self._drawn = content  # keeping it also keeps its identity from being used again
        self._next_s = now_s + self._period_s * 0.95
        self.draws += 1
        self._draw(*content)
        return True

    def forget(self) -> None:
        """The next offer is drawn, whatever it is."""
        self._drawn, self._next_s = None, 0.0

    def _same(self, content: tuple[object, ...]) -> bool:
        return self._drawn is not None and all(a is b for a, b in zip(content, self._drawn, strict=True))
