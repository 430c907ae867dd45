"""What an experiment may have measured beside the scores of every trial: each looks at every tick and gives scores."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from app.trials.course import Course


class Measure(Protocol):
    """Made before the first tick; `note` is called after each."""

    def note(self) -> None: ...

    def scores(self) -> dict[str, float]: ...


class Packets:
    """Competing packets: how many there were at most, and for how long a second one held more than a fifth of the activity."""

    SHARE = 0.2

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._most, self._rival_s = 0, 0.0

    def note(self) -> None:
        packets = self._session.brain.pose_cells.packets
        self._most = max(self._most, len(packets))
        if len(packets) > 1 and packets[1].mass > self.SHARE:
            self._rival_s += self._session.frame.dt

    def scores(self) -> dict[str, float]:
        return {"packets_at_most": float(self._most), "rival_s": self._rival_s}


MEASURES: dict[str, Callable[[Course], Measure]] = {"packets": Packets}
