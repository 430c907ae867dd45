"""The runs behind the rows: each is made in a process of its own and comes back as its report."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from app.config import Config, Value
from app.headless import Deliveries, run_headless
from app.headless.run import kidnap_times
from sim2d.importers import open_world

GOAL_S, DELIVERY_S = 40.0, 40.0  # about what they take
TIMES_REAL = 80.0  # about how fast a worker is
Report = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One run."""

    row: str
    world: str  # a name, or the path of a plan
    name: str  # the world's, for people
    seed: int
    minutes: float
    scale_m: float | None = None
    variant: str = ""
    goals: int = 0
    kidnaps: int = 0
    deliveries: int = 0
    values: dict[str, Value] = field(default_factory=dict[str, Value])

    @property
    def simulated_s(self) -> float:
        """About how long it is."""
        goals = 0 if self.deliveries else self.goals
        return 60 * self.minutes + GOAL_S * goals + DELIVERY_S * self.deliveries


def run(job: Job) -> Report:
    """The report of a run, with its name, seed and variant. A run that fails says so under "error"."""
    about = {"name": job.name, "seed": job.seed, "variant": job.variant}
    try:
        return {**_report(job), **about, "error": None}
    except Exception as error:  # one that fails must not take the others' figures with it
        return {**about, "error": f"{type(error).__name__}: {error}"}


def _report(job: Job) -> Report:
    config = Config().with_values(job.values)
    world = open_world(job.world, job.scale_m, robot_radius_m=config.robot.robot_radius_m)
    if job.deliveries:
        deliveries = Deliveries(
            world, job.seed, minutes=job.minutes, goals=job.goals, deliveries=job.deliveries, timeout_s=300.0,
            config=config,
        )  # fmt: skip
        deliveries.carry_out()
        return deliveries.report()
    kidnaps = kidnap_times(job.kidnaps, job.minutes, job.seed)
    return run_headless(world, job.seed, job.minutes, config=config, goals=job.goals, kidnap_at_s=kidnaps)


def run_all(jobs: list[Job], workers: int) -> Iterator[tuple[Job, Report]]:
    """Each run as it ends; in order with one worker."""
    if workers == 1:
        for job in jobs:
            yield job, run(job)
        return
    with multiprocessing.get_context("spawn").Pool(workers, maxtasksperchild=1) as pool:
        yield from pool.imap_unordered(_paired, jobs)


def _paired(job: Job) -> tuple[Job, Report]:
    return job, run(job)


def words_of_time(jobs: list[Job], workers: int) -> str:
    """What the runs are, and how long they will take."""
    seconds = sum(job.simulated_s for job in jobs)
    at_least = max((job.simulated_s for job in jobs), default=0.0)  # a run is made by one worker
    wall = max(seconds / workers, at_least) / TIMES_REAL
    took = f"{wall:.0f} s" if wall < 100 else f"{wall / 60:.0f} min" if wall < 6000 else f"{wall / 3600:.1f} h"
    runs = "one run" if len(jobs) == 1 else f"{len(jobs)} runs"
    return f"{runs}, {seconds / 3600:.1f} simulated h: about {took} with {workers} worker{'s' if workers > 1 else ''}"
