"""The parts that the parameters choose: those of the papers or, beside them, ours."""

from __future__ import annotations

import numpy as np

from ratslam_core.experience_map.cells_only import CellsOnly
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.experience_map.relaxation import Relaxation
from ratslam_core.extensions.exact_solver import ExactSolver
from ratslam_core.extensions.familiar_ground import FamiliarGround, NewGround
from ratslam_core.extensions.kidnap_detector import KidnapDetector, NeverKidnapped
from ratslam_core.local_view.recogniser import LocalView
from ratslam_core.params import RatSlamParams
from ratslam_core.parts import KidnapDetectorPart, Optimiser
from ratslam_core.pose_cells.network import PoseCells


class StandardParts:
    def __init__(self, params: RatSlamParams, rng: np.random.Generator) -> None:
        self._params, self._rng = params, rng

    def local_view(self) -> LocalView:
        return LocalView(self._params.local_view, self._rng.spawn(1)[0])

    def pose_cells(self) -> PoseCells:
        return PoseCells(self._params.pose_cells)

    def experience_map(self, shape: tuple[int, int, int], optimiser: Optimiser | None) -> ExperienceMap:
        """optimiser: one that was handed in."""
        p = self._params
        kind = ExperienceMap if p.experience_map.enabled else CellsOnly
        ground = FamiliarGround if p.memory.familiar and p.experience_map.enabled else NewGround
        return kind(
            shape, p.pose_cells.cell_m, p.experience_map, p.pose_filter, optimiser or self.optimiser(), ground(p.memory)
        )

    def optimiser(self) -> Optimiser:
        return ExactSolver(self._params.solver) if self._params.solver.enabled else Relaxation(self._params.solver)

    def kidnap_detector(self) -> KidnapDetectorPart:
        kind = KidnapDetector if self._params.kidnap.enabled else NeverKidnapped
        return kind(self._params.kidnap, self._params.local_view)
