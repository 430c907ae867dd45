"""Map correction: moves experiences until links and map agree. ACRA 2005 equations 12-14, ACRA 2006 section 3.3."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

RAD_PER_M = 0.7  # a link that is off by a metre is off by so much in heading
CHAIN_GIVES = 5.0  # standard deviations at which odometry lets go
LOOK_GIVES = 1.0  # standard deviations from which a look pulls no harder
LEAST_STRENGTH = 1e-9  # below it no loop tells the bias from a bent way


class Adjacency:
    """The links at each experience, as chains through one array: `first[node]`, `following[2 * link + end]`, -1 ends."""

    def __init__(self) -> None:
        self.first = np.full(1024, -1, np.int64)
        self.following = np.full(2048, -1, np.int64)
        self._nodes = self._links = 0

    def add_node(self) -> None:
        if self._nodes == len(self.first):
            self.first = np.concatenate([self.first, np.full_like(self.first, -1)])
        self._nodes += 1

    def add_link(self, i: int, j: int) -> None:
        if 2 * self._links == len(self.following):
            self.following = np.concatenate([self.following, np.full_like(self.following, -1)])
        for end, node in ((0, i), (1, j)):
            self.following[2 * self._links + end] = self.first[node]
            self.first[node] = 2 * self._links + end
        self._links += 1


def sweep(
    poses: NDArray[np.float64],
    graph: Adjacency,
    ends: NDArray[np.int64],
    moves: NDArray[np.float64],
    weights: NDArray[np.float64],
    alpha: float,
) -> None:
    """One sweep over all experiences but the first, each moved by 2 alpha of its links' mean residual, in place."""
    _sweep(poses, graph.first, graph.following, ends, moves, weights, 2 * alpha)


@njit(cache=True, nogil=True)
def _sweep(poses, first, following, ends, moves, weights, gain):
    """dth_i = alpha [sum wrap(...)] / links for all, then dx_i, dy_i the same. B eqs. 12-14, divided by the weights' sum."""
    n = poses.shape[0]
    facing = np.empty((n, 2))
    facing[0] = math.cos(poses[0, 2]), math.sin(poses[0, 2])
    for i in range(1, n):
        turn = total = 0.0
        at = first[i]
        while at >= 0:
            link = at >> 1
            if at & 1:
                error = poses[ends[link, 0], 2] + moves[link, 2] - poses[i, 2]
            else:
                error = poses[ends[link, 1], 2] - moves[link, 2] - poses[i, 2]
            turn += weights[link] * _wrapped(error)
            total += weights[link]
            at = following[at]
        if total > 0.0:
            poses[i, 2] = _wrapped(poses[i, 2] + gain * turn / total)
        facing[i, 0] = math.cos(poses[i, 2])
        facing[i, 1] = math.sin(poses[i, 2])
    for i in range(1, n):
        dx = dy = total = 0.0
        at = first[i]
        while at >= 0:
            link = at >> 1
            a = ends[link, 0]
            w = weights[link]
            mx = facing[a, 0] * moves[link, 0] - facing[a, 1] * moves[link, 1]
            my = facing[a, 1] * moves[link, 0] + facing[a, 0] * moves[link, 1]
            if at & 1:
                dx += w * (poses[a, 0] + mx - poses[i, 0])
                dy += w * (poses[a, 1] + my - poses[i, 1])
            else:
                b = ends[link, 1]
                dx += w * (poses[b, 0] - mx - poses[i, 0])
                dy += w * (poses[b, 1] - my - poses[i, 1])
            total += w
            at = following[at]
        if total > 0.0:
            poses[i, 0] += gain * dx / total
            poses[i, 1] += gain * dy / total


@njit(cache=True, nogil=True, inline="always")
def _wrapped(angle):
    while angle > math.pi:
        angle -= 2.0 * math.pi
    while angle <= -math.pi:
        angle += 2.0 * math.pi
    return angle


def solve(
    poses: NDArray[np.float64],
    links: NDArray[np.int64],
    moves: NDArray[np.float64],
    weights: NDArray[np.float64],
    turning_s: NDArray[np.float64] | None = None,
    rounds: int = 2,
) -> float:
    """The fixed point of the sweeps, in place: headings, then positions, each a sparse Laplacian with the first node fixed.

    Every experience must be linked, over others, to the first. Headings are linear once their residuals are wrapped;
    `rounds` lets the wrapping settle.
    """
    n = len(poses)
    if n < 2 or len(links) == 0:
        return 0.0
    i, j = links[:, 0], links[:, 1]
    laplacian = coo_matrix(
        (
            np.concatenate([weights, weights, -weights, -weights]),
            (np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])),
        ),
        (n, n),
    ).tocsc()[1:, 1:]
    factor = splu(laplacian, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    seconds = np.zeros(len(links)) if turning_s is None else turning_s
    drift = np.zeros(n)  # headings that a unit of bias would bend the map to
    drift[1:] = factor.solve(_divergence(n, i, j, weights * seconds))
    unexplained = seconds - drift[j] + drift[i]
    strength = float(np.sum(weights * seconds * unexplained))
    bias = 0.0
    for _ in range(rounds):
        error = poses[i, 2] + moves[:, 2] - bias * seconds - poses[j, 2]
        error -= 2 * math.pi * np.round(error / (2 * math.pi))
        more = float(np.sum(weights * unexplained * error)) / strength if strength > LEAST_STRENGTH else 0.0
        bias += more
        poses[1:, 2] += factor.solve(_divergence(n, i, j, weights * (error - more * seconds)))
    poses[:, 2] -= 2 * math.pi * np.round(poses[:, 2] / (2 * math.pi))
    c, s = np.cos(poses[i, 2]), np.sin(poses[i, 2])
    ex = poses[i, 0] + c * moves[:, 0] - s * moves[:, 1] - poses[j, 0]
    ey = poses[i, 1] + s * moves[:, 0] + c * moves[:, 1] - poses[j, 1]
    poses[1:, :2] += factor.solve(
        np.stack([_divergence(n, i, j, weights * ex), _divergence(n, i, j, weights * ey)], axis=1)
    )
    return bias


def trust(
    poses: NDArray[np.float64],
    links: NDArray[np.int64],
    moves: NDArray[np.float64],
    weights: NDArray[np.float64],
    chain: NDArray[np.bool_],
    sigma: float,
) -> NDArray[np.float64]:
    """[ours] By how much each link is believed, 0 to 1, given what the map has made of it.

    weights are sigma^2 / variance. Looks pull with a force that stops growing (Huber); odometry, which cannot be far off,
    lets go (Cauchy): many looks that agree tear the one link over which the robot was carried, and no single look does.
    test_map_correction.py::test_many_looks_tear_the_link_of_a_kidnap.
    """
    i, j = links[:, 0], links[:, 1]
    c, s = np.cos(poses[i, 2]), np.sin(poses[i, 2])
    ex = poses[i, 0] + c * moves[:, 0] - s * moves[:, 1] - poses[j, 0]
    ey = poses[i, 1] + s * moves[:, 0] + c * moves[:, 1] - poses[j, 1]
    turn = poses[i, 2] + moves[:, 2] - poses[j, 2]
    turn -= 2 * math.pi * np.round(turn / (2 * math.pi))
    chi = np.sqrt(weights * (ex**2 + ey**2 + (turn / RAD_PER_M) ** 2)) / sigma
    return np.where(chain, 1 / (1 + (chi / CHAIN_GIVES) ** 2), np.minimum(1, LOOK_GIVES / np.maximum(chi, LOOK_GIVES)))


def _divergence(n: int, i: NDArray[np.int64], j: NDArray[np.int64], error: NDArray[np.float64]) -> NDArray[np.float64]:
    """What each node but the first is asked to move in sum."""
    return np.asarray(np.bincount(j, error, n) - np.bincount(i, error, n), np.float64)[1:]
