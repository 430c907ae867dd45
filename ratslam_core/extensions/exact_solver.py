"""[ours] The fixed point of the sweeps, computed directly from time to time while loops close, without outliers.

Sweeps alone lag behind a growing map. A larger map is solved less often, so that a step costs the same on average.
Links that the map contradicts, outliers, weigh less (`robust`). A disagreement that no map can explain, but a bias of the
yaw rate can, is learnt as that bias (`calibrate`). test_relaxation_sweep.py::test_sweeps_and_solution_agree,
test_experience_map_correction.py::{test_a_correction_that_was_hard_is_followed_by_a_long_rest,
test_a_very_large_map_is_swept_in_some_beats_only}. `relaxation.Relaxation` is the
plain twin: sweeps and nothing else.

[ours] Loop closures that no map can bring together with the others are given up, by graduated non-convexity. Odometry between
experiences made one after the other is sure; every other row rests on an observation and may be false. At first all of them
count. Then, round by round, those that the map contradicts count less, in the beginning gently, in the end wholly or not
at all (truncated least squares). So many false loop closures are found out together; and since each solution asks all of them
anew, one that was believed for a while is let go when others contradict it, and one that was given up counts again when
they agree. Yang, Antonante, Tzoumas and Carlone, RA-L 2020, eqs. 12-14.
test_graduated_trust.py::test_false_closures_are_found_out. With `experience_map.robust` off nothing is given up.
"""

from __future__ import annotations

import numpy as np

from disk import kind
from ratslam_core.pose_graph import relaxation
from ratslam_core.pose_graph.pose_graph import STEP_SIGMA, TURN_CELLS, PoseGraph, disagreement
from ratslam_core.types import Flags, Floats, Ints

MOST_SWEPT = 1000  # experiences a beat, on average: a larger map is swept in every second beat, or third ...
WORK_A_STEP = 4e4  # of exact corrections, on average over the beats; so much takes about a fifth of a millisecond
TRIAL = 36.0  # sigma squared; all loop closures are put on trial when the map leaves one of them farther off


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
            graph.poses[:] = before  # many false loop closures would have led it far astray, and the bias, too
            self._learn(graph, -learnt)
            share, trying = kept(*_given(graph), self._odometry(graph), graph.cell_m)
            work += trying + self._settle(graph, share)[1]
        self._solved_at, self._closures_at_solve = graph.steps, graph.closures
        self._rest_after_solve = work / WORK_A_STEP

    def _contradicted(self, graph: PoseGraph, given_up: Flags) -> bool:
        """Whether all closures are put on trial: one that was believed is left far off, or one that was given up agrees.

        One that was given up and is still far off is no news. test_graduated_trust.py::test_a_lie_is_tried_once.
        """
        t = graph.transitions
        observations = np.flatnonzero(~self._odometry(graph) & (t.weight[: t.count] > 0.0))
        off, old = contradiction(*_given(graph), observations, graph.cell_m), given_up[observations]
        far = off > TRIAL / BAR
        return bool(np.any(far & ~old) or np.any((off < 1.0) & old))

    def _given_up(self, graph: PoseGraph) -> Flags:
        """The closures in which the last trial ended without belief, and that were not measured since."""
        t = graph.transitions
        unbelieved: Flags = (t.believed[: t.count] == 0.0) & ~self._odometry(graph) & graph.params.robust
        return unbelieved

    def _odometry(self, graph: PoseGraph) -> Flags:
        return graph.transitions.chain[: graph.transitions.count]

    def _settle(self, graph: PoseGraph, share: Floats | None) -> tuple[float, float]:
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
                share = trust(poses, ends, moves, weights, self._odometry(graph), graph.cell_m)
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


def _given(graph: PoseGraph) -> tuple[Floats, Ints, Floats, Floats]:
    """Poses, ends, moves and weights of all rows, as views."""
    t = graph.transitions
    return graph.poses, t.ends[: t.count], t.move[: t.count], t.weight[: t.count]


ODOMETRY_GIVES = 5.0  # sigma of disagreement at which odometry counts half
HUBER = 1.0  # sigma of disagreement from which on an observation pulls no harder


def trust(poses: Floats, links: Ints, moves: Floats, weights: Floats, chain: Flags, cell_m: float) -> Floats:
    """[ours] How far each link is believed, 0 to 1, given how well the map fits it.

    weights: STEP_SIGMA^2 / variance; cell_m: side of a cell of the pose cells; chain: rows of odometry, the others are
    observations. The pull of an observation stops growing with its error (Huber). Odometry cannot be far off, so its pull
    even falls (Cauchy). Many observations that agree thus break the one link along which the robot was carried, and a single
    one does not.
    test_relaxation_trust.py::test_many_observations_break_the_link_of_a_kidnap.
    """
    ex, ey, turn = disagreement(poses, links, moves).T
    rad_per_m, sigma_m = TURN_CELLS / cell_m, STEP_SIGMA * cell_m
    chi: Floats = np.sqrt(weights * (ex**2 + ey**2 + (turn / rad_per_m) ** 2)) / sigma_m
    odometry, observation = 1 / (1 + (chi / ODOMETRY_GIVES) ** 2), np.minimum(1, HUBER / np.maximum(chi, HUBER))
    return np.where(chain, odometry, observation)


SIGMA = 0.6  # cells: least error that a loop closure is taken to have
BAR = 9.0  # sigma squared; a loop closure that is farther off is an outlier, and given up
GROWTH = 1.4  # how much more strictly each round judges than the one before
MOST_ROUNDS = 100
DECIDED = 0.01  # a share this near to 0 or 1 no longer changes


def kept(poses: Floats, ends: Ints, moves: Floats, weights: Floats, sure: Flags, cell_m: float) -> tuple[Floats, float]:
    """How far each row is kept, 0 to 1, and the work. `poses` are changed in place, and fit the rows that are kept.

    weights: STEP_SIGMA^2 / variance; cell_m: side of a cell of the pose cells; sure: rows that are never doubted.
    """
    rows = np.flatnonzero(~sure & (weights > 0.0))
    share = np.ones(len(weights))
    work = relaxation.solve(poses, ends, moves, weights, None).work
    chi = contradiction(poses, ends, moves, weights, rows, cell_m)
    mu = 1.0 / max(2.0 * chi.max(initial=0.0) - 1.0, 1e-9)
    for _ in range(MOST_ROUNDS):
        share[rows] = np.clip(np.sqrt(mu * (mu + 1.0) / np.maximum(chi, 1e-12)) - mu, 0.0, 1.0)
        work += relaxation.solve(poses, ends, moves, weights * share, None).work
        chi = contradiction(poses, ends, moves, weights, rows, cell_m)
        if not ((share[rows] > DECIDED) & (share[rows] < 1.0 - DECIDED)).any():
            break
        mu *= GROWTH
    return share, work


def contradiction(poses: Floats, ends: Ints, moves: Floats, weights: Floats, rows: Ints, cell_m: float) -> Floats:
    """How far the map contradicts each of these rows, as a share of the bar: a row above 1 is one to give up."""
    ex, ey, turn = disagreement(poses, ends[rows], moves[rows]).T
    variance = (STEP_SIGMA * cell_m) ** 2 / weights[rows] + (SIGMA * cell_m) ** 2
    return (ex**2 + ey**2 + (turn * cell_m / TURN_CELLS) ** 2) / variance / BAR
