"""The closed loop without a server, as fast as possible, and its report."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from app.config import Config
from app.session import Session, spread_goals
from disk import encode
from ratslam_core import RatSlam, save_brain
from sim2d import World

GOAL_TIMEOUT_S = 180.0
NEAR_ENOUGH_M = 1.0
LOOK_AFTER = 600  # ticks between two checks of the brain's size


class BrainFile:
    """Where the brain is saved at the end. It is saved after the report, so that a failure does not lose the report."""

    def __init__(self, path: Path) -> None:
        self._path, self._warned = path, False
        self._brain: RatSlam | None = None

    def look(self, brain: RatSlam) -> None:
        """Remember the brain, and warn once if it is becoming too large for a file. Called from time to time."""
        self._brain = brain
        warning = None if self._warned else encode(brain).outgrowing
        if warning is not None:
            self._warned = True
            print(f"ratslam: note: {warning}", file=sys.stderr)

    def save(self) -> None:
        """Save the brain that was passed to `look` last. OSError, ValueError: it cannot be saved."""
        if self._brain is not None:
            save_brain(self._brain, self._path)


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
    progress: Callable[[float, str], None] = lambda _simulated_s, _what: None,
) -> dict[str, Any]:
    """Explore for `minutes` of simulated time, then visit `goals` places. Returns the report as a dict.

    kidnap_at_s: simulated times (s) at which the robot is kidnapped. brain: one that already knows places. brain_file:
    is shown the brain now and then and at the end; the caller saves it. progress: called about once a simulated second
    with the simulated seconds since the last call and what is being done.
    """
    session = Session(world, seed, config, brain)
    ticks = round(minutes * 60 / session.frame.dt)
    kidnaps = sorted(kidnap_at_s)
    started = time.perf_counter()
    for tick in range(ticks):
        while kidnaps and session.time_s >= kidnaps[0] - 1e-9:
            session.kidnap()
            kidnaps.pop(0)
        session.tick()
        if tick % 10 == 9:
            progress(10 * session.frame.dt, "exploring")
        if brain_file is not None and tick % LOOK_AFTER == LOOK_AFTER - 1:
            brain_file.look(session.brain)
    visits: list[dict[str, Any]] = []
    for number, goal in enumerate(spread_goals(session, goals)):
        visits.append(_visit(session, goal, lambda s, n=number: progress(s, f"goal {n + 1} of {goals}")))
    wall = time.perf_counter() - started
    if brain_file is not None:
        brain_file.look(session.brain)
    return _report(session, wall, visits)


def _visit(session: Session, goal: int, progress: Callable[[float], None]) -> dict[str, Any]:
    """Send the robot to an experience. Reached means truly within 1 m of where that experience was made."""
    truth = session.simulator.truth
    made_at = session.evaluation.made_at(goal, session.brain.experience_map)
    shortest = session.simulator.free_space.shortest_m((truth.x, truth.y), made_at)
    began_s, began_m = session.time_s, session.evaluation.path_m
    session.pilot.set_goal(goal)
    while session.pilot.goal_state != (goal, "arrived") and session.time_s - began_s < GOAL_TIMEOUT_S:
        session.tick()
        if session.tick_count % 10 == 0:
            progress(10 * session.frame.dt)
    truth = session.simulator.truth
    miss = math.hypot(truth.x - made_at[0], truth.y - made_at[1])
    return {
        "experience": goal,
        "reached": session.pilot.goal_state == (goal, "arrived") and miss <= NEAR_ENOUGH_M,
        "time_s": round(session.time_s - began_s, 3),
        "path_m": round(session.evaluation.path_m - began_m, 3),
        "shortest_m": _number(shortest),
        "miss_m": _number(miss),
    }


def _report(session: Session, wall: float, visits: list[dict[str, Any]]) -> dict[str, Any]:
    brain, evaluation = session.brain, session.evaluation
    map_error, odometry_error = evaluation.errors(brain.experience_map)
    consistency = evaluation.revisit_consistency
    return {
        "world": session.world.name,
        "seed": session.seed,
        "simulated_s": round(session.time_s, 3),
        "wall_s": round(wall, 3),
        "real_time_factor": round(session.time_s / wall, 1),
        "ticks": session.tick_count,
        "views": len(brain.local_view),
        "false_positives": brain.local_view.false_positives,
        "experiences": len(brain.experience_map),
        "links": brain.experience_map.link_count,
        "relocalisations": brain.relocalisations,
        "error_m": {"map": _number(map_error), "odometry": _number(odometry_error)},
        "revisit_consistency": {"within_half_metre": None if consistency is None else round(consistency, 4)},
        "goals": visits,
        "kidnaps": [
            {
                "at_s": k.at_s,
                "recovered": k.after_s is not None,
                "after_s": _number(k.after_s),
                "after_m": _number(k.after_m),
            }
            for k in evaluation.kidnaps
        ],
        "state_hash": session.state_hash(),
    }


def _number(value: float | None) -> float | None:
    """Rounded to millimetres (or milliseconds); None if not finite, since JSON has no such number."""
    return round(value, 3) if value is not None and math.isfinite(value) else None
