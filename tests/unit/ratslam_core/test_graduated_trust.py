"""False closures are found out together, and judged anew each time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from app.evaluation.agreement import rmse
from ratslam_core import ExperienceMap, ExperienceMapParams, Packet, Pose2
from ratslam_core.extensions import exact_solver
from ratslam_core.extensions.exact_solver import BAR, SIGMA, contradiction, kept
from ratslam_core.pose_graph import relaxation
from ratslam_core.pose_graph.pose_graph import STEP_SIGMA, TURN_CELLS

from .graphs import Graph, city

CELL_M = 0.25


def solved(graph: Graph) -> NDArray[np.float64]:
    poses = graph.by_odometry()
    for _ in range(5):
        relaxation.solve(poses, graph.ends, graph.moves, np.ones(len(graph.ends)))
    return poses


def judged(graph: Graph) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    poses, ones = graph.by_odometry(), np.ones(len(graph.ends))
    share, work = kept(poses, graph.ends, graph.moves, ones, graph.odometry, CELL_M)
    assert work > 0
    return poses, share


def corrected(graph: Graph, *, robust: bool = True) -> ExperienceMap:
    """A map of these rows after ten exact corrections."""
    params = ExperienceMapParams(sweeps=0, solve_every=1, calibrate=False, robust=robust)
    map_ = ExperienceMap((36, 64, 64), CELL_M, params)
    for k, (x, y, heading) in enumerate(graph.by_odometry()):
        map_._experiences.add(Packet(0.0, 0.0, 0.0, 1.0), k, Pose2(x, y, heading))
        map_.transitions.graph.add_node()
    for (i, j), move in zip(graph.ends.tolist(), graph.moves, strict=True):
        row = map_.transitions.add(i, j, travelled=True)
        map_.transitions.measure(row, Pose2(*move.tolist()), 1.0, map_.transitions.move[row].copy(), 0.0)
    assert (map_.transitions.chain[: len(graph.ends)] == graph.odometry).all()
    correct(map_, 10)
    return map_


def correct(map_: ExperienceMap, times: int) -> None:
    for _ in range(times):
        map_.steps, map_.closures = map_.steps + 10**9, map_.closures + 1
        map_.correct()


@pytest.mark.parametrize(("false", "seed"), [(0, 3), (10, 4), (100, 3), (400, 4)])
def test_false_closures_are_found_out(false: int, seed: int) -> None:
    clean = city(800, 20, seed)
    map_ = corrected(clean.with_false(false, seed))
    assert rmse(map_.poses[:, :2], solved(clean)[:, :2]) < 0.1
    t = map_.transitions
    believed = t.believed[: t.count] / t.weight[: t.count]
    assert (believed[len(clean.ends) :] > 0.1).sum() <= 0.03 * false  # some are nearly true by chance


def test_without_robust_weights_the_map_is_bent_by_them() -> None:
    """The plain twin: every closure counts."""
    clean = city(800, 20, 3)
    map_ = corrected(clean.with_false(100, 3), robust=False)
    assert rmse(map_.poses[:, :2], solved(clean)[:, :2]) > 1.0


@given(st.floats(-9, 9), st.floats(-9, 9), st.floats(-3, 3), st.floats(1e-3, 1.0))
def test_the_bar_is_in_sigmas_of_closure_and_row(dx: float, dy: float, turn: float, weight: float) -> None:
    poses, ends = np.zeros((2, 3)), np.array([[0, 1]])
    moves = np.array([[dx, dy, turn]])
    found = contradiction(poses, ends, moves, np.array([weight]), np.array([0]), CELL_M)
    squares = (dx / CELL_M) ** 2 + (dy / CELL_M) ** 2 + (turn / TURN_CELLS) ** 2
    assert found[0] == pytest.approx(squares / (STEP_SIGMA**2 / weight + SIGMA**2) / BAR)


def test_a_false_closure_is_let_go_when_others_contradict_it() -> None:
    """One closure alone is believed. When three say otherwise it is given up, and the map straightens."""
    graph = city(60, 12, 5)
    rows = graph.odometry
    chain = Graph(graph.truth, graph.ends[rows], graph.moves[rows])
    first = Graph(chain.truth, np.vstack([chain.ends, [[0, 59]]]), np.vstack([chain.moves, [[0.0, 0.0, 0.0]]]))
    _, alone = judged(first)
    assert alone[-1] == 1.0  # nothing contradicts it but odometry, which has drifted
    ends = np.array([[1, 59], [2, 58], [3, 57], [4, 56]])
    true = np.array([graph_move(chain.truth, i, j) for i, j in ends])
    both = Graph(chain.truth, np.vstack([first.ends, ends]), np.vstack([first.moves, true]))
    poses, share = judged(both)
    assert share[len(chain.ends)] == 0.0
    assert (share[len(chain.ends) + 1 :] == 1.0).all()
    assert rmse(poses[:, :2], chain.truth[:, :2]) < 0.3


def graph_move(poses: NDArray[np.float64], i: int, j: int) -> tuple[float, float, float]:
    move = Pose2(*poses[i].tolist()).inverse().compose(Pose2(*poses[j].tolist()))
    return move.x, move.y, move.heading_rad


def test_a_lie_is_tried_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was given up is no news until it is measured again, or the map agrees with it."""
    trials: list[int] = []

    def counted(*given: Any) -> tuple[NDArray[np.float64], float]:
        trials.append(len(given[1]))
        return kept(*given)

    monkeypatch.setattr(exact_solver, "kept", counted)
    clean = city(200, 12, 3)
    lied = clean.with_false(5, 3)
    map_ = corrected(lied)
    assert len(trials) == 1
    lie = len(clean.ends)
    assert map_.transitions.believed[lie] == 0.0
    map_.transitions.believed[lie] = map_.transitions.weight[lie]  # as a passage that measures it again does
    correct(map_, 3)
    assert len(trials) == 2
    assert map_.transitions.believed[lie] == 0.0
    i, j = lied.ends[lie].tolist()
    map_.transitions.move[lie] = graph_move(map_.poses, i, j)
    correct(map_, 3)
    assert len(trials) == 3
    assert map_.transitions.believed[lie] == map_.transitions.weight[lie]


def test_trials_that_nothing_new_calls_for_change_nothing() -> None:
    """Two solutions that fit alike once took turns, since each solve tried all closures from the other one."""
    map_ = corrected(city(300, 12, 7).with_false(60, 7))
    before = map_.poses.copy()
    correct(map_, 10)
    assert np.abs(map_.poses - before).max() < 1e-3
