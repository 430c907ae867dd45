"""Goal after goal for hours: what grows, what a tick costs, how true the map stays, and how many goals an hour are reached.

    python -m benchmarks.days living campus --hours 10 --seed 9631

The robot explores for an hour, then is sent to places spread over its map, one after the other, each with the time of the
shortest way at 0.15 m/s and a minute. Bar: from the second hour to the last, nothing changes by more than 10 %.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import psutil

from app.config import Config
from app.protocol.course import Course, run_ticks
from app.protocol.steps import spread_goals
from app.session import Session
from sim2d import load_world, world_names

GOALS = 10  # of one round over the map
SHUT_OUT_M = 100.0  # a way behind a door that is shut counts as so long
NEAR_M = 1.0


@dataclass(frozen=True, slots=True)
class Hour:
    """What is there at its end, and what was done in it."""

    views: int
    experiences: int
    links: int
    memory_mb: float  # of the whole process
    tick_ms: float  # processor time
    error_m: float
    reached: int
    goals: int


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("worlds", nargs="*", default=["office", "living", "campus"], metavar="WORLD")
    parser.add_argument("--hours", type=int, default=10)
    parser.add_argument("--minutes", type=float, default=60.0, help="that an hour lasts, fewer for a quick look")
    parser.add_argument("--seed", type=int, default=9631)
    args = parser.parse_args()
    if unknown := set(args.worlds) - {name for name, _ in world_names()}:
        parser.error(f"no world is called {', '.join(sorted(unknown))}")
    print("world      hour   views  experiences   links   memory     tick      map  goals reached")
    with ProcessPoolExecutor(min(os.cpu_count() or 1, len(args.worlds)), max_tasks_per_child=1) as pool:
        runs = [pool.submit(days, world, args.seed, args.hours, 60 * args.minutes) for world in args.worlds]
        for world, run in zip(args.worlds, runs, strict=True):
            tell(world, run.result())
    return 0


def days(world: str, seed: int, hours: int, hour_s: float) -> list[Hour]:
    session = Session(load_world(world), seed, Config())
    told: list[Hour] = []
    for hour in range(1, hours + 1):
        began, ticks, course = time.process_time(), session.tick_count, Course(session)
        if hour == 1:
            while session.time_s < hour_s:
                session.tick()
        else:
            run_ticks(course, goal_after_goal(course, hour * hour_s))
        map_, visits = session.brain.experience_map, course.visits
        memory_mb, tick_ms = psutil.Process().memory_info().rss / 1e6, 1e3 * (time.process_time() - began)
        now = Hour(
            views=len(session.brain.local_view),
            experiences=len(map_),
            links=map_.link_count,
            memory_mb=memory_mb,
            tick_ms=tick_ms / (session.tick_count - ticks),
            error_m=session.evaluation.errors(map_)[0] or 0.0,
            reached=sum(visit.reached for visit in visits),
            goals=len(visits),
        )
        print(
            f"{world:10s} {hour:4d} {now.views:7d} {now.experiences:12d} {now.links:7d} {now.memory_mb:5.0f} MB"
            f" {now.tick_ms:5.2f} ms {now.error_m:5.2f} m {now.reached:5d} of {now.goals}",
            flush=True,
        )
        told.append(now)
    return told


def goal_after_goal(course: Course, until_s: float) -> Iterator[str]:
    while course.session.time_s < until_s:
        yield from to_places_spread(course, GOALS, until_s)


def to_places_spread(course: Course, goals: int, until_s: float = math.inf) -> Iterator[str]:
    """To places spread over what the robot knows, each with the time of the shortest way at 0.15 m/s and a minute."""
    session = course.session
    for k, goal in enumerate(spread_goals(session, goals)):
        place = session.evaluation.made_at(goal, session.brain.experience_map)
        if session.time_s >= until_s:
            return
        shortest_m = session.simulator.free_space.shortest_m(course.here, place)
        way_m = shortest_m if math.isfinite(shortest_m) else SHUT_OUT_M
        yield from course.go(f"goal {k}", goal, place, way_m / 0.15 + 60, NEAR_M)


def tell(world: str, hours: list[Hour]) -> None:
    if len(hours) > 2:
        second, last = hours[1], hours[-1]
        more = {
            name: 100 * (getattr(last, name) / max(getattr(second, name), 1e-9) - 1)
            for name in ("views", "experiences", "links", "memory_mb", "tick_ms", "error_m", "reached")
        }
        print(
            f"{world}, the last hour against the second: "
            + ", ".join(f"{name} {by:+.0f} %" for name, by in more.items()),
            flush=True,
        )


if __name__ == "__main__":
    raise SystemExit(main())
