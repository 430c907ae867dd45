"""Exploring against what is possible: `python -m benchmarks.exploring [WORLD ...] [--minutes 60] [--seeds 9101 9102 9103]`.
Bar: 0.7 of the oracle's coverage in the mean, none below 0.5; nine loops in ten closed of those that the way went round.
With `--goals 10` the robot is then sent to so many places spread over what it knows; bar: 49 of 50.

The oracle knows its pose and the walls. It drives at 0.25 m/s on a grid of 0.25 m to the nearest floor that is not covered yet:
within 1 m of its path, as for the robot. WORLD: a name or a file; without, ten worlds and the real plans that are there.
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from heapq import heappop, heappush
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.config import Config
from app.evaluation.agreement import Coverage, loops_gone_round
from app.headless.report import ISLAND_M2, judged
from app.protocol.course import Course, run_ticks
from app.session import Session
from benchmarks.days import to_places_spread
from benchmarks.true_map.rows import PLANS, WORLDS
from sim2d import FreeSpace
from sim2d.importers import open_world

SPEED, CELL_M, NEAR_M = 0.25, 0.25, 1.0  # of the oracle: m/s, its grid, and how near to its path floor is covered
AT_MIN = (5, 15, 30, 60, 120, 300, 600)
BAR, LEAST, GOALS_BAR = 0.7, 0.5, 0.98
DIAGONAL = 2**0.5
_MOVES = tuple((dy, dx, DIAGONAL if dy and dx else 1.0) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dy or dx)

_Cells = NDArray[np.bool_]


class Oracle:
    """Drives over the cells of a floor, and says which share of them it has covered."""

    def __init__(self, floor: FreeSpace) -> None:
        self._floor = floor.coarse(CELL_M)
        self._covered: _Cells = np.zeros_like(self._floor)
        start = floor.world.starts[0]
        rows, columns = np.nonzero(self._floor)
        x0, y0 = floor.world.bounds[:2]
        off = np.hypot((columns + 0.5) * CELL_M + x0 - start.x, (rows + 0.5) * CELL_M + y0 - start.y)
        nearest = int(np.argmin(off))
        self._at, self.metres = (int(rows[nearest]), int(columns[nearest])), 0.0
        self._cover()

    @property
    def share(self) -> float:
        return float(self._covered.sum() / self._floor.sum())

    def drive(self, metres: float) -> None:
        """On, until so many metres are behind it or all is covered."""
        while self.metres < metres:
            way = self._way_to_the_nearest()
            if not way:
                return
            for cell in way:
                self.metres += CELL_M * (DIAGONAL if cell[0] != self._at[0] and cell[1] != self._at[1] else 1.0)
                self._at = cell
                self._cover()
                if self.metres >= metres:
                    return

    def _cover(self) -> None:
        n = int(NEAR_M / CELL_M)
        (y, x), (height, width) = self._at, self._floor.shape
        for row in range(max(0, y - n), min(height, y + n + 1)):
            half = int((n * n - (row - y) ** 2) ** 0.5)
            across = slice(max(0, x - half), min(width, x + half + 1))
            self._covered[row, across] = self._floor[row, across]

    def _way_to_the_nearest(self) -> list[tuple[int, int]]:
        """Cells from here to the nearest that is not covered, without this one; none when all are."""
        away, before, queue = {self._at: 0.0}, dict[tuple[int, int], tuple[int, int]](), [(0.0, self._at)]
        while queue:
            cost, cell = heappop(queue)
            if cost > away[cell]:
                continue
            if not self._covered[cell]:
                way = [cell]
                while way[-1] in before:
                    way.append(before[way[-1]])
                return way[-2::-1]
            for dy, dx, step in _MOVES:
                there = cell[0] + dy, cell[1] + dx
                inside = 0 <= there[0] < self._floor.shape[0] and 0 <= there[1] < self._floor.shape[1]
                if inside and self._floor[there] and cost + step < away.get(there, np.inf):
                    away[there], before[there] = cost + step, cell
                    heappush(queue, (cost + step, there))
        return []


@dataclass(frozen=True, slots=True)
class Explored:
    """One run: shares of the floor at each time, the robot's and the oracle's."""

    name: str
    seed: int
    shares: dict[float, tuple[float, float]]  # by minutes
    closed: int
    round: int
    map_m: float | None
    missed_m: tuple[float, ...]  # how far from each goal the robot stayed that it missed
    goals: int

    @property
    def ratio(self) -> float:
        ours, oracle = list(self.shares.values())[-1]
        return ours / oracle

    def __str__(self) -> str:
        times = ", ".join(f"{m:g} min {ours:.0%} of {oracle:.0%}" for m, (ours, oracle) in self.shares.items())
        return (
            f"{self.name} {self.seed}: {times}: {self.ratio:.2f}; loops {self.closed} of {self.round} gone round; "
            f"map {self.map_m} m"
            + (f"; {self.reached} of {self.goals} goals" if self.goals else "")
            + (f", missed by {', '.join(f'{m:.1f}' for m in self.missed_m)} m" if self.missed_m else "")
        )

    @property
    def reached(self) -> int:
        return self.goals - len(self.missed_m)


def explore(job: tuple[str, str, float | None, int, float, int]) -> Explored:
    name, file, scale_m, seed, minutes, goals = job
    config = Config()
    session = Session(open_world(file, scale_m, robot_radius_m=config.robot.robot_radius_m), seed, config)
    floor, coverage = session.simulator.free_space, Coverage()
    oracle, shares = Oracle(floor), dict[float, tuple[float, float]]()
    for at in (*(m for m in AT_MIN if m < minutes), minutes):
        while session.time_s < 60 * at:
            session.tick()
        oracle.drive(60 * at * SPEED)
        shares[at] = coverage.follow(floor, session.evaluation.path), oracle.share
    found = judged(session)
    went_round = loops_gone_round(session.evaluation.path, floor.islands(ISLAND_M2), session.frame.dt)
    course = Course(session)
    run_ticks(course, to_places_spread(course, goals))
    missed_m = tuple(float(visit.miss_m) for visit in course.visits if not visit.reached)
    closed, map_m = found["loops"]["closed"], found["error_m"]["map"]
    return Explored(name, seed, shares, closed, went_round, map_m, missed_m, len(course.visits))


def jobs(options: argparse.Namespace) -> Iterator[tuple[str, str, float | None, int, float, int]]:
    plans = {name: (options.data / file, scale) for name, (file, scale) in PLANS.items()}
    for name in options.worlds or (*WORLDS, *(name for name, (file, _) in plans.items() if file.is_file())):
        file, scale = plans.get(name, (name, None))
        for seed in options.seeds:
            yield Path(name).stem, str(file), scale, seed, options.minutes, options.goals


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("worlds", nargs="*", metavar="WORLD")
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seeds", type=int, nargs="+", default=[9101, 9102, 9103])
    parser.add_argument("--goals", type=int, default=0, help="to which the robot is sent afterwards")
    parser.add_argument("--data", type=Path, default=Path("../shared/data"), help="where the real plans lie")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    found = list[Explored]()
    with multiprocessing.get_context("spawn").Pool(options.workers, maxtasksperchild=1) as pool:
        for run in pool.imap(explore, jobs(options)):
            print(run, flush=True)
            found.append(run)
    mean, least = statistics.fmean(run.ratio for run in found), min(run.ratio for run in found)
    closed, went_round = sum(run.closed for run in found), sum(run.round for run in found)
    print(
        f"{mean:.2f} of the oracle in the mean, {least:.2f} at least: {'met' if mean >= BAR and least >= LEAST else 'MISSED'}"
    )
    print(f"{closed} of {went_round} loops closed: {'met' if closed >= 0.9 * went_round else 'MISSED'}")
    if options.goals:
        reached, goals = sum(run.reached for run in found), sum(run.goals for run in found)
        print(f"{reached} of {goals} goals reached: {'met' if reached >= GOALS_BAR * goals else 'MISSED'}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
