"""How a run grows: views, experiences, links, memory and speed, sampled at regular simulated times."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from pathlib import Path

from app.session import Session

EVERY_S = 300.0  # simulated
_STATM = Path("/proc/self/statm")


@dataclass(frozen=True, slots=True)
class Sample:
    """The size of the brain at one moment, and what it took to come there."""

    at_s: float
    views: int
    experiences: int
    links: int
    view_links: int  # from views to pose cells
    wall_s: float  # since the run began
    rss_mb: float | None  # in use, without what the judge keeps of the run


class Growth:
    """Call `note` after each tick."""

    def __init__(self, session: Session) -> None:
        self._began, self._due_s = time.perf_counter(), session.time_s + EVERY_S
        self.samples: list[Sample] = []
        self._begin_s = session.time_s

    def note(self, session: Session) -> None:
        if session.time_s >= self._due_s - 1e-9:
            self._due_s += EVERY_S
            self.samples.append(self.sample(session))

    def sample(self, session: Session) -> Sample:
        """The session as it is now."""
        brain = session.brain
        views, links = len(brain.local_view), brain.view_links
        return Sample(
            round(session.time_s, 3), views, len(brain.experience_map), brain.experience_map.link_count,
            sum(len(links.of(view)[0]) for view in range(views)), time.perf_counter() - self._began,
            _memory_mb(session.evaluation.memory_bytes),
        )  # fmt: skip

    def speeds(self, samples: list[Sample]) -> list[float]:
        """Simulated seconds a second from each sample before, or from the beginning, to each of these."""
        speeds: list[float] = []
        at_s, wall_s = self._begin_s, 0.0
        for sample in samples:
            speeds.append(round((sample.at_s - at_s) / max(sample.wall_s - wall_s, 1e-9), 1))
            at_s, wall_s = sample.at_s, sample.wall_s
        return speeds


def _memory_mb(judge: int) -> float | None:
    """The memory that this process has in use, without `judge` bytes; None where the system does not tell as Linux does."""
    try:
        pages = int(_STATM.read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):
        return None
    return round((pages * os.sysconf("SC_PAGE_SIZE") - judge) / 1e6, 1)
