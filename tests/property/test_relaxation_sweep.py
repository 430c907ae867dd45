"""Laws of the sweeps of map correction on random connected graphs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.pose_graph import pose_graph, relaxation
from ratslam_core.pose_graph.relaxation import sweep
from ratslam_core.pose_graph.transitions import Adjacency
from tests.unit.ratslam_core.literal import also_interpreted

from .pose_graphs import EXAMPLES, Graph, disturb, graphs, turned, wrap


@EXAMPLES
@given(graphs(), st.floats(0.0, 1.0))
def test_a_sweep_never_raises_the_residual(graph: Graph, alpha: float) -> None:
    """That of the headings, whatever the links say; that of the places, while the headings agree with the links."""
    disturb(graph, 3.0, 0.0)
    before = graph.placed_energy(graph.poses)
    for times in (1, 2, 5):
        swept = graph.swept(times, alpha)
        assert np.abs(wrap(swept[:, 2] - graph.poses[:, 2])).max() < 1e-9
        after = graph.placed_energy(swept)
        assert after <= before * (1 + 1e-9) + 1e-12
        before = after
    disturb(graph, 0.0, math.pi)
    before = graph.turned_energy(graph.poses)
    for times in (1, 2, 5):
        after = graph.turned_energy(graph.swept(times, alpha))
        assert after <= before * (1 + 1e-9) + 1e-12
        before = after


@settings(max_examples=30)
@given(graphs())
@pytest.mark.slow
def test_sweeps_and_solution_agree(graph: Graph) -> None:
    disturb(graph, 0.5, 0.3)
    solved = graph.solved(rounds=4)
    swept = graph.swept(20_000)
    assert np.abs(wrap(swept[:, 2] - solved[:, 2])).max() < 1e-5
    assert np.abs(swept[:, :2] - solved[:, :2]).max() < 1e-4
    graph.poses = solved
    assert np.abs(graph.swept(3)[:, :2] - solved[:, :2]).max() < 1e-9  # a fixed point of the sweeps


@EXAMPLES
@given(graphs(), st.floats(0.0, 0.95))
def test_the_first_experience_stays_and_nothing_diverges(graph: Graph, alpha: float) -> None:
    disturb(graph, 5.0, math.pi)
    first = graph.poses[0].copy()
    farthest = np.abs(graph.poses[:, :2]).max() + np.hypot(*graph.moves[:, :2].T).sum()
    for poses in (graph.swept(400, alpha), graph.solved()):
        assert np.array_equal(poses[0], first)
        assert np.abs(poses[:, :2]).max() < 3 * farthest
        assert np.abs(poses[:, 2]).max() <= math.pi + 1e-9


def literal_sweep(graph: Graph, alpha: float) -> np.ndarray:
    """B13-B14, then B12, node by node, each over 2 alpha / sum of weights."""
    poses = graph.poses.copy()
    for i in range(1, len(poses)):
        step, total = np.zeros(2), 0.0
        for (a, b), move, weight in zip(graph.links, graph.moves, graph.weights, strict=True):
            ahead = turned(poses[a : a + 1, 2], move[None])[0]
            if i == b:
                step += weight * (poses[a, :2] + ahead - poses[i, :2])
                total += weight
            if i == a:
                step += weight * (poses[b, :2] - ahead - poses[i, :2])
                total += weight
        poses[i, :2] += 2 * alpha * step / total
    for i in range(1, len(poses)):
        turn = total = 0.0
        for (a, b), move, weight in zip(graph.links, graph.moves, graph.weights, strict=True):
            if i == b:
                turn += weight * float(wrap(poses[a, 2] + move[2] - poses[i, 2]))
                total += weight
            if i == a:
                turn += weight * float(wrap(poses[b, 2] - move[2] - poses[i, 2]))
                total += weight
        poses[i, 2] = wrap(poses[i, 2] + 2 * alpha * turn / total)
    return poses


@also_interpreted(relaxation)
@settings(max_examples=25)
@given(graphs(), st.floats(0.0, 1.0))
def test_a_sweep_is_that_of_the_papers(graph: Graph, alpha: float) -> None:
    disturb(graph, 1.0, 0.5)
    swept, expected = graph.swept(1, alpha), literal_sweep(graph, alpha)
    assert np.abs(wrap(swept[:, 2] - expected[:, 2])).max() < 1e-9
    assert np.abs(swept[:, :2] - expected[:, :2]).max() < 1e-9


@also_interpreted(relaxation)
def test_an_experience_without_links_stays() -> None:
    poses = np.array([[0.0, 0.0, 0.0], [5.0, 5.0, 1.0], [2.0, 0.0, 0.0]])
    adjacency = Adjacency()
    for _ in poses:
        adjacency.add_node()
    adjacency.add_link(0, 2, 0)
    sweep(poses, adjacency, np.array([[1.0, 0.0, 0.5]]), np.ones(1), 0.5)
    assert poses.tolist() == [[0, 0, 0], [5, 5, 1], [1, 0, 0.5]]


@also_interpreted(pose_graph)
def test_headings_are_wrapped() -> None:
    assert pose_graph.wrapped(-math.pi) == pose_graph.wrapped(math.pi) == math.pi
    for angle in np.linspace(-math.pi, math.pi, 101):
        for turns in (-2, -1, 1, 3):
            assert abs(wrap(pose_graph.wrapped(angle + 2 * math.pi * turns) - angle)) < 1e-12
