"""How far map correction trusts links that contradict each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core.extensions import exact_solver
from ratslam_core.pose_graph import relaxation
from ratslam_core.pose_graph.pose_graph import STEP_SIGMA, TURN_CELLS
from ratslam_core.pose_graph.relaxation import solve
from tests.unit.ratslam_core.literal import also_interpreted

from .pose_graphs import EXAMPLES


def carried_chain(observations: int) -> tuple[np.ndarray, np.ndarray]:
    """A straight chain whose middle link hides that the robot was carried 5 m, and observations across it.

    Returns poses and trust after settling.
    """
    true_x = np.where(np.arange(40) < 20, 0.05 * np.arange(40), 0.05 * np.arange(40) - 5.0)
    chain = [(k, k + 1) for k in range(39)]
    across = [(39 - k, k) for k in range(observations)]
    links = np.array(chain + across)
    moves = np.zeros((len(links), 3))
    moves[:39, 0] = 0.05  # what the wheels reported, also where the robot was carried
    moves[39:, 0] = [true_x[j] - true_x[i] for i, j in across]
    weights = np.array([1.0] * 39 + [0.02] * observations)
    is_chain = np.arange(len(links)) < 39
    poses = np.zeros((40, 3))
    poses[:, 0] = 0.05 * np.arange(40)
    trust = np.ones(len(links))
    for _ in range(60):
        trust = exact_solver.trust(poses, links, moves, weights, is_chain, 0.25)
        solve(poses, links, moves, weights * trust)
    return poses[:, 0] - true_x, trust


@also_interpreted(relaxation)
def test_many_observations_break_the_link_of_a_kidnap() -> None:
    off, trust = carried_chain(observations=20)
    broken = np.flatnonzero(trust[:39] < 0.5)
    assert len(broken) >= 1
    assert np.abs(off[30:]).max() < 0.3  # beyond the broken link the map is right
    assert trust[39:].min() > 0.5


def test_a_single_observation_breaks_nothing() -> None:
    off, trust = carried_chain(observations=1)
    assert trust[:39].min() > 0.5
    assert trust[39] < 0.5
    assert off[39] > 4.0


@EXAMPLES
@given(st.floats(0.01, 8.0), st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(0.1, 1.0), st.floats(0.05, 2.0))
def test_how_far_a_link_gives(times: float, bearing: float, share: float, weight: float, cell_m: float) -> None:
    """A link that is off by `times` what its kind bears: an observation then pulls as if it were off by just that much, and
    odometry is halved where it gives. Angles count as distances, and a weight of a quarter halves the error."""
    links, poses = np.array([[0, 1]]), np.zeros((2, 3))
    for chain, gives, expected in (
        (False, exact_solver.HUBER, 1 / max(times, 1.0)),
        (True, exact_solver.ODOMETRY_GIVES, 1 / (1 + times**2)),
    ):
        cells = times * gives * STEP_SIGMA / np.sqrt(weight)
        metres, turn = cells * cell_m * np.cos(share), TURN_CELLS * cells * np.sin(share)
        assert abs(turn) < np.pi
        move = np.array([[metres * np.cos(bearing), metres * np.sin(bearing), turn]])
        found = exact_solver.trust(poses, links, move, np.array([weight]), np.array([chain]), cell_m)
        assert found[0] == pytest.approx(expected, rel=1e-9)
