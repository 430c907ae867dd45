"""Pose graphs: a backbone of odometry from each place to the next, and closures between places far apart in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ratslam_core.pose_graph.pose_graph import TURN_CELLS

SIGMA_M = 0.024  # the noise of the Manhattan world as its residuals have it
SIGMA_RAD = TURN_CELLS / 0.25 * SIGMA_M  # as the map understands it: a row has one weight for both
LEAST_M = 2.0  # a closure between places nearer than this would not be false

Rows = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Places from 0 on, and what is known of the ways between them."""

    name: str
    backbone: Rows  # (n - 1, 3): dx, dy (m), turn (rad) from each place to the next, in the frame of the first
    backbone_sigma: NDArray[np.float64]  # (n - 1,): m; infinite where nothing is known
    ends: NDArray[np.int64]  # (m, 2) of the closures
    moves: Rows  # (m, 3)
    sigma: NDArray[np.float64]  # (m,)
    truth: Rows | None = None  # (n, 3), if it is known

    def __len__(self) -> int:
        return len(self.backbone) + 1

    @property
    def odometry(self) -> Rows:
        """Each place by the backbone alone, from (0, 0, 0), (n, 3)."""
        poses = np.zeros((len(self), 3))
        for k, move in enumerate(self.backbone):
            poses[k + 1] = compose(poses[k], move)
        return poses

    def claiming(self, sigma_m: float) -> Graph:
        """The same measurements that claim another precision, as the files of others do: 0.15 m, and are good to 0.024."""
        backbone = np.where(np.isfinite(self.backbone_sigma), sigma_m, np.inf)
        sigma = np.full(len(self.sigma), sigma_m)
        return Graph(self.name, self.backbone, backbone, self.ends, self.moves, sigma, self.truth)

    def with_closures(self, ends: NDArray[np.int64], moves: Rows, sigma: NDArray[np.float64]) -> Graph:
        """The graph with more closures."""
        return Graph(
            self.name, self.backbone, self.backbone_sigma, np.concatenate([self.ends, ends]),
            np.concatenate([self.moves, moves]), np.concatenate([self.sigma, sigma]), self.truth,
        )  # fmt: skip


def compose(a: Rows, b: Rows) -> Rows:
    """Poses b, given in the frames of a; (..., 3) each."""
    c, s = np.cos(a[..., 2]), np.sin(a[..., 2])
    x, y = a[..., 0] + c * b[..., 0] - s * b[..., 1], a[..., 1] + s * b[..., 0] + c * b[..., 1]
    return np.stack([x, y, wrapped(a[..., 2] + b[..., 2])], axis=-1)


def between(a: Rows, b: Rows) -> Rows:
    """Poses b as seen from a; (..., 3) each."""
    c, s = np.cos(a[..., 2]), np.sin(a[..., 2])
    dx, dy = b[..., 0] - a[..., 0], b[..., 1] - a[..., 1]
    return np.stack([c * dx + s * dy, -s * dx + c * dy, wrapped(b[..., 2] - a[..., 2])], axis=-1)


def wrapped(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """In [-pi, pi)."""
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def measured(name: str, truth: Rows, ends: NDArray[np.int64], rng: np.random.Generator) -> Graph:
    """The graph of true places (n, 3) and closures (m, 2) as measured with the usual noise."""

    def noisy(moves: Rows) -> Rows:
        return compose(moves, rng.normal(0.0, (SIGMA_M, SIGMA_M, SIGMA_RAD), moves.shape))

    backbone = noisy(between(truth[:-1], truth[1:]))
    moves = noisy(between(truth[ends[:, 0]], truth[ends[:, 1]]))
    return Graph(name, backbone, np.full(len(backbone), SIGMA_M), ends, moves, np.full(len(moves), SIGMA_M), truth)


def lied_to(graph: Graph, clean: Rows, count: int, rng: np.random.Generator) -> Graph:
    """With so many closures that say that two places chosen at random, far apart in truth, are one.

    clean: where the places are, (n, 3). Each lie has a heading of its own, and they claim to be as precise as the
    closures of the graph, so nothing but the graph itself tells them from the others.
    """
    pairs = rng.integers(0, len(graph), (20 * count + 100, 2))
    pairs.sort(axis=1)
    apart = np.hypot(*(clean[pairs[:, 0], :2] - clean[pairs[:, 1], :2]).T)
    pairs = pairs[apart > LEAST_M][:count]
    moves = np.column_stack([rng.uniform(-0.5, 0.5, (len(pairs), 2)), rng.uniform(-np.pi, np.pi, len(pairs))])
    sigma = float(np.median(graph.sigma)) if len(graph.sigma) else SIGMA_M
    return graph.with_closures(pairs.astype(np.int64), moves, np.full(len(pairs), sigma))
