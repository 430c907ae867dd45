"""Exploring, then goals: `ratslam headless`."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from app.config import Config
from app.headless.brain_file import BrainFile
from app.headless.loop import Loop, Progress, silent
from app.headless.report import counts, judged, kidnaps, rounded
from app.headless.visiting import Visit, visit
from app.session import Session, spread_goals
from ratslam_core import RatSlam
from sim2d import World

GOAL_TIMEOUT_S = 180.0


def run_headless(
    world: World,
    seed: int,
    minutes: float,
    *,
    config: Config | None = None,
    goals: int = 0,
    kidnap_at_s: Sequence[float] = (),
    brain: RatSlam | None = None,
    brain_file: BrainFile | None = None,
    progress: Progress = silent,
) -> dict[str, Any]:
    """Explore for `minutes` of simulated time, then visit `goals` places. Returns the report as a dict (docs/reports.md).

    kidnap_at_s: simulated times (s) at which the robot is kidnapped. brain: one that already knows places. brain_file:
    is shown the brain now and then and at the end; the caller saves it. progress: called about once a simulated second
    with the simulated seconds since the last call and what is being done.
    """
    session = Session(world, seed, config, brain)
    loop, began = Loop(session, progress, brain_file), time.perf_counter()
    loop.explore(minutes, kidnap_at_s)
    visits: list[dict[str, Any]] = []
    for number, goal in enumerate(spread_goals(session, goals)):
        place = session.evaluation.made_at(goal, session.brain.experience_map)
        visits.append(_told(visit(loop, goal, place, GOAL_TIMEOUT_S, f"goal {number + 1} of {goals}")))
    wall = time.perf_counter() - began
    if brain_file is not None:
        brain_file.look(session.brain)
    return {
        **counts(session, wall),
        **judged(session),
        "uncertainty": loop.uncertainty.report(),
        **_growth(loop),
        "goals": visits,
        "kidnaps": kidnaps(session),
        "state_hash": session.state_hash(),
    }


def _told(visit: Visit) -> dict[str, Any]:
    return {
        "experience": visit.goal,
        "reached": visit.reached,
        "time_s": rounded(visit.time_s),
        "path_m": rounded(visit.path_m),
        "shortest_m": rounded(visit.shortest_m),
        "miss_m": rounded(visit.miss_m),
        "reason": visit.reason,
    }


def _growth(loop: Loop) -> dict[str, Any]:
    """What grew, and apart from it what depends on the machine."""
    samples = loop.growth.samples
    names = ("at_s", "views", "experiences", "links", "view_links")
    return {
        "growth": [{name: getattr(sample, name) for name in names} for sample in samples],
        "real_time_factors": loop.growth.speeds(samples),
        "rss_mb": [sample.rss_mb for sample in samples],
    }
