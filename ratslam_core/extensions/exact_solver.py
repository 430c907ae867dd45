"""[ours] The fixed point of the sweeps, computed directly from time to time while loops close.

Sweeps alone lag behind a growing map. A larger map is solved less often, so that a step costs the same on average.
Links that the map contradicts weigh less (`robust`). A disagreement that no map can explain, but a bias of the yaw rate
can, is learnt as that bias (`calibrate`). test_relaxation_sweep.py::test_sweeps_and_solution_agree,
test_experience_map_correction.py::test_a_correction_that_was_hard_is_followed_by_a_long_rest. `relaxation.Relaxation` is the
plain twin: sweeps and nothing else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.experience_map import relaxation
from ratslam_core.extensions.graduated_trust import contradiction, kept
from ratslam_core.params import SolverParams

if TYPE_CHECKING:
    from ratslam_core.experience_map.experience_map import ExperienceMap


@kind("exact solver/1")
class ExactSolver:
    """Sweeps in every step, and the exact solution in some."""

    def __init__(self, params: SolverParams) -> None:
        self.params = params
        self._sweeps = relaxation.Relaxation(params)
        self._solved_at = self._closures_at_solve = 0
        self._rest_after_solve = 0.0

    def correct(self, map_: ExperienceMap) -> None:
        """One step of map correction."""
        self._sweeps.correct(map_)
        p = map_.params
        rest = max(p.solve_every, self._rest_after_solve)
        due = p.solve_every and map_.steps - self._solved_at >= rest
        if due and map_.closures > self._closures_at_solve:
            self._solve(map_)

    def _solve(self, map_: ExperienceMap) -> None:
        t, p = map_.transitions, map_.params
        work = self._settle(map_, 1.0)
        rows, looks = slice(t.count), np.flatnonzero(~t.chain[: t.count] & (t.weight[: t.count] > 0.0))
        given = map_.poses, t.ends[rows], t.move[rows], t.weight[rows]
        if p.robust and self.params.closures == "graduated":
            off = contradiction(*given, looks, p.odometry_sigma, self.params)
            if off.max(initial=0.0) > self.params.closure_trial / self.params.closure_bar:
                share, more = kept(*given, t.chain[rows], p.odometry_sigma, self.params)
                work += more + self._settle(map_, share)
        self._solved_at, self._closures_at_solve = map_.steps, map_.closures
        self._rest_after_solve = work / self.params.work_a_step

    def _settle(self, map_: ExperienceMap, share: NDArray[np.float64] | float) -> float:
        """One exact correction, with what the map contradicts believed less; returns its work. share: of each row's weight."""
        t, p, poses = map_.transitions, map_.params, map_.poses
        rows = slice(t.count)
        ends, moves, turning = t.ends[rows], t.move[rows], t.turning_s[rows] if p.calibrate else None
        t.believed[rows] = t.weight[rows] * share
        if p.robust:
            t.believed[rows] *= relaxation.trust(
                poses, ends, moves, t.weight[rows], t.chain[rows], p.odometry_sigma, self.params
            )
        more, work = relaxation.solve(poses, ends, moves, t.believed[rows], turning, self.params)
        if turning is not None:
            map_.yaw_bias += more
            moves[:, 2] -= more * turning
        return work
