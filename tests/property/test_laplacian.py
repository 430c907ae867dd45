"""Laws of the exact solution of nets: it equals that of the dense equations, whatever the net."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.pose_graph.relaxation import solve
from ratslam_core.solvers import cholesky, laplacian
from ratslam_core.solvers.laplacian import Elimination, eliminate
from tests.unit.ratslam_core import literal

EXAMPLES = settings(max_examples=60)


def net(seed: int, nodes: int, links: int) -> tuple[np.ndarray, np.ndarray]:
    """A tree plus `links` more, some from a node to itself and some repeated, with weights over six decades."""
    rng = np.random.default_rng(seed)
    tree = [(int(rng.integers(v)), v) for v in range(1, nodes)]
    more = rng.integers(0, nodes, (links, 2)).tolist()
    pairs = np.array([*tree, *more, *more[: links // 3]], np.int64).reshape(-1, 2)
    return pairs, 10 ** rng.uniform(-3, 3, len(pairs))


def dense(nodes: int, links: np.ndarray, weights: np.ndarray) -> np.ndarray:
    matrix = np.zeros((nodes, nodes))
    for (i, j), w in zip(links, weights, strict=True):
        matrix[i, i] += w
        matrix[j, j] += w
        matrix[i, j] -= w
        matrix[j, i] -= w
    return matrix


def taken_apart(nodes: int, links: np.ndarray, weights: np.ndarray) -> Elimination:
    made = eliminate(nodes, links, weights)
    assert made is not None
    return made


@EXAMPLES
@given(st.integers(0, 2**32 - 1), st.integers(1, 40), st.integers(0, 120))
def test_the_solution_is_that_of_the_dense_equations(seed: int, nodes: int, links: int) -> None:
    pairs, weights = net(seed, nodes, links)
    asked = np.random.default_rng(seed + 1).normal(size=(nodes, 2))
    found = taken_apart(nodes, pairs, weights).solve(asked)
    matrix = dense(nodes, pairs, weights)
    assert found[0].tolist() == [0.0, 0.0]
    assert (matrix @ found)[1:] == pytest.approx(asked[1:], abs=1e-6 * max(1.0, float(np.abs(matrix).max())))
    assert found[1:] == pytest.approx(np.linalg.solve(matrix[1:, 1:], asked[1:]), rel=1e-6, abs=1e-6)


@EXAMPLES
@given(st.integers(0, 2**32 - 1), st.integers(2, 30), st.integers(0, 60))
def test_each_node_goes_once_and_the_order_of_links_is_no_matter(seed: int, nodes: int, links: int) -> None:
    pairs, weights = net(seed, nodes, links)
    one = taken_apart(nodes, pairs, weights)
    assert sorted([*one.order, *one.rest]) == list(range(1, nodes))
    asked = np.random.default_rng(seed + 1).normal(size=nodes)
    other = taken_apart(nodes, pairs[::-1, ::-1].copy(), weights[::-1].copy())
    assert other.solve(asked) == pytest.approx(one.solve(asked), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.parametrize("dense_from", [0, 8])
def test_a_net_that_fills_up(dense_from: int, interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows outgrow their room and the arena outgrows its own; the rest is a matrix of several blocks, or none."""
    if interpreted:
        literal.interpret(laplacian, monkeypatch)
    monkeypatch.setattr(laplacian, "DENSE", dense_from)
    pairs, weights = net(3, 160, 600)
    asked = np.random.default_rng(4).normal(size=160)
    expected = np.linalg.solve(dense(160, pairs, weights)[1:, 1:], asked[1:])
    made = taken_apart(160, pairs, weights)
    assert made.solve(asked)[1:] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert (len(made.rest) > 2 * cholesky.BLOCK) is (dense_from > 0)
    if not dense_from:
        assert made.work == sum(int(count) ** 2 for count in made.used[1:])


@pytest.mark.parametrize("interpreted", [False, True])
def test_weights_too_far_apart_for_a_matrix(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two halves of a dense net are tied by a tiny weight. Differences lose it, sums do not."""
    if interpreted:
        literal.interpret(laplacian, monkeypatch)
    half = np.array([(i, j) for i in range(30) for j in range(i)])
    pairs = np.concatenate([half, half + 30, [(0, 30)]])
    weights = np.concatenate([np.ones(2 * len(half)), [1e-30]])
    made = taken_apart(60, pairs, weights)
    assert len(made.rest) == 0
    found = made.solve(np.where(np.arange(60) == 30, 1e-30, 0.0))
    assert found[30:] == pytest.approx(np.ones(30), rel=1e-9)
    assert found[:30] == pytest.approx(np.zeros(30), abs=1e-9)


def test_what_is_too_entangled_is_left_alone() -> None:
    pairs, weights = net(3, 160, 600)
    assert eliminate(160, pairs, weights, largest=20) is None
    poses = np.random.default_rng(1).normal(size=(160, 3))
    before = poses.copy()
    solution = solve(poses, pairs, np.zeros((len(pairs), 3)), weights, largest=20)
    assert np.array_equal(poses, before)
    assert solution.bias == 0.0
    assert solution.work > 1e8


def test_a_chain_costs_no_more_than_its_length() -> None:
    chain = np.stack([np.arange(999), np.arange(1, 1000)], axis=1)
    assert taken_apart(1000, chain, np.ones(999)).work < 1010


def test_links_of_no_weight_hold_nothing() -> None:
    """Nodes 2 and 3 are linked to each other and to nothing else. They stay; the rest is as if they were not there."""
    pairs = np.array([(0, 1), (1, 2), (2, 3)])
    found = taken_apart(4, pairs, np.array([2.0, 0.0, 1.0])).solve(np.array([0.0, 3.0, 1.0, -1.0]))
    assert found[:2].tolist() == [0.0, 1.5]
    assert np.isfinite(found).all()


def test_one_node_alone() -> None:
    assert taken_apart(1, np.zeros((0, 2), np.int64), np.zeros(0)).solve(np.array([5.0])).tolist() == [0.0]


def test_a_rest_as_large_as_allowed_is_solved() -> None:
    pairs, weights = net(3, 160, 600)
    rest = len(taken_apart(160, pairs, weights).rest)
    assert eliminate(160, pairs, weights, largest=rest) is not None
    assert eliminate(160, pairs, weights, largest=rest - 1) is None


def test_the_rest_costs_its_cube() -> None:
    """A hundredth of it, since a dense matrix is quicker; a node that is eliminated costs the square of its neighbours."""
    made = taken_apart(160, *net(3, 160, 600))
    one_by_one = sum(int(made.used[v]) ** 2 for v in made.order)
    assert len(made.rest) ** 3 > 100 * one_by_one / 2
    assert made.work == one_by_one + len(made.rest) ** 3 // 100


@EXAMPLES
@given(st.integers(0, 2**32 - 1), st.integers(2, 30), st.integers(0, 60))
def test_a_link_of_no_weight_is_none(seed: int, nodes: int, links: int) -> None:
    pairs, weights = net(seed, nodes, links)
    rng = np.random.default_rng(seed + 1)
    more = rng.integers(0, nodes, (20, 2))
    one = taken_apart(nodes, pairs, weights)
    other = taken_apart(nodes, np.concatenate([pairs, more]), np.concatenate([weights, np.zeros(20)]))
    assert np.array_equal(one.order, other.order)
    assert np.array_equal(one.used, other.used)
    assert one.work == other.work
    asked = rng.normal(size=nodes)
    assert np.array_equal(one.solve(asked), other.solve(asked))


@pytest.mark.parametrize("matrix", [[[0.0]], [[4.0, 2.0], [2.0, 1.0]], [[np.nan]], [[-1.0]]])
def test_a_pivot_that_is_not_positive_has_no_factor(matrix: list[list[float]]) -> None:
    assert cholesky.factor(np.array(matrix)) is False
    assert cholesky.factor(np.array([[4.0]])) is True


def full(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    pairs = np.array([(i, j) for j in range(nodes) for i in range(j)], np.int64).reshape(-1, 2)
    return pairs, np.ones(len(pairs))


@EXAMPLES
@given(st.integers(0, 2**32 - 1), st.integers(1, 40), st.integers(0, 120), st.booleans())
def test_the_rest_begins_as_soon_as_it_is_dense(seed: int, nodes: int, links: int, entangled: bool) -> None:
    """When each of its nodes is linked to an eighth of it or more, unless it has no more than eight nodes."""
    made = taken_apart(nodes, *(full(nodes) if entangled else net(seed, nodes, links)))
    for step, v in enumerate(made.order):
        left = nodes - 1 - step
        assert left <= 8 or 8 * made.used[v] < left
    rest = len(made.rest)
    assert rest == 0 or (rest > 8 and 8 * made.used[made.rest].min() >= rest)


@pytest.mark.parametrize("nodes", [8, 9, 10, 40])
def test_a_net_of_all_links_is_dense_from_nine_nodes_on(nodes: int) -> None:
    assert len(taken_apart(nodes, *full(nodes)).rest) == (nodes - 1 if nodes - 1 > 8 else 0)
