"""Laws of map correction on random connected graphs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import SolverParams
from ratslam_core.experience_map import relaxation
from ratslam_core.experience_map.adjacency import Adjacency
from ratslam_core.experience_map.relaxation import solve, sweep
from tests.unit.ratslam_core import literal

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
            sweep(poses, adjacency, self.links, self.moves, self.weights, alpha)
        return poses

    def solved(self, rounds: int = 2) -> np.ndarray:
        poses = self.poses.copy()
        solve(poses, self.links, self.moves, self.weights, params=SolverParams(rounds=rounds))
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
    n = len(true)
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
    assert n == len(poses)


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
@given(graphs(), st.floats(0.0, 0.95))
def test_the_first_experience_stays_and_nothing_diverges(graph: Graph, alpha: float) -> None:
    disturb(graph, 5.0, math.pi)
    first = graph.poses[0].copy()
    farthest = np.abs(graph.poses[:, :2]).max() + np.hypot(*graph.moves[:, :2].T).sum()
    for poses in (graph.swept(400, alpha), graph.solved()):
        assert np.array_equal(poses[0], first)
        assert np.abs(poses[:, :2]).max() < 3 * farthest
        assert np.abs(poses[:, 2]).max() <= math.pi + 1e-9


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


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_sweep_is_that_of_the_papers(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(relaxation, monkeypatch)

    @settings(max_examples=25)
    @given(graphs(), st.floats(0.0, 1.0))
    def agrees(graph: Graph, alpha: float) -> None:
        disturb(graph, 1.0, 0.5)
        swept, expected = graph.swept(1, alpha), literal_sweep(graph, alpha)
        assert np.abs(wrap(swept[:, 2] - expected[:, 2])).max() < 1e-9
        assert np.abs(swept[:, :2] - expected[:, :2]).max() < 1e-9

    agrees()


@pytest.mark.parametrize("interpreted", [False, True])
def test_an_experience_without_links_stays(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(relaxation, monkeypatch)
    poses = np.array([[0.0, 0.0, 0.0], [5.0, 5.0, 1.0], [2.0, 0.0, 0.0]])
    adjacency = Adjacency()
    for _ in poses:
        adjacency.add_node()
    adjacency.add_link(0, 2, 0)
    sweep(poses, adjacency, np.array([[0, 2]]), np.array([[1.0, 0.0, 0.5]]), np.ones(1), 0.5)
    assert poses.tolist() == [[0, 0, 0], [5, 5, 1], [1, 0, 0.5]]


def test_a_map_without_links_is_left_alone() -> None:
    poses = np.array([[1.0, 2.0, 3.0]])
    assert solve(poses, np.zeros((0, 2), np.int64), np.zeros((0, 3)), np.zeros(0), np.zeros(0)) == (0.0, 0.0)
    assert poses.tolist() == [[1, 2, 3]]


@pytest.mark.parametrize("interpreted", [False, True])
def test_headings_are_wrapped_and_faced_exactly(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(relaxation, monkeypatch)
    assert relaxation._wrapped(-math.pi) == math.pi
    assert relaxation._wrapped(math.pi) == math.pi
    for angle in np.linspace(-math.pi, math.pi, 1001):
        c, s = relaxation._facing(angle)
        assert (c, s) == pytest.approx((math.cos(angle), math.sin(angle)), abs=2e-14, rel=0)
        for turns in (-2, -1, 1, 3):
            assert abs(wrap(relaxation._wrapped(angle + 2 * math.pi * turns) - angle)) < 1e-12


def carried_chain(looks: int) -> tuple[np.ndarray, np.ndarray]:
    """A straight chain whose middle link hides that the robot was carried 5 m, and looks across it.

    Returns poses and trust after settling.
    """
    true_x = np.where(np.arange(40) < 20, 0.05 * np.arange(40), 0.05 * np.arange(40) - 5.0)
    chain = [(k, k + 1) for k in range(39)]
    across = [(39 - k, k) for k in range(looks)]
    links = np.array(chain + across)
    moves = np.zeros((len(links), 3))
    moves[:39, 0] = 0.05  # what the wheels reported, also where the robot was carried
    moves[39:, 0] = [true_x[j] - true_x[i] for i, j in across]
    weights = np.array([1.0] * 39 + [0.02] * looks)
    is_chain = np.arange(len(links)) < 39
    poses = np.zeros((40, 3))
    poses[:, 0] = 0.05 * np.arange(40)
    trust = np.ones(len(links))
    for _ in range(60):
        trust = relaxation.trust(poses, links, moves, weights, is_chain, 0.01, SolverParams())
        solve(poses, links, moves, weights * trust)
    return poses[:, 0] - true_x, trust


@pytest.mark.parametrize("interpreted", [False, True])
def test_many_looks_tear_the_link_of_a_kidnap(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(relaxation, monkeypatch)
    off, trust = carried_chain(looks=20)
    torn = np.flatnonzero(trust[:39] < 0.5)
    assert len(torn) >= 1
    assert np.abs(off[30:]).max() < 0.3  # beyond the torn link the map is right
    assert trust[39:].min() > 0.5


def test_a_single_look_tears_nothing() -> None:
    off, trust = carried_chain(looks=1)
    assert trust[:39].min() > 0.5
    assert trust[39] < 0.5
    assert off[39] > 4.0


@EXAMPLES
@given(st.floats(0.001, 10), st.floats(0.001, 10), st.floats(-3, 3), st.booleans())
def test_trust_falls_with_contradiction(near: float, far: float, turn: float, chain: bool) -> None:
    near, far = sorted((near, far))
    links, weights = np.array([[0, 1]]), np.array([0.5])
    poses = np.zeros((2, 3))
    trusts = [
        relaxation.trust(poses, links, np.array([[d, 0.0, turn]]), weights, np.array([chain]), 0.01, SolverParams())[0]
        for d in (near, far)
    ]
    assert 0 < trusts[1] <= trusts[0] <= 1
