"""A rate that was measured now and then, and its mean over the time between two moments."""

from __future__ import annotations

HELD_S = 1.0  # so long does the last value hold when no other comes


class Held:
    """Each value is that of the time since the one before. Times never go back."""

    def __init__(self) -> None:
        self._samples: list[tuple[int, float]] = []  # those that may still matter
        self._before: int | None = None  # time of the sample before these

    def add(self, time_ns: int, value: float) -> None:
        if self._samples and time_ns <= self._samples[-1][0]:
            return
        self._samples.append((time_ns, value))

    def mean(self, begin_ns: int, end_ns: int) -> float | None:
        """The mean of (begin, end]; None where nothing was measured. Forgets what lies before the end.

        A value that covers all of it is returned as it is, bit for bit.
        """
        total, covered, pieces = 0.0, 0, set[float]()
        start = begin_ns if self._before is None else max(begin_ns, self._before)
        for time, value in self._samples:
            stop = min(time, end_ns)
            if stop > start:
                total, covered, start = total + value * (stop - start), covered + stop - start, stop
                pieces.add(value)
        if self._samples and start < end_ns:
            time, value = self._samples[-1]
            stop, start = min(end_ns, time + round(HELD_S * 1e9)), max(start, time)
            if stop > start:
                total, covered = total + value * (stop - start), covered + stop - start
                pieces.add(value)
        self._forget(end_ns)
        if not covered:
            return None
        return pieces.pop() if len(pieces) == 1 else total / covered

    def _forget(self, end_ns: int) -> None:
        """Keep the samples after `end_ns` and the last one before, which may have to hold on."""
        while len(self._samples) > 1 and self._samples[0][0] <= end_ns and self._samples[1][0] <= end_ns:
            self._before = self._samples.pop(0)[0]
        if len(self._samples) > 1 and self._samples[0][0] <= end_ns:
            self._before = self._samples.pop(0)[0]
