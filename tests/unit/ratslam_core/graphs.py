"""Graphs of poses like those that others test map correction with: walks along the streets of a city, and false closures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass
class Graph:
    """Rows say where `ends[:, 1]` lies in the frame of `ends[:, 0]`: dx, dy (m), turn (rad). The first n - 1 are odometry."""

    truth: NDArray[np.float64]  # (n, 3)
    ends: NDArray[np.int64]
    moves: NDArray[np.float64]

    @property
    def odometry(self) -> NDArray[np.bool_]:
        return np.arange(len(self.ends)) < len(self.truth) - 1

    def by_odometry(self) -> NDArray[np.float64]:
        """The poses that odometry alone gives."""
        poses = np.zeros_like(self.truth)
        for k, (dx, dy, turn) in enumerate(self.moves[: len(poses) - 1]):
            x, y, heading = poses[k]
            c, s = math.cos(heading), math.sin(heading)
            poses[k + 1] = x + c * dx - s * dy, y + s * dx + c * dy, wrapped(heading + turn)
        return poses

    def with_false(self, count: int, seed: int) -> Graph:
        """The same with closures between places by chance, which say that these are one place."""
        rng = np.random.default_rng(seed)
        ends = np.sort(rng.integers(0, len(self.truth), (3 * count, 2)), axis=1)
        ends = ends[ends[:, 1] - ends[:, 0] > 1][:count]
        moves = rng.normal(0.0, 0.3, (len(ends), 3))
        return Graph(self.truth, np.vstack([self.ends, ends]), np.vstack([self.moves, moves]))


def city(poses: int, side: int, seed: int) -> Graph:
    """A walk of steps of 1 m over a square of streets 1 m apart; two poses in three tie to an earlier one at the same corner."""
    rng = np.random.default_rng(seed)
    x = y = facing = 0
    truth, at = [(0.0, 0.0, 0.0)], {(0, 0): [0]}
    ends = [(i, i + 1) for i in range(poses - 1)]
    for i in range(1, poses):
        facing = (facing + (rng.choice([-1, 1]) if rng.random() < 0.1 else 0)) % 4
        dx, dy = ((1, 0), (0, 1), (-1, 0), (0, -1))[facing]
        if max(abs(x + dx), abs(y + dy)) > side // 2:
            facing, dx, dy = (facing + 2) % 4, -dx, -dy
        x, y = x + dx, y + dy
        truth.append((float(x), float(y), wrapped(facing * math.pi / 2)))
        before = at.setdefault((x, y), [])
        ends += [(before[-1], i)] if before and i - before[-1] > 20 and rng.random() < 0.66 else []
        before.append(i)
    rows, known = np.array(ends), np.array(truth)
    return Graph(known, rows, between(known, rows) + rng.normal(0.0, 1.0, (len(rows), 3)) * (0.02, 0.02, 0.01))


def between(poses: NDArray[np.float64], ends: NDArray[np.int64]) -> NDArray[np.float64]:
    """Where the end of each row lies in the frame of its beginning."""
    a, b = poses[ends[:, 0]], poses[ends[:, 1]]
    c, s = np.cos(a[:, 2]), np.sin(a[:, 2])
    dx, dy = b[:, 0] - a[:, 0], b[:, 1] - a[:, 1]
    turn = np.remainder(b[:, 2] - a[:, 2] + np.pi, 2 * np.pi) - np.pi
    return np.stack([c * dx + s * dy, -s * dx + c * dy, turn], axis=1)


def wrapped(angle: float) -> float:
    return math.remainder(angle, 2 * math.pi)
