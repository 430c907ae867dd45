"""Packets that are moved over the plane of a goal memory by hand."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ratslam_core import GoalMemory

SHAPE = (4, 64, 64)
CELL_M = 0.25
DT = 0.1
Place = tuple[float, float]
SHORT_AND_SLOW: list[Place] = [(10, 30), (40, 30)]


def packet_cells(x: float, y: float, shape: tuple[int, int, int] = SHAPE) -> tuple[NDArray, NDArray]:
    """A Gaussian packet over two layers, as wide as those of the pose cells."""
    rows, values = [], []
    for dy in range(-4, 5):
        for dx in range(-4, 5):
            at_x, at_y = round(x) + dx, round(y) + dy
            value = math.exp(-((at_x - x) ** 2 + (at_y - y) ** 2) / (2 * 1.8**2))
            for theta, part in ((1, 0.7), (2, 0.3)):
                cx, cy = at_x % shape[2], at_y % shape[1]
                rows.append((cx, cy, theta, (theta * shape[1] + cy) * shape[2] + cx))
                values.append(part * value)
    return np.array(rows, np.int32), (np.array(values) / sum(values)).astype(np.float32)


def drive(memory: GoalMemory, corners: list[Place], speed: float, start_s: float = 0.0) -> float:
    """A packet moves from corner to corner (cells) at this speed in m/s; returns the time when it arrives."""
    time_s = start_s
    for a, b in pairwise(corners):
        steps = max(1, round(math.dist(a, b) * CELL_M / speed / DT))
        for k in range(steps):
            time_s += DT
            part = k / steps
            memory.learn(*packet_cells(a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])), time_s)
    return time_s
