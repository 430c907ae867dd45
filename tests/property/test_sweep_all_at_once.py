"""The papers' correction as it is printed: it converges where its rate is low enough, diverges elsewhere, and stays finite."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.pose_graph import relaxation
from ratslam_core.pose_graph.relaxation import has_diverged, sweep_all_at_once
from tests.unit.ratslam_core.literal import also_interpreted

from .pose_graphs import EXAMPLES, Graph, disturb, graphs, turned, wrap


def swept(graph: Graph, times: int, alpha: float) -> np.ndarray:
    poses = graph.poses.copy()
    for _ in range(times):
        sweep_all_at_once(poses, graph.links, graph.moves, alpha)
    return poses


def stiffness(graph: Graph) -> float:
    """The largest eigenvalue of the graph's Laplacian without the first node, which stays."""
    laplacian = np.zeros((len(graph.poses), len(graph.poses)))
    for i, j in graph.links:
        laplacian[i, i] += 1
        laplacian[j, j] += 1
        laplacian[i, j] -= 1
        laplacian[j, i] -= 1
    return float(np.linalg.eigvalsh(laplacian[1:, 1:]).max())


def literal_sweep(graph: Graph, alpha: float) -> np.ndarray:
    """B12, B13 and B14, experience by experience, with nothing moved before all are known."""
    new = graph.poses.copy()
    for i in range(1, len(new)):
        x, y, heading = graph.poses[i]
        sums = np.zeros(3)
        for (a, b), move in zip(graph.links, graph.moves, strict=True):
            other = graph.poses[b] if i == a else graph.poses[a]
            if i == a:  # to j
                ahead = turned(np.array([heading]), move[None])[0]
                sums += other[0] - ahead[0] - x, other[1] - ahead[1] - y, float(wrap(other[2] - heading - move[2]))
            if i == b:  # from k
                ahead = turned(other[2:], move[None])[0]
                sums += other[0] + ahead[0] - x, other[1] + ahead[1] - y, float(wrap(other[2] + move[2] - heading))
        new[i] += alpha * sums
    new[1:, 2] = wrap(new[1:, 2])
    return new


@also_interpreted(relaxation)
@settings(max_examples=40)
@given(graphs(), st.floats(0.0, 0.95))
def test_a_sweep_is_that_of_the_literal_sums(graph: Graph, alpha: float) -> None:
    disturb(graph, 1.0, 0.5)
    new, expected = swept(graph, 1, alpha), literal_sweep(graph, alpha)
    assert np.array_equal(new[0], graph.poses[0])
    assert np.abs(wrap(new[:, 2] - expected[:, 2])).max() < 1e-9
    assert np.abs(new[:, :2] - expected[:, :2]).max() < 1e-9


@EXAMPLES
@given(graphs(weighted=False), st.floats(0.2, 0.95))
def test_below_two_over_the_stiffness_it_converges(graph: Graph, share: float) -> None:
    disturb(graph, 0.5, 0.0)
    alpha = share * 2 / stiffness(graph)
    before = graph.placed_energy(graph.poses)
    for times in (1, 5, 50):
        after = graph.placed_energy(swept(graph, times, alpha))
        assert after <= before * (1 + 1e-9) + 1e-12
        before = after


@EXAMPLES
@given(graphs(weighted=False), st.floats(1.2, 5.0))
def test_above_it_the_map_is_thrown_apart_and_stays_finite(graph: Graph, times: float) -> None:
    disturb(graph, 0.5, 0.0)
    alpha = times * 2 / stiffness(graph)
    first, length = graph.poses[0].copy(), float(np.hypot(*graph.moves[:, :2].T).sum())
    poses = swept(graph, 400, alpha)
    assert has_diverged(poses, graph.moves)
    assert np.array_equal(poses[0], first)
    growth = 1 + 2 * alpha * stiffness(graph)
    assert np.abs(poses[:, :2] - first[:2]).max() < 10 * length * growth * len(poses) + length
    assert np.abs(poses[:, 2]).max() <= math.pi + 1e-9


def test_a_map_that_has_diverged_comes_together_again_when_the_rate_is_lowered() -> None:
    n = 12
    star = np.array([(0, k) for k in range(1, n)] + [(k, k % (n - 1) + 1) for k in range(1, n)], np.int64)
    angles = 2 * math.pi * np.arange(n - 1) / (n - 1)
    true = np.vstack([np.zeros(2), np.column_stack([np.cos(angles), np.sin(angles)])])
    moves = np.column_stack([true[star[:, 1]] - true[star[:, 0]], np.zeros(len(star))])
    poses = np.column_stack([true + 0.01 * np.sin(np.arange(2 * n)).reshape(n, 2), np.zeros(n)])
    poses[0] = 0.0
    for _ in range(100):
        sweep_all_at_once(poses, star, moves, 0.5)
    thrown = poses.copy()
    assert has_diverged(poses, moves)
    sweep_all_at_once(poses, star, moves, 0.5)
    assert np.array_equal(poses, thrown)  # left as it is
    for _ in range(2000):
        sweep_all_at_once(poses, star, moves, 0.05)
    assert not has_diverged(poses, moves)
    assert np.abs(poses[:, :2] - true).max() < 1e-6
