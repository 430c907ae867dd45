"""What an experiment may have measured beside the scores of every trial: each looks at every tick and gives scores."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from app.trials.course import Course
    from ratslam_core import GoalMemory
    from ratslam_core.types import Packet


class Arbitration:
    """Looks once a second while the robot follows a route: how far from its next point each movement ends, m; the one that
    was chosen, beside those that were free and not chosen. D 4.3, figure 4."""

    EVERY_S = 1.0

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._due_s = 0.0
        self._chosen_m: list[float] = []
        self._others_m: list[float] = []

    def note(self) -> None:
        session = self._session
        state = session.pilot.goal_state
        if state is None or state[1] != "tracking" or session.time_s < self._due_s:
            return
        self._due_s = session.time_s + self.EVERY_S
        look, aim = session.pilot.look_at_choice(), session.pilot.aim
        if look is None or aim is None:
            return
        tried = look()
        ends = tried.paths[:, -1]
        away = np.hypot(ends[:, 0] - aim[0], ends[:, 1] - aim[1])
        free = np.isfinite(tried.cost) & (tried.speed > 0)
        if not free.any() or not free[tried.chosen]:
            return
        self._chosen_m.append(float(away[tried.chosen]))
        free[tried.chosen] = False
        self._others_m.extend(away[free].tolist())

    def scores(self) -> dict[str, float]:
        if not (self._chosen_m and self._others_m):
            return {}
        chosen, others = math.fsum(self._chosen_m), math.fsum(self._others_m)
        return {"chosen_off_m": chosen / len(self._chosen_m), "others_off_m": others / len(self._others_m)}


_WEIGHTS = ("time_weight", "activity_weight", "distance_weight")
CHANGES = (0.8, 1.2)
MOST_STEPS = 1000  # cells that a route may be long


class GoalMemoryRoutes:
    """Goal memories with each of the three weights changed by a fifth learn beside the brain's own, and lead back to
    where the robot began: does the route stay? C IV.C: "insensitive to small changes"."""

    def __init__(self, course: Course) -> None:
        from ratslam_core import GoalMemory

        self._session = course.session
        brain = self._session.brain
        params, shape, cell_m = brain.params.goal_memory, brain.pose_cells.shape, brain.pose_cells.params.cell_m
        changed = [replace(params, **{name: by * getattr(params, name)}) for name in _WEIGHTS for by in CHANGES]
        self._memories = [GoalMemory(each, shape, cell_m) for each in (params, *changed)]
        self._home = brain.pose_cells.winner
        self._under_way_s = 0.0

    def note(self) -> None:
        """The same that the brain's own memory is given in `RatSlam.step`."""
        brain, odometry = self._session.brain, self._session.odometry
        leap = (self._session.estimate.relocalised or brain.carried) and not brain.params.goal_memory.over_jumps
        moves = not odometry.still
        self._under_way_s += odometry.dt * moves
        for memory in self._memories:
            if leap:
                memory.interrupt()
            if moves:
                memory.learn(*brain.pose_cells.active, self._under_way_s)

    def scores(self) -> dict[str, float]:
        begin = self._session.brain.pose_cells.winner
        base, *others = [_route(memory, begin, self._home) for memory in self._memories]
        off = [_off(route, base) * self._memories[0].cell_m for route in others if len(route) and len(base)]
        if not off:
            return {}
        return {"route_off_m": float(np.mean(off)), "route_off_at_most_m": max(off), "route_cells": float(len(base))}


def _route(memory: GoalMemory, begin: Packet, goal: Packet) -> NDArray[np.float64]:
    """The cells (n, 2) that the directions lead through, a cell a step; empty if they do not lead to the goal."""
    from ratslam_core.goal_memory import ARRIVED

    n_y, n_x = memory.shape[1:]
    times = memory.times_to(round(goal.x) % n_x, round(goal.y) % n_y)
    at, cells = begin, [(begin.x, begin.y)]
    for _ in range(MOST_STEPS):
        bearing = memory.direction(times, at)
        if bearing is None:
            break
        at = replace(at, x=(at.x + math.cos(bearing)) % n_x, y=(at.y + math.sin(bearing)) % n_y)
        cells.append((at.x, at.y))
    away = math.hypot(_apart(at.x, goal.x, n_x), _apart(at.y, goal.y, n_y))
    return np.array(cells) if away <= ARRIVED + 1 else np.zeros((0, 2))


def _off(route: NDArray[np.float64], base: NDArray[np.float64]) -> float:
    """The mean distance of a route's cells from the nearest cell of another route."""
    return float(np.mean([np.hypot(*(base - cell).T).min() for cell in route]))


def _apart(a: float, b: float, ring: int) -> float:
    return (a - b + ring / 2) % ring - ring / 2


class Measure(Protocol):
    """Made before the first tick; `note` is called after each."""

    def note(self) -> None: ...

    def scores(self) -> dict[str, float]: ...


class _AtTheEnd:
    """A measure that looks once."""

    def __init__(self, course: Course) -> None:
        self.course = course
        self.session = course.session

    def note(self) -> None: ...


class Packets:
    """Competing packets (A 5): how many at most, for how long a second one held a fifth, and when one had won after a kidnap.

    `one_won_s`: from the last kidnap until no rival held a fifth any more, for good.
    """

    SHARE = 0.2

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._most, self._rival_s, self._last_rival_s = 0, 0.0, 0.0

    def note(self) -> None:
        packets = self._session.brain.pose_cells.packets
        self._most = max(self._most, len(packets))
        if len(packets) > 1 and packets[1].mass > self.SHARE:
            self._rival_s += self._session.frame.dt
            self._last_rival_s = self._session.time_s

    def scores(self) -> dict[str, float]:
        scores = {"packets_at_most": float(self._most), "rival_s": self._rival_s}
        kidnaps = self._session.evaluation.kidnaps
        if kidnaps:
            scores["one_won_s"] = max(0.0, self._last_rival_s - kidnaps[-1].at_s)
        return scores


class FalseSnaps:
    """Snaps (A 6.6): those after which the robot was more than a metre from where it then believed to be."""

    FALSE_M = 1.0

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._false = self._true = 0

    def note(self) -> None:
        session = self._session
        if not session.estimate.relocalised or session.estimate.created:
            return
        off_m, _ = session.evaluation.belief_off(session.simulator.truth, session.brain.experience_map)
        self._false += off_m > self.FALSE_M
        self._true += off_m <= self.FALSE_M

    def scores(self) -> dict[str, float]:
        return {"false_snaps": float(self._false), "true_snaps": float(self._true)}


class Phenomena(_AtTheEnd):
    """Places with several representations, and pose cells that stand for several places (B 3.6, 3.7)."""

    def scores(self) -> dict[str, float]:
        from ratslam_core import find_places

        found = find_places(self.session.brain.experience_map)
        return {
            "places": float(len(found.first)),
            "multiple_representations": float(len(found.multiple_representations)),
            "hash_collisions": float(len(found.hash_collisions)),
        }


class Residual:
    """The disagreement of map and links (B 4.3): mean over the links, at the end and at most; nothing if it is not finite."""

    EVERY = 50  # ticks

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._most_m = 0.0

    def note(self) -> None:
        if self._session.tick_count % self.EVERY == 0:
            self._most_m = max(self._most_m, self._session.brain.experience_map.residual[0])

    def scores(self) -> dict[str, float]:
        return {"residual_m": self._session.brain.experience_map.residual[0], "residual_at_most_m": self._most_m}


class Covered(_AtTheEnd):
    """The share of the floor to which the robot has come within a metre."""

    def scores(self) -> dict[str, float]:
        session = self.session
        from app.evaluation import Coverage

        return {"covered": Coverage().follow(session.simulator.free_space, session.evaluation.path)}


class TurnOfCells:
    """How far the packet's path turns in the pose cells for each turn that the robot truly makes (B 5.2), from 0 to 1.

    1: right; 0: the loop's path is a straight line. Turning to the left and to the right cancel, as they do in a loop.
    """

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._cells = self._true = 0.0
        self._before: tuple[float, float] | None = None

    def note(self) -> None:
        heading = self._session.brain.pose_cells.winner.heading_rad
        true = self._session.simulator.truth.heading_rad
        if self._before is not None and not self._session.estimate.relocalised:
            self._cells += math.remainder(heading - self._before[0], math.tau)
            self._true += math.remainder(true - self._before[1], math.tau)
        self._before = heading, true

    def scores(self) -> dict[str, float]:
        turns = {"turned_in_cells_deg": math.degrees(self._cells), "turned_deg": math.degrees(self._true)}
        return turns if abs(self._true) < math.pi else {**turns, "turn_kept": self._cells / self._true}


class EndPoint(_AtTheEnd):
    """How far the packet is, at the end, from where the same moves without errors lead, in metres (A 4, path integration)."""

    def __init__(self, course: Course) -> None:
        super().__init__(course)
        winner, truth = self.session.brain.pose_cells.winner, self.session.simulator.truth
        self._began = winner.x, winner.y, winner.heading_rad - truth.heading_rad, truth.x, truth.y

    def scores(self) -> dict[str, float]:
        session, (x, y, turn, true_x, true_y) = self.session, self._began
        cells, truth = session.brain.pose_cells, session.simulator.truth
        c, s, cell_m = math.cos(turn), math.sin(turn), session.config.pose_cells.cell_m
        dx, dy = truth.x - true_x, truth.y - true_y
        ahead, aside = x + (c * dx - s * dy) / cell_m, y + (s * dx + c * dy) / cell_m
        return {"end_off_m": cells.cells_apart(ahead, aside, cells.winner.x, cells.winner.y) * cell_m}


class WaysApart(_AtTheEnd):
    """How far apart the map draws the ways out and back of one place (B 7), m: mean, and at most.

    Two experiences are of one place if they were made within half a metre of each other, facing opposite ways.
    """

    NEAR_M = 0.5
    OPPOSITE_RAD = 2.5

    def scores(self) -> dict[str, float]:
        map_ = self.session.brain.experience_map
        made = self.session.evaluation.births(len(map_))
        known = np.flatnonzero(np.isfinite(made[:, 0]))
        apart: list[float] = []
        for i in known.tolist():
            others = known[known > i]
            near = np.hypot(made[others, 0] - made[i, 0], made[others, 1] - made[i, 1]) < self.NEAR_M
            turn = np.abs(np.remainder(made[others, 2] - made[i, 2] + np.pi, 2 * np.pi) - np.pi)
            pairs = others[near & (turn > self.OPPOSITE_RAD)]
            apart.extend(np.hypot(*(map_.poses[pairs, :2] - map_.poses[i, :2]).T).tolist())
        return {"ways_apart_m": float(np.mean(apart)), "ways_apart_at_most_m": max(apart)} if apart else {}


class WayTaken(_AtTheEnd):
    """The share of the last visit's way that was driven in the lower half of the world (C V.D: where the slow way is)."""

    def scores(self) -> dict[str, float]:
        if not self.course.visits:
            return {}
        session, visit = self.session, self.course.visits[-1]
        path = session.evaluation.path[round(visit.began_s / session.frame.dt) :]
        _, low, _, high = session.world.bounds
        return {"lower_way": float(np.mean(path[:, 1] < (low + high) / 2))} if len(path) else {}


class Consistency:
    """Consistency over time (A 6.5): the longest period in which the robot was more than half a metre off, s, and how far."""

    OFF_M = 0.5

    def __init__(self, course: Course) -> None:
        self._session = course.session
        self._off_s = self._longest_s = self._farthest_m = 0.0

    def note(self) -> None:
        session = self._session
        off_m, _ = session.evaluation.belief_off(session.simulator.truth, session.brain.experience_map)
        if math.isnan(off_m) or off_m <= self.OFF_M:
            self._off_s = 0.0
            return
        self._off_s += session.frame.dt
        self._longest_s, self._farthest_m = max(self._longest_s, self._off_s), max(self._farthest_m, off_m)

    def scores(self) -> dict[str, float]:
        return {"longest_off_s": self._longest_s, "farthest_off_m": self._farthest_m}


MEASURES: dict[str, Callable[[Course], Measure]] = {
    "packets": Packets,
    "false snaps": FalseSnaps,
    "phenomena": Phenomena,
    "residual": Residual,
    "covered": Covered,
    "turn of the cells": TurnOfCells,
    "end point": EndPoint,
    "ways apart": WaysApart,
    "way taken": WayTaken,
    "consistency": Consistency,
    "goal memory routes": GoalMemoryRoutes,
    "arbitration": Arbitration,
}
SCORES: dict[str, tuple[str, ...]] = {  # that each measure gives, or some of them where they apply
    "packets": ("packets_at_most", "rival_s", "one_won_s"),
    "false snaps": ("false_snaps", "true_snaps"),
    "phenomena": ("places", "multiple_representations", "hash_collisions"),
    "residual": ("residual_m", "residual_at_most_m"),
    "covered": ("covered",),
    "turn of the cells": ("turned_in_cells_deg", "turned_deg", "turn_kept"),
    "end point": ("end_off_m",),
    "ways apart": ("ways_apart_m", "ways_apart_at_most_m"),
    "way taken": ("lower_way",),
    "consistency": ("longest_off_s", "farthest_off_m"),
    "goal memory routes": ("route_off_m", "route_off_at_most_m", "route_cells"),
    "arbitration": ("chosen_off_m", "others_off_m"),
}
