"""The transitions of an experience map, as rows for map correction and for the times of routes. ACRA 2006 section 3.2.

A row says: from experience i to experience j the robot makes this move (dx, dy in the frame of i, change of facing). Its
weight is sigma^2 / variance, 1 for the odometry of one step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ratslam_core.map_correction import Adjacency
from ratslam_core.types import Pose2, wrap_angle


class Transitions:
    """Rows that are only ever added or made more precise. Arrays have room to spare; `count` rows are used."""

    def __init__(self) -> None:
        self.count = 0
        self.graph = Adjacency()
        self.ends = np.zeros((1024, 2), np.int64)
        self.move = np.zeros((1024, 3))
        self.weight = np.zeros(1024)
        self.believed = np.zeros(1024)  # the weight times how far the map bears the row out
        self.turning_s = np.zeros(1024)  # time during which the wheels turned
        self.time_s = np.zeros(1024)
        self.passages = np.zeros(1024, np.int64)
        self.travelled = np.zeros(1024, np.bool_)  # a way that the robot drove; the others only serve map correction
        self.chain = np.zeros(1024, np.bool_)  # odometry by which an experience was made, not a look at a known one
        self.row_of: dict[tuple[int, int], int] = {}

    def add(self, i: int, j: int, *, travelled: bool) -> int:
        """A new row, still without a move; returns its number."""
        if self.count == len(self.ends):
            for name in _COLUMNS:
                array = getattr(self, name)
                setattr(self, name, np.concatenate([array, np.zeros_like(array)]))
        row = self.count
        self.ends[row], self.travelled[row] = (i, j), travelled
        self.chain[row] = self.graph.first[j] < 0 or not travelled
        self.count += 1
        self.graph.add_link(i, j)
        if travelled:
            self.row_of[i, j] = row
        return row

    def measure(self, row: int, move: Pose2, weight: float, old: NDArray[np.float64], old_weight: float) -> None:
        """Average a passage into the row as it was before, each by its weight. ACRA 2006 eq. 6."""
        share = weight / (old_weight + weight)
        turn = old[2] + share * wrap_angle(move.heading_rad - old[2])
        self.move[row] = old[0] + share * (move.x - old[0]), old[1] + share * (move.y - old[1]), wrap_angle(turn)
        self.weight[row] = self.believed[row] = old_weight + weight

    def take_time(self, row: int, seconds: float, turning_s: float) -> None:
        """One more passage took so long: running means."""
        n = self.passages[row]
        self.time_s[row] += (seconds - self.time_s[row]) / (n + 1)
        self.turning_s[row] += (turning_s - self.turning_s[row]) / (n + 1)
        self.passages[row] = n + 1


_COLUMNS = ("ends", "move", "weight", "believed", "turning_s", "time_s", "passages", "travelled", "chain")
