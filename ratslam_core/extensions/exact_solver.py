"""[ours] The fixed point of the sweeps, computed directly from time to time while loops close.

Sweeps alone lag behind a growing map. A larger map is solved less often, so that a step costs the same on average.
Links that the map contradicts weigh less (`robust`). A disagreement that no map can explain, but a bias of the yaw rate
can, is learnt as that bias (`calibrate`). test_relaxation_sweep.py::test_sweeps_and_solution_agree,
test_experience_map_correction.py::{test_a_correction_that_was_hard_is_followed_by_a_long_rest,
test_a_very_large_map_is_swept_in_some_beats_only}. `relaxation.Relaxation` is the
plain twin: sweeps and nothing else.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.extensions import robust_closures
from ratslam_core.extensions.robust_closures import BAR, contradiction, kept
from ratslam_core.pose_graph import relaxation
from ratslam_core.pose_graph.pose_graph import STEP_SIGMA, TURN_CELLS, PoseGraph

MOST_SWEPT = 8000  # experiences a beat, on average: a larger map is swept in every second beat, or third ...
WORK_A_STEP = 1e5  # of exact corrections, on average over the beats; so much takes about half a millisecond
TRIAL = 36.0  # sigma squared; all closures are put on trial when the map leaves one of them farther off


@kind("exact solver/2")
class ExactSolver:
    """Sweeps in every step, unless the map is very large, and the exact solution in some."""

    def __init__(self) -> None:
        self._sweeps = relaxation.Relaxation()
        self._solved_at = self._closures_at_solve = 0
        self._rest_after_solve = 0.0

    def correct(self, graph: PoseGraph) -> None:
        """One step of map correction."""
        if graph.steps % (1 + len(graph) // MOST_SWEPT) == 0:
            self._sweeps.correct(graph)
        p = graph.params
        rest = max(p.solve_every, self._rest_after_solve)
        due = p.solve_every and graph.steps - self._solved_at >= rest
        if due and graph.closures > self._closures_at_solve:
            self._solve(graph)

    def _solve(self, graph: PoseGraph) -> None:
        before = graph.poses.copy()
        given_up = self._given_up(graph)
        learnt, work = self._settle(graph, None)
        if graph.params.robust and self._contradicted(graph, given_up):
            graph.poses[:] = before  # many false closures would have led it far astray, and the bias, too
            self._learn(graph, -learnt)
            share, trying = kept(*_given(graph), self._odometry(graph), graph.cell_m)
            work += trying + self._settle(graph, share)[1]
        self._solved_at, self._closures_at_solve = graph.steps, graph.closures
        self._rest_after_solve = work / WORK_A_STEP

    def _contradicted(self, graph: PoseGraph, given_up: NDArray[np.bool_]) -> bool:
        """Whether all closures are put on trial: one that was believed is left far off, or one that was given up agrees.

        One that was given up and is still far off is no news. test_graduated_trust.py::test_a_lie_is_tried_once.
        """
        t = graph.transitions
        looks = np.flatnonzero(~self._odometry(graph) & (t.weight[: t.count] > 0.0))
        off, old = contradiction(*_given(graph), looks, graph.cell_m), given_up[looks]
        far = off > TRIAL / BAR
        return bool(np.any(far & ~old) or np.any((off < 1.0) & old))

    def _given_up(self, graph: PoseGraph) -> NDArray[np.bool_]:
        """The closures in which the last trial ended without belief, and that were not measured since."""
        t = graph.transitions
        unbelieved: NDArray[np.bool_] = (t.believed[: t.count] == 0.0) & ~self._odometry(graph) & graph.params.robust
        return unbelieved

    def _odometry(self, graph: PoseGraph) -> NDArray[np.bool_]:
        return graph.transitions.chain[: graph.transitions.count]

    def _settle(self, graph: PoseGraph, share: NDArray[np.float64] | None) -> tuple[float, float]:
        """One exact correction; returns the bias it learnt (rad/s) and its work.

        share: how far each row is kept, 0 to 1; None: by how well it fits.
        """
        t, p = graph.transitions, graph.params
        poses, ends, moves, weights = _given(graph)
        turning = t.turning_s[: t.count] if p.calibrate else None
        if share is None and p.robust:
            if self._given_up(graph).any():  # the verdict of the last trial stands
                share = np.divide(t.believed[: t.count], weights, out=np.zeros(t.count), where=weights > 0.0)
            else:
                share = robust_closures.trust(poses, ends, moves, weights, self._odometry(graph), graph.cell_m)
        t.believed[: t.count] = weights if share is None else weights * share
        doubt = (STEP_SIGMA * TURN_CELLS / p.bias_sigma) ** 2  # in the unit of the weights
        believed, known = t.believed[: t.count], graph.yaw_bias
        more, work = relaxation.solve(poses, ends, moves, believed, turning, known, doubt)
        if turning is not None:
            self._learn(graph, more)
        return more, work

    def _learn(self, graph: PoseGraph, bias: float) -> None:
        """Take so much more for the bias of the yaw rate (rad/s), also in what was measured before."""
        t = graph.transitions
        graph.yaw_bias += bias
        t.move[: t.count, 2] -= bias * t.turning_s[: t.count]


def _given(
    graph: PoseGraph,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Poses, ends, moves and weights of all rows, as views."""
    t = graph.transitions
    return graph.poses, t.ends[: t.count], t.move[: t.count], t.weight[: t.count]
