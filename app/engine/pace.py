"""When the next tick is due, when an order by hand expires, the measured speed. Wall time decides nothing else."""

from __future__ import annotations

import math
import time

PUBLISH_EVERY_S = 1 / 20
PROGRESS_EVERY_S = 1 / 4  # while a trial is run ahead: each look costs the time of some ticks
SLICE_S = 0.05  # of running ahead; commands come in between
HAND_EXPIRES_S = 0.3  # wall time: whoever lets go of a key expects the robot to stop, at any simulated speed
MOST_BEHIND_S = 0.25
LONGEST_WAIT_S = 0.5
MEASURED_OVER_S = 1.0


class Pace:
    """All times are those of `time.perf_counter`."""

    def __init__(self, speed: float) -> None:
        """speed: simulated seconds a second, 0 = as fast as possible."""
        self.speed = speed
        self.factor = 0.0  # measured multiple of real time
        self._due = self._published = 0.0
        self._hand_expires = math.inf
        self._measured = (0.0, 0.0)

    def begin(self) -> None:
        """A run begins."""
        self._hand_expires = math.inf
        self.hurry()

    def hurry(self) -> None:
        """The next tick is due now."""
        self._due = time.perf_counter()

    def wait_s(self) -> float:
        """Seconds until the running session has something to do; negative when it is late."""
        return min(self._due, self._hand_expires) - time.perf_counter()

    def due(self, dt: float) -> bool:
        """Whether a tick of `dt` simulated seconds is due. If so, the next due time is set."""
        now = time.perf_counter()
        if now < self._due:
            return False
        self._due = max(self._due + (dt / self.speed if self.speed > 0 else 0.0), now - MOST_BEHIND_S)
        return True

    def drive(self) -> None:
        """A drive order has come; it holds for HAND_EXPIRES_S."""
        self._hand_expires = time.perf_counter() + HAND_EXPIRES_S

    @property
    def hand_holds(self) -> bool:
        return self._hand_expires < math.inf

    def let_go(self) -> bool:
        """Whether the last drive order has just expired."""
        if time.perf_counter() < self._hand_expires:
            return False
        self._hand_expires = math.inf
        return True

    def measure(self, simulated_s: float) -> None:
        """Measure the multiple of real time; simulated_s: simulated time now."""
        now, (then, before_s) = time.perf_counter(), self._measured
        if now - then >= MEASURED_OVER_S:
            self.factor = max(0.0, simulated_s - before_s) / (now - then) if then else 0.0
            self._measured = now, simulated_s

    def published(self) -> None:
        self._published = time.perf_counter()

    @property
    def progress_due(self) -> bool:
        return time.perf_counter() - self._published >= PROGRESS_EVERY_S

    @property
    def publishing_due(self) -> bool:
        return time.perf_counter() - self._published >= PUBLISH_EVERY_S * 0.98
