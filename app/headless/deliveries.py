"""Deliveries: the robot explores, then goes from one goal to the next, as in two weeks of an office in 2010.

Milford, Wyeth, "Persistent Navigation and Mapping using a Biologically Inspired SLAM System", IJRR 29 (2010).
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from app.config import Config
from app.headless.report import EVERY_S, Growth, Sample, counts, judged
from app.protocol.course import Course, Progress, Tagged, Visited, run_ticks
from app.protocol.steps import Explore, Tour
from app.session import Session
from ratslam_core import RatSlam
from sim2d import World

HOUR_S = 3600.0


class Deliveries:
    """A run that can be asked for its report at any time, also when it was interrupted."""

    def __init__(
        self, world: World, seed: int, *, minutes: float, goals: int, deliveries: int, timeout_s: float,
        config: Config | None = None, brain: RatSlam | None = None, progress: Progress | None = None,
    ) -> None:  # fmt: skip
        """minutes: of exploring before. timeout_s: a delivery that takes longer is a failure."""
        self._explore = Explore(minutes=minutes)
        self._tour = Tour(goals=goals, visits=deliveries, timeout_s=timeout_s)
        self._session, self._progress = Session(world, seed, config, brain), progress
        self._course, self._growth = Course(self._session), Growth(self._session)
        self._began, self._explored_s, self._explored_m = time.perf_counter(), 0.0, 0.0

    def carry_out(self) -> None:
        """Explore and deliver. ValueError: the robot has not seen enough to have so many goals."""
        run_ticks(self._course, self._ticks(), [self._growth.note], self._progress)

    def _ticks(self) -> Iterator[str]:
        course, session = self._course, self._session
        yield from self._explore.carry_out(course)
        self._explored_s, self._explored_m = session.time_s, session.evaluation.path_m
        for _ in self._tour.carry_out(course):
            yield f"delivery {len(course.visits) + 1} of {self._tour.visits}, {len(self._failures)} failed"

    @property
    def _failures(self) -> list[Visited]:
        return [visit for visit in self._course.visits if not visit.reached]

    def report(self) -> dict[str, Any]:
        """What has been done so far. docs/reports.md tells what each key means."""
        session, growth, count = self._session, self._growth, len(self._course.visits)
        about = counts(session, time.perf_counter() - self._began)
        now = growth.sample()
        return {
            "deliveries": count,
            "succeeded": count - len(self._failures),
            "metres": about["metres"],
            "simulated_s": about["simulated_s"],
            "failures": [_failure_row(failure) for failure in self._failures],
            "views": now.views,
            "experiences": now.experiences,
            "links": now.links,
            "real_time_factor": about["real_time_factor"],
            "rss_mb": [sample.rss_mb for sample in growth.samples],
            "rss_every_s": EVERY_S,
            "world": about["world"],
            "seed": session.seed,
            "partial": count < self._tour.visits,
            "explored": {"simulated_s": round(self._explored_s, 3), "metres": round(self._explored_m, 3)},
            **judged(session),
            "growth": self._hours(now),
            "goals": [self._goal(tag) for tag in self._course.tags.values()],
            "state_hash": session.state_hash(),
        }  # fmt: skip

    def _goal(self, tag: Tagged) -> dict[str, Any]:
        """One of the places to which is delivered."""
        visits = [visit for visit in self._course.visits if visit.experience == tag.experience]
        failures = sum(not visit.reached for visit in visits)
        return {
            "experience": tag.experience, "x": round(tag.x, 3), "y": round(tag.y, 3), "visits": len(visits),
            "failures": failures,
        }  # fmt: skip

    def _hours(self, now: Sample) -> list[dict[str, Any]]:
        """A row for each full simulated hour, and one for the rest."""
        an_hour = round(HOUR_S / EVERY_S)
        full = self._growth.samples[an_hour - 1 :: an_hour]
        ends = full if full and full[-1].at_s == now.at_s else [*full, now]
        rows: list[dict[str, Any]] = []
        for sample, speed in zip(ends, self._growth.speeds(ends), strict=True):
            rows.append({
                "at_s": sample.at_s, "views": sample.views, "experiences": sample.experiences, "links": sample.links,
                "view_links": sample.view_links, "rss_mb": sample.rss_mb, "real_time_factor": speed,
            })  # fmt: skip
        return rows


def _failure_row(visit: Visited) -> dict[str, Any]:
    return {"at_s": round(visit.began_s, 3), "goal": visit.experience, "reason": visit.why}
