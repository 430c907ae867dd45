"""Laws of the exact solution of map correction on random connected graphs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core.pose_graph.relaxation import WORK_AN_EXPERIENCE, solve
from ratslam_core.solvers.laplacian import eliminate

from .pose_graphs import EXAMPLES, Graph, disturb, graphs, true_moves, turned, wrap


@EXAMPLES
@given(graphs())
def test_consistent_links_are_reproduced_exactly(graph: Graph) -> None:
    true = graph.poses.copy()
    assert np.abs(graph.swept(5) - true).max() < 1e-9
    graph.poses[1:, :2] = graph.rng.uniform(-50, 50, (len(true) - 1, 2))
    graph.poses[1:, 2] = wrap(true[1:, 2] + graph.rng.uniform(-1.5, 1.5, len(true) - 1))
    solved = graph.solved()
    assert np.abs(solved[:, :2] - true[:, :2]).max() < 1e-8
    assert np.abs(wrap(solved[:, 2] - true[:, 2])).max() < 1e-8


@EXAMPLES
@given(graphs(), st.floats(-0.05, 0.05))
def test_a_bias_of_the_yaw_rate_is_found(graph: Graph, bias: float) -> None:
    """All links are turned too far, in proportion to the seconds that the wheels turned. Loops tell by how much."""
    true = graph.poses.copy()
    loop = np.array([[0, 1], [1, 0]])
    graph.links = np.concatenate([graph.links, loop])
    graph.moves = np.concatenate([graph.moves, true_moves(true, loop)])
    graph.weights = np.concatenate([graph.weights, [1.0, 1.0]])
    turning_s = graph.rng.uniform(0.1, 10.0, len(graph.links))
    graph.moves[:, 2] = wrap(graph.moves[:, 2] + bias * turning_s)
    poses = graph.poses.copy()
    found = solve(poses, graph.links, graph.moves, graph.weights, turning_s).bias
    assert found == pytest.approx(bias, abs=1e-9)
    assert np.abs(wrap(poses[:, 2] - true[:, 2])).max() < 1e-7
    assert np.abs(poses[:, :2] - true[:, :2]).max() < 1e-6


@EXAMPLES
@given(graphs(), st.floats(-0.05, 0.05))
def test_without_a_loop_no_bias_is_found(graph: Graph, bias: float) -> None:
    """A chain agrees with any bias, so none is found."""
    tree = len(graph.poses) - 1
    graph.links, graph.moves, graph.weights = graph.links[:tree], graph.moves[:tree], graph.weights[:tree]
    turning_s = graph.rng.uniform(0.1, 10.0, tree)
    graph.moves[:, 2] = wrap(graph.moves[:, 2] + bias * turning_s)
    poses = graph.poses.copy()
    assert solve(poses, graph.links, graph.moves, graph.weights, turning_s).bias == 0.0
    i, j = graph.links.T
    assert np.abs(wrap(poses[i, 2] + graph.moves[:, 2] - poses[j, 2])).max() < 1e-8


@EXAMPLES
@given(st.floats(-0.05, 0.05), st.floats(-0.02, 0.02), st.floats(0.1, 100.0), st.floats(0.01, 1e4))
def test_a_short_loop_tells_little_of_the_bias(error: float, known: float, seconds: float, doubt: float) -> None:
    """There and back: the bias that minimises the loop's square error, and its own square times the doubt."""
    links, moves = np.array([[0, 1], [1, 0]]), np.array([[1.0, 0.0, error], [-1.0, 0.0, 0.0]])
    turning_s, weights = np.array([seconds, 0.0]), np.ones(2)
    found = solve(np.zeros((2, 3)), links, moves, weights, turning_s, known, doubt, rounds=9).bias
    # A loop of two links of weight 1 is as stiff as one of a half.
    expected = (seconds * error / 2 - doubt * known) / (seconds**2 / 2 + doubt)
    assert found == pytest.approx(expected, abs=1e-9)


@EXAMPLES
@given(graphs())
def test_the_solution_is_that_of_dense_weighted_least_squares(graph: Graph) -> None:
    disturb(graph, 1.0, 0.4)
    n, i, j = len(graph.poses), *graph.links.T
    rows = np.zeros((len(i), n))
    rows[np.arange(len(i)), j] += 1
    rows[np.arange(len(i)), i] -= 1
    root = np.sqrt(graph.weights)[:, None]
    expected = graph.poses.copy()
    for _ in range(2):
        error = wrap(expected[i, 2] + graph.moves[:, 2] - expected[j, 2])
        expected[1:, 2] += np.linalg.lstsq(root * rows[:, 1:], root[:, 0] * error, rcond=None)[0]
    error = expected[i, :2] + turned(expected[i, 2], graph.moves) - expected[j, :2]
    expected[1:, :2] += np.linalg.lstsq(root * rows[:, 1:], root * error, rcond=None)[0]
    solved = graph.solved()
    assert np.abs(wrap(solved[:, 2] - expected[:, 2])).max() < 1e-8
    assert np.abs(solved[:, :2] - expected[:, :2]).max() < 1e-7


@EXAMPLES
@given(graphs())
def test_each_experience_costs_something(graph: Graph) -> None:
    work = solve(graph.poses.copy(), graph.links, graph.moves, graph.weights).work
    net = eliminate(len(graph.poses), graph.links, graph.weights)
    assert net is not None
    assert work == pytest.approx(net.work + WORK_AN_EXPERIENCE * len(graph.poses))
    nothing, poses = np.zeros(0), graph.poses[:1].copy()  # a map without links is left alone
    assert solve(poses, np.zeros((0, 2), np.int64), np.zeros((0, 3)), nothing, nothing) == (0.0, 0.0)
    assert np.array_equal(poses, graph.poses[:1])
