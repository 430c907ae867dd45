"""What the reports of runs have in common (docs/reports.md tells what each key means): views, experiences, links, memory and
speed at regular simulated times; and where a run saves its brain."""

from __future__ import annotations

import math
import os
import sys
import time
from array import array
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.evaluation import Coverage, backbone, loops_closed, observations
from app.session import Session
from disk import encode
from ratslam_core import RatSlam, save_brain

# Keys that tell of the machine; all others are the same whenever the same run is made.
MACHINE = ("wall_s", "real_time_factor", "real_time_factors", "rss_mb")
ISLAND_M2 = 4.0  # a loop leads round an island that is at least this large; desks are none


def counts(session: Session, wall_s: float) -> dict[str, Any]:
    """World, length and size of a run."""
    return {
        "world": session.world.name,
        "seed": session.seed,
        "simulated_s": round(session.time_s, 3),
        "wall_s": round(wall_s, 3),
        "real_time_factor": round(session.time_s / max(wall_s, 1e-9), 1),
        "ticks": session.tick_count,
        "metres": round(session.evaluation.path_m, 3),
        **size(session.brain),
    }


def size(brain: RatSlam) -> dict[str, Any]:
    """What a brain has learnt."""
    return {
        "views": len(brain.local_view),
        "false_positives": brain.local_view.false_positives,
        "experiences": len(brain.experience_map),
        "links": brain.experience_map.link_count,
        "view_links": brain.view_links.count,
        "let_go": {**brain.experience_map.ground.let_go, "view_links": brain.view_links.forgotten},
        "relocalisations": brain.relocalisations,
    }


def judged(session: Session) -> dict[str, Any]:
    """The map compared with the truth."""
    evaluation, map_ = session.evaluation, session.brain.experience_map
    map_error, odometry_error = evaluation.errors(map_)
    consistency = evaluation.revisit_consistency
    births = evaluation.births(len(map_))
    found, floor = observations(map_, births), session.simulator.free_space
    islands, true = floor.islands(ISLAND_M2), found.ends[~found.false]
    return {
        "error_m": {"map": rounded(map_error), "odometry": rounded(odometry_error)},
        "revisit_consistency": {"within_half_metre": None if consistency is None else round(consistency, 4)},
        "revisit_share": round(evaluation.revisit_share, 4),
        "looks": {
            "all": len(found.ends),
            "false": int(found.false.sum()),
            "false_believed": int((found.false & found.believed).sum()),
            "odometry_false": int(backbone(map_, births).false.sum()),
        },
        "coverage": round(Coverage().follow(floor, evaluation.path), 4),
        "loops": {
            "closed": loops_closed(true, births, evaluation.path, islands, session.frame.dt),
            "of": len(islands),
        },
    }


def kidnaps(session: Session) -> list[dict[str, Any]]:
    """Each kidnap: whether and when the robot knew again where it was, and when it first met ground that it knew."""
    return [
        {
            "at_s": k.at_s,
            "recovered": k.after_s is not None,
            "after_s": rounded(k.after_s),
            "after_m": rounded(k.after_m),
            "met_s": rounded(k.met_s),
        }
        for k in session.evaluation.kidnaps
    ]


def rounded(value: float | None) -> float | None:
    """Rounded to millimetres (or milliseconds); None if not finite, since JSON has no such number."""
    return round(value, 3) if value is not None and math.isfinite(value) else None


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
        self._session = session
        self._began, self._due_s = time.perf_counter(), session.time_s + EVERY_S
        self.samples: list[Sample] = []
        self._begin_s = session.time_s

    def note(self) -> None:
        if self._session.time_s >= self._due_s - 1e-9:
            self._due_s += EVERY_S
            self.samples.append(self.sample())

    def sample(self) -> Sample:
        """The session as it is now."""
        session, brain = self._session, self._session.brain
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


class Uncertainty:
    """How sure the robot is of its place, and whether it is right to be. Call `note` after each tick."""

    EVERY = 10  # ticks

    def __init__(self, session: Session) -> None:
        self._session = session
        self._sigma_m, self._off_m = array("d"), array("d")
        self._ticks = self._lost = 0

    def note(self) -> None:
        session = self._session
        self._ticks += 1
        self._lost += session.brain.lost
        sigma_m = session.brain.experience_map.off_m
        if not math.isfinite(sigma_m) or session.brain.carried or session.tick_count % self.EVERY:
            return
        self._sigma_m.append(sigma_m)
        self._off_m.append(session.evaluation.belief_off(session.simulator.truth, session.brain.experience_map)[0])

    def report(self) -> dict[str, Any]:
        """The robot's own sigma (m) while it was not lost, and the share of the time in which it was right to two
        sigma; None without a belief that has one. And the share of the ticks in which the robot was lost."""
        sigma, off = np.array(self._sigma_m), np.array(self._off_m)
        judged = np.isfinite(off)
        right = float(np.mean(off[judged] <= 2 * sigma[judged])) if judged.any() else math.nan
        return {
            "median_m": _share(float(np.median(sigma))) if sigma.size else None,
            "most_m": _share(float(sigma.max())) if sigma.size else None,
            "within_two_sigma": _share(right),
            "lost_share": _share(self._lost / max(self._ticks, 1)),
        }


def _share(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None


class BrainFile:
    """Where the brain is saved at the end. It is saved after the report, so that a failure does not lose the report."""

    LOOK_AFTER = 600  # ticks

    def __init__(self, path: Path) -> None:
        self._path, self._warned = path, False
        self._brain: RatSlam | None = None

    def note(self, session: Session) -> None:
        """To be called after each tick."""
        if session.tick_count % self.LOOK_AFTER == 0:
            self.look(session.brain)

    def look(self, brain: RatSlam) -> None:
        """Remember the brain, and warn once if it is becoming too large for a file."""
        self._brain = brain
        warning = None if self._warned else encode(brain).outgrowing
        if warning is not None:
            self._warned = True
            print(f"ratslam: note: {warning}", file=sys.stderr)

    def save(self) -> None:
        """Save the brain that was passed to `look` last. OSError, ValueError: it cannot be saved."""
        if self._brain is not None:
            save_brain(self._brain, self._path)
