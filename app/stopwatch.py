"""The time that each part of a tick takes. Nothing that the session does depends on it."""

from __future__ import annotations

import time

import numpy as np

KEPT = 100  # ticks that means and worst times are taken over


class Stopwatch:
    """Call `start`, then `lap(part)` after each part, then `finish`. If a part comes twice, its times are added."""

    def __init__(self, parts: tuple[str, ...]) -> None:
        self.parts = parts
        self._row = {part: k for k, part in enumerate(parts)}
        self._kept_s = np.zeros((KEPT, len(parts)))
        self._now_s = [0.0] * len(parts)
        self._ticks = 0
        self._then = time.perf_counter()

    def start(self) -> None:
        """A tick begins, or goes on after an interruption that is not to be counted."""
        self._then = time.perf_counter()

    def lap(self, part: str) -> None:
        now = time.perf_counter()
        self._now_s[self._row[part]] += now - self._then
        self._then = now

    def finish(self) -> None:
        """The tick ends."""
        self._kept_s[self._ticks % KEPT] = self._now_s
        self._now_s = [0.0] * len(self.parts)
        self._ticks += 1

    @property
    def mean_and_worst_ms(self) -> dict[str, tuple[float, float]]:
        """Mean and worst time of each part over the last hundred ticks, in milliseconds."""
        kept = 1e3 * self._kept_s[: min(self._ticks, KEPT)]
        if len(kept) == 0:
            return dict.fromkeys(self.parts, (0.0, 0.0))
        means, worsts = kept.mean(0).tolist(), kept.max(0).tolist()
        return dict(zip(self.parts, zip(means, worsts, strict=True), strict=True))
