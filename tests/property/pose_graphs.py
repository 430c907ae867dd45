"""Random connected graphs of poses and links, and their residuals."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from ratslam_core.pose_graph.relaxation import solve, sweep
from ratslam_core.pose_graph.transitions import Adjacency

EXAMPLES = settings(max_examples=60)


@dataclass
class Graph:
    poses: np.ndarray
    links: np.ndarray
    moves: np.ndarray
    weights: np.ndarray
    rng: np.random.Generator

    @property
    def adjacency(self) -> Adjacency:
        adjacency = Adjacency()
        for _ in self.poses:
            adjacency.add_node()
        for row, (i, j) in enumerate(self.links):
            adjacency.add_link(int(i), int(j), row)
        return adjacency

    def swept(self, times: int, alpha: float = 0.5) -> np.ndarray:
        poses, adjacency = self.poses.copy(), self.adjacency
        for _ in range(times):
            sweep(poses, adjacency, self.moves, self.weights, alpha)
        return poses

    def solved(self, rounds: int = 2) -> np.ndarray:
        poses = self.poses.copy()
        solve(poses, self.links, self.moves, self.weights, rounds=rounds)
        return poses

    def turned_energy(self, poses: np.ndarray) -> float:
        i, j = self.links.T
        return float(self.weights @ wrap(poses[i, 2] + self.moves[:, 2] - poses[j, 2]) ** 2)

    def placed_energy(self, poses: np.ndarray) -> float:
        i, j = self.links.T
        return float(self.weights @ np.sum((poses[i, :2] + turned(poses[i, 2], self.moves) - poses[j, :2]) ** 2, 1))


def wrap(angle: np.ndarray) -> np.ndarray:
    return np.remainder(angle + math.pi, 2 * math.pi) - math.pi


def turned(heading: np.ndarray, moves: np.ndarray) -> np.ndarray:
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([c * moves[:, 0] - s * moves[:, 1], s * moves[:, 0] + c * moves[:, 1]], 1)


def true_moves(poses: np.ndarray, links: np.ndarray) -> np.ndarray:
    i, j = links.T
    d = poses[j, :2] - poses[i, :2]
    c, s = np.cos(poses[i, 2]), np.sin(poses[i, 2])
    return np.stack([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1], wrap(poses[j, 2] - poses[i, 2])], 1)


@st.composite
def graphs(draw: st.DrawFn, weighted: bool = True) -> Graph:
    """Everything is connected to the first node. Links run either way, some are parallel, and all fit the poses exactly."""
    n = draw(st.integers(2, 20))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    links = [(int(rng.integers(k)), k) for k in range(1, n)]
    links += [tuple(rng.choice(n, 2, replace=False).tolist()) for _ in range(draw(st.integers(0, 2 * n)))]
    ends = np.array([(b, a) if rng.random() < 0.5 else (a, b) for a, b in links], np.int64)
    poses = np.column_stack([rng.uniform(-5, 5, (n, 2)), rng.uniform(-math.pi, math.pi, n)])
    weights = 10 ** rng.uniform(-2, 0, len(ends)) if weighted else np.ones(len(ends))
    return Graph(poses, ends, true_moves(poses, ends), weights, rng)


def disturb(graph: Graph, place: float, turn: float) -> None:
    """Add errors to the links."""
    graph.moves[:, :2] += graph.rng.uniform(-place, place, (len(graph.links), 2))
    graph.moves[:, 2] = wrap(graph.moves[:, 2] + graph.rng.uniform(-turn, turn, len(graph.links)))
