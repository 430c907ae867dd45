"""Deliveries: the robot explores, then goes from one goal to the next, as in two weeks of an office in 2010.

Milford, Wyeth, "Persistent Navigation and Mapping using a Biologically Inspired SLAM System", IJRR 29 (2010).
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

from app.config import Config
from app.headless.loop import Loop, Progress, Visit, silent, visit
from app.headless.report import EVERY_S, Sample, counts, judged
from app.session import Session, spread_goals
from app.trials.steps import order
from ratslam_core import RatSlam
from sim2d import World

HOUR_S = 3600.0


@dataclass(slots=True)
class Goal:
    """One of the places to which is delivered."""

    experience: int
    place: tuple[float, float]  # where it was made (m, office frame)
    visits: int = 0
    failures: int = 0


class Deliveries:
    """A run that can be asked for its report at any time, also when it was interrupted."""

    def __init__(
        self, world: World, seed: int, *, minutes: float, goals: int, deliveries: int, timeout_s: float,
        config: Config | None = None, brain: RatSlam | None = None, progress: Progress = silent,
    ) -> None:  # fmt: skip
        """minutes: of exploring before. timeout_s: a delivery that takes longer is a failure."""
        self._minutes, self._wanted, self._asked, self._timeout_s = minutes, goals, deliveries, timeout_s
        self._session = Session(world, seed, config, brain)
        self._loop, self._began = Loop(self._session, progress), time.perf_counter()
        self._goals: list[Goal] = []
        self._failures: list[Visit] = []
        self._count, self._explored_s, self._explored_m = 0, 0.0, 0.0

    def carry_out(self) -> None:
        """Explore and deliver. ValueError: the robot has not seen enough to have so many goals."""
        session = self._session
        self._loop.explore(self._minutes)
        self._explored_s, self._explored_m = session.time_s, session.evaluation.path_m
        self._goals = self._spread()
        for number in order(self._wanted, self._asked, session.seed):
            goal, failed = self._goals[number], len(self._failures)
            what = f"delivery {self._count + 1} of {self._asked}, {failed} failed"
            done = visit(self._loop, goal.experience, goal.place, self._timeout_s, what)
            self._count += 1
            goal.visits += 1
            if not done.reached:
                goal.failures += 1
                self._failures.append(done)

    def _spread(self) -> list[Goal]:
        session = self._session
        chosen = spread_goals(session, self._wanted)
        if len(chosen) < self._wanted:
            raise ValueError(
                f"--goals {self._wanted}: after {self._minutes:g} minutes the robot knows only {len(chosen)} places; "
                "let it explore longer (--minutes)"
            )
        map_ = session.brain.experience_map
        return [Goal(experience, session.evaluation.made_at(experience, map_)) for experience in chosen]

    def report(self) -> dict[str, Any]:
        """What has been done so far. docs/reports.md tells what each key means."""
        session, growth = self._session, self._loop.growth
        about = counts(session, time.perf_counter() - self._began)
        now = growth.sample(session)
        return {
            "deliveries": self._count,
            "succeeded": self._count - len(self._failures),
            "metres": about["metres"],
            "simulated_s": about["simulated_s"],
            "failures": [_told(failure) for failure in self._failures],
            "views": now.views,
            "experiences": now.experiences,
            "links": now.links,
            "real_time_factor": about["real_time_factor"],
            "rss_mb": [sample.rss_mb for sample in growth.samples],
            "rss_every_s": EVERY_S,
            "world": about["world"],
            "seed": session.seed,
            "partial": self._count < self._asked,
            "explored": {"simulated_s": round(self._explored_s, 3), "metres": round(self._explored_m, 3)},
            **judged(session),
            "growth": self._hours(now),
            "goals": [
                {"experience": g.experience, "x": round(g.place[0], 3), "y": round(g.place[1], 3), "visits": g.visits,
                 "failures": g.failures}
                for g in self._goals
            ],
            "state_hash": session.state_hash(),
        }  # fmt: skip

    def _hours(self, now: Sample) -> list[dict[str, Any]]:
        """A row for each full simulated hour, and one for the rest."""
        an_hour = round(HOUR_S / EVERY_S)
        full = self._loop.growth.samples[an_hour - 1 :: an_hour]
        ends = full if full and full[-1].at_s == now.at_s else [*full, now]
        rows: list[dict[str, Any]] = []
        for sample, speed in zip(ends, self._loop.growth.speeds(ends), strict=True):
            rows.append({
                "at_s": sample.at_s, "views": sample.views, "experiences": sample.experiences, "links": sample.links,
                "view_links": sample.view_links, "rss_mb": sample.rss_mb, "real_time_factor": speed,
            })  # fmt: skip
        return rows


def _told(visit: Visit) -> dict[str, Any]:
    return {"at_s": round(visit.began_s, 3), "goal": visit.goal, "reason": visit.reason}
