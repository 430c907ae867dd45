"""A graph in an experience map, solved by the map's own optimiser. All that knows the solver is here."""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numpy as np

from benchmarks.back_end.graph import Graph, Rows
from ratslam_core import ExperienceMap, ExperienceMapParams, Odometry, Packet, Pose2, Recognition

SHAPE, CELL_M = (36, 64, 64), 0.25
STILL_M = 1e-3  # a call after which nothing has moved farther has changed nothing
QUIET_CALLS, MOST_CALLS = 3, 100
STILL = Odometry(0.0, 0.0, 0.1)
HERE = Packet(10.0, 10.0, 0.0, 1.0)


class Solved(NamedTuple):
    """Where the optimiser puts the places, (n, 3), and how many calls and seconds this took."""

    poses: Rows
    calls: int
    seconds: float


def solve(graph: Graph, *, doubting: bool = True) -> Solved:
    """The graph solved by the map's own optimiser. doubting: off, it believes every row as much as every other.

    It is called as in a robot's life, but as if it had rested for long and had just closed a loop, until it changes
    nothing more. The calls that only find that nothing changes do not count.
    """
    map_ = _map(graph, ExperienceMapParams(robust=doubting))
    took, calls, at_rest, seconds = 0.0, 0, 0, 0.0
    for call in range(1, MOST_CALLS + 1):
        before = map_.poses[:, :2].copy()
        map_.steps += 10**6
        map_.closures += 1
        began = time.perf_counter()
        map_.correct()
        seconds += time.perf_counter() - began
        if np.abs(map_.poses[:, :2] - before).max() > STILL_M:
            took, calls, at_rest = seconds, call, 0
        else:
            at_rest += 1
        if at_rest == QUIET_CALLS:
            break
    return Solved(map_.poses.copy(), calls, took)


def _map(graph: Graph, params: ExperienceMapParams) -> ExperienceMap:
    """An experience for each place, a row of odometry to each from the one before, and a row for each closure."""
    map_ = ExperienceMap(SHAPE, CELL_M, params)
    for k in range(len(graph)):  # each has a view of its own, so each step makes an experience
        map_.step(HERE, Recognition(k, True, -1, 0.0), STILL)
    t = map_.transitions
    for k, move in enumerate(graph.backbone.tolist()):
        row = t.row_of[k, k + 1]
        t.measure(row, Pose2(*move), _weight(map_, float(graph.backbone_sigma[k])), t.move[row], 0.0)
        t.turning_s[row] = 0.0
    for (i, j), move, sigma in zip(graph.ends.tolist(), graph.moves.tolist(), graph.sigma.tolist(), strict=True):
        row = t.add(i, j, travelled=True)
        t.measure(row, Pose2(*move), _weight(map_, sigma), t.move[row], 0.0)
    map_.poses[:] = graph.odometry
    return map_


def _weight(map_: ExperienceMap, sigma_m: float) -> float:
    """The weight of a row with this standard deviation, as the map counts it; next to nothing if nothing is known."""
    return 1e-12 if math.isinf(sigma_m) else (map_.step_sigma_m / sigma_m) ** 2
