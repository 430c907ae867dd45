"""`ratslam headless`: exploring, with kidnaps by chance if they are wanted, then goals."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from app.config import Config
from app.headless.report import BrainFile, Growth, Uncertainty, counts, judged, kidnaps, rounded
from app.protocol.course import Course, Progress, Visited, run_ticks
from app.protocol.steps import Explore, spread_goals
from app.session import Session
from ratslam_core import RatSlam
from sim2d import World

EARLY_S = 300.0  # a third of the kidnaps come before, when much is still unknown
FIRST_S = 20.0  # a robot that has only just begun has no place to find again
REST_S = 240.0  # at least so long it has to find itself, if the time allows it
_STREAM = 3  # of the run's seed; session.py and protocol/steps.py use others


def kidnap_times(count: int, minutes: float, seed: int) -> list[float]:
    """`count` times (s) within the first `minutes`, a third of them (rounded up) in the first five. Same seed, same times.

    After each the robot has four minutes until the next, or less where so many do not fit. ValueError: no time at all.
    """
    end_s = minutes * 60
    if count == 0:
        return []
    if end_s <= 2 * FIRST_S:
        raise ValueError(f"{minutes:g} minutes are too short for a kidnap; explore for one minute at least")
    rng = np.random.default_rng([seed, _STREAM])
    early = -(-count // 3)
    split_s = min(EARLY_S, end_s * early / count)
    late, rest_s = count - early, _rest(count - early, end_s - split_s)
    return _apart(early, FIRST_S, split_s, rng) + _apart(late, split_s + rest_s, end_s - rest_s, rng)


def _apart(count: int, begin_s: float, end_s: float, rng: np.random.Generator) -> list[float]:
    """So many times from begin to end with a rest between any two."""
    if count == 0:
        return []
    rest_s = _rest(count, end_s - begin_s)
    drawn = np.sort(rng.uniform(begin_s, end_s - (count - 1) * rest_s, count))
    return [round(float(at), 1) for at in drawn + rest_s * np.arange(count)]


def _rest(count: int, within_s: float) -> float:
    return min(REST_S, within_s / (count + 2))


NEAR_ENOUGH_M = 1.0
GOAL_SPEED, GOAL_PATIENCE_S = 0.15, 60.0  # it is given up after the shortest way at this speed (m/s), and so much more
GOAL_MOST_M = 300.0  # of that way: where there is none, it is endless


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
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Explore for `minutes` of simulated time, then visit `goals` places. Returns the report as a dict (docs/reports.md).

    kidnap_at_s: simulated times (s) at which the robot is kidnapped. brain: one that already knows places. brain_file:
    is shown the brain now and then and at the end; the caller saves it. progress: called about once a simulated second
    with the simulated seconds since the last call and what is being done.
    """
    session = Session(world, seed, config, brain)
    course, began = Course(session), time.perf_counter()
    growth, uncertainty = Growth(session), Uncertainty(session)
    watchers: list[Callable[[], object]] = [growth.note, uncertainty.note]
    if brain_file is not None:
        watchers.append(lambda: brain_file.note(session))
    run_ticks(course, _ticks(course, minutes, kidnap_at_s, goals), watchers, progress)
    wall = time.perf_counter() - began
    if brain_file is not None:
        brain_file.look(session.brain)
    return {
        **counts(session, wall),
        **judged(session),
        "uncertainty": uncertainty.report(),
        **_growth(growth),
        "goals": [_visit_row(visit) for visit in course.visits],
        "kidnaps": kidnaps(session),
        "state_hash": session.state_hash(),
    }


def _ticks(course: Course, minutes: float, kidnap_at_s: Sequence[float], goals: int) -> Iterator[str]:
    """The protocol: what is being done, before each tick."""
    session, due = course.session, sorted(kidnap_at_s)
    for what in Explore(minutes=minutes).carry_out(course) if minutes else ():
        while due and session.time_s >= due[0] - 1e-9:
            session.kidnap()
            due.pop(0)
        yield what
    for number, goal in enumerate(spread_goals(session, goals), start=1):
        place = session.evaluation.made_at(goal, session.brain.experience_map)
        way_m = min(session.simulator.free_space.shortest_m(course.here, place), GOAL_MOST_M)
        limit_s = round(way_m / GOAL_SPEED + GOAL_PATIENCE_S, 1)
        yield from course.go(f"goal {number} of {goals}", goal, place, limit_s, NEAR_ENOUGH_M)


def _visit_row(visit: Visited) -> dict[str, Any]:
    return {
        "experience": visit.experience,
        "reached": visit.reached,
        "time_s": rounded(visit.time_s),
        "path_m": rounded(visit.path_m),
        "shortest_m": rounded(visit.shortest_m),
        "miss_m": rounded(visit.miss_m),
        "reason": visit.why,
    }


def _growth(growth: Growth) -> dict[str, Any]:
    """What grew, and apart from it what depends on the machine."""
    names = ("at_s", "views", "experiences", "links", "view_links")
    return {
        "growth": [{name: getattr(sample, name) for name in names} for sample in growth.samples],
        "real_time_factors": growth.speeds(growth.samples),
        "rss_mb": [sample.rss_mb for sample in growth.samples],
    }
