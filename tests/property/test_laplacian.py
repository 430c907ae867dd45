"""Laws of the exact solution of nets: it equals that of the dense equations, whatever the net."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.pose_graph.relaxation import solve
from ratslam_core.solvers import laplacian
from ratslam_core.solvers.laplacian import Elimination, eliminate
from tests.unit.ratslam_core.literal import also_interpreted

EXAMPLES = settings(max_examples=60)


def net(seed: int, nodes: int, links: int) -> tuple[np.ndarray, np.ndarray]:
    """A tree plus `links` more, some from a node to itself and some repeated, with weights over six decades."""
    rng = np.random.default_rng(seed)
    tree = [(int(rng.integers(v)), v) for v in range(1, nodes)]
    more = rng.integers(0, nodes, (links, 2)).tolist()
    pairs = np.array([*tree, *more, *more[: links // 3]], np.int64).reshape(-1, 2)
    return pairs, 10 ** rng.uniform(-3, 3, len(pairs))


ENTANGLED = net(3, 160, 600)


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


@pytest.mark.parametrize("dense_from", [0, 8])
@also_interpreted(laplacian)
def test_a_net_that_fills_up(dense_from: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows outgrow their room and the arena outgrows its own; the rest is a matrix of several blocks, or none. It costs a
    hundredth of its cube, since it is quicker; a node that is eliminated costs the square of its neighbours."""
    monkeypatch.setattr(laplacian, "DENSE", dense_from)
    asked = np.random.default_rng(4).normal(size=160)
    expected = np.linalg.solve(dense(160, *ENTANGLED)[1:, 1:], asked[1:])
    made = taken_apart(160, *ENTANGLED)
    assert made.solve(asked)[1:] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    rest, one_by_one = len(made.rest), sum(int(made.used[v]) ** 2 for v in made.order)
    assert made.work == one_by_one + rest**3 // 100
    assert (rest > 2 * laplacian.BLOCK) is (dense_from > 0)
    assert dense_from == 0 or rest**3 > 100 * one_by_one / 2


@also_interpreted(laplacian)
def test_weights_too_far_apart_for_a_matrix() -> None:
    """Two halves of a dense net are tied by a tiny weight. Differences lose it, sums do not."""
    half = np.array([(i, j) for i in range(30) for j in range(i)])
    pairs = np.concatenate([half, half + 30, [(0, 30)]])
    weights = np.concatenate([np.ones(2 * len(half)), [1e-30]])
    made = taken_apart(60, pairs, weights)
    assert len(made.rest) == 0
    found = made.solve(np.where(np.arange(60) == 30, 1e-30, 0.0))
    assert found[30:] == pytest.approx(np.ones(30), rel=1e-9)
    assert found[:30] == pytest.approx(np.zeros(30), abs=1e-9)


def test_what_is_too_entangled_is_left_alone() -> None:
    """A rest as large as allowed is solved, and none larger."""
    rest = len(taken_apart(160, *ENTANGLED).rest)
    assert eliminate(160, *ENTANGLED, largest=rest) is not None
    assert eliminate(160, *ENTANGLED, largest=rest - 1) is None
    pairs, weights = ENTANGLED
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


def test_a_pivot_that_is_not_positive_has_no_factor() -> None:
    for matrix in ([[0.0]], [[4.0, 2.0], [2.0, 1.0]], [[np.nan]], [[-1.0]]):
        assert laplacian.factor(np.array(matrix)) is False
    assert laplacian.factor(np.array([[4.0]])) is True


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
