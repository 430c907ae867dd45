"""What RatSLAM consists of: local view, pose cells, experience map, and beside them a goal memory (IROS 2005 section III) and
pictures of occupancy (ACRA 2004 section 6.1); each the papers' or ours, as the parameters choose.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

from disk import encode
from ratslam_core.beats import Beats
from ratslam_core.experience_map.cells_only import CellsOnly
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.extensions.echo_closures import EchoClosures
from ratslam_core.extensions.exact_solver import ExactSolver
from ratslam_core.extensions.familiar_ground import FamiliarGround, NewGround
from ratslam_core.extensions.kidnap_detector import KidnapDetector, NeverKidnapped
from ratslam_core.extensions.scan_matching import ScanMatching
from ratslam_core.goal_memory import GoalMemory
from ratslam_core.local_view.recogniser import LocalView
from ratslam_core.local_view.view_links import ViewLinks, VisualAssociation
from ratslam_core.localisation import Localisation
from ratslam_core.memories import Memories
from ratslam_core.occupancy_grid import MapGrid, OccupancyGrid
from ratslam_core.params import RatSlamParams
from ratslam_core.parts import ExperienceMapPart, KidnapDetectorPart, LocalViewPart, Optimiser, PoseCellsPart
from ratslam_core.pose_cells.network import PoseCells
from ratslam_core.pose_graph.relaxation import Relaxation


class Brain:
    """The parts, their parameters, and what may be told to them between two steps. The step itself is in `slam.py`.

    Any part may be handed in (`parts.py`); the others are made from the parameters.
    """

    def __init__(
        self,
        params: RatSlamParams | None = None,
        rng: np.random.Generator | None = None,
        *,
        sonar_angles_rad: Sequence[float] = (),
        local_view: LocalViewPart | None = None,
        pose_cells: PoseCellsPart | None = None,
        experience_map: ExperienceMapPart | None = None,
        optimiser: Optimiser | None = None,
        kidnap_detector: KidnapDetectorPart | None = None,
    ) -> None:
        """sonar_angles_rad: of each sonar from straight ahead, left is positive; without sonars there is no occupancy."""
        self.params = p = params or RatSlamParams()
        self.rng = rng or np.random.default_rng(0)
        # A part that was handed in does what `parts.py` says. Code that needs more has to know its class.
        view = LocalView(p.local_view, self.rng.spawn(1)[0]) if local_view is None else local_view
        self.local_view = cast(LocalView, view)
        self.pose_cells = cast(PoseCells, PoseCells(p.pose_cells) if pose_cells is None else pose_cells)
        map_ = self._map(optimiser) if experience_map is None else experience_map
        self.experience_map = cast(ExperienceMap, map_)
        detector = KidnapDetector if p.kidnap.enabled else NeverKidnapped
        self.kidnap_detector = detector(p.kidnap) if kidnap_detector is None else kidnap_detector
        self.association = VisualAssociation(p.local_view)
        self.localisation = Localisation(self.pose_cells, self.association, p.pose_cells)
        shape, cell_m = self.pose_cells.shape, p.pose_cells.cell_m
        self.goal_memory = GoalMemory(p.goal_memory, shape, cell_m)
        self.occupancy: OccupancyGrid | None = None
        self.map_grid: MapGrid | None = None
        if len(sonar_angles_rad) > 0:
            self.occupancy = OccupancyGrid(shape, cell_m, sonar_angles_rad)
            self.map_grid = MapGrid(sonar_angles_rad)
        matches = p.experience_map.scan_matching and len(sonar_angles_rad) > 0
        self.scans = ScanMatching(sonar_angles_rad) if matches else None
        self.echo_closures = EchoClosures()
        self.memories = Memories(self.goal_memory, self.occupancy, self.map_grid, p.occupancy)
        self.beats = Beats()
        self.relocalisations: int = 0  # how often the winning packet has jumped

    def _map(self, optimiser: Optimiser | None) -> ExperienceMap:
        p = self.params.experience_map
        map_kind = ExperienceMap if p.enabled else CellsOnly
        ground = FamiliarGround if p.familiar_ground and p.enabled else NewGround
        if optimiser is None:
            optimiser = ExactSolver() if p.exact_solver else Relaxation()
        shape, cell_m = self.pose_cells.shape, self.params.pose_cells.cell_m
        return map_kind(shape, cell_m, p, optimiser, ground(), self.params.evidence)

    @property
    def view_links(self) -> ViewLinks:
        return self.association.links

    @property
    def lost(self) -> bool:
        """Whether the robot knows that it was carried away, and believes no place."""
        return self.carried and self.experience_map.lost

    @property
    def carried(self) -> bool:
        """Whether the robot knows that it was carried away, and has not been put onto the map again."""
        return self.kidnap_detector.kidnapped

    def declare_kidnapped(self) -> None:
        """[ours] The robot was carried and knows it: the image jumped although the wheels did not, or it is told so."""
        self.kidnap_detector.declare(len(self.experience_map))
        if self.carried:
            self.experience_map.declare_kidnapped()
            if self.scans is not None:
                self.scans.forget()

    def forget_view(self, view: int) -> None:
        """[ours] Forget where a view was seen: its links to pose cells, and which experiences were made with it.

        What would have happened had it led nowhere can then be seen. test_slam.py::test_a_forgotten_view_leads_nowhere.
        ValueError: there is no such view.
        """
        if not 0 <= view < len(self.local_view):
            raise ValueError(f"view must be from 0 to {len(self.local_view) - 1}, got {view}")
        self.view_links.forget(view)
        self.experience_map.forget_view(view)

    def digest(self) -> bytes:
        """SHA-256 of everything that decides what the engine will do: equal for equal histories."""
        return bytes.fromhex(encode(self).digest())

    def set_params(self, params: RatSlamParams) -> None:
        """Take new live parameters while running; ValueError when the size of the pose cells or the front end would change."""
        now, then = self.params.local_view.front_end, params.local_view.front_end
        if now != then:
            raise ValueError(f"front_end is fixed at {now!r} until a reset, got {then!r}")
        self.pose_cells.set_params(params.pose_cells)
        self.localisation.params = params.pose_cells
        self.local_view.params = params.local_view
        self.association.set_params(params.local_view)
        self.experience_map.set_params(params.experience_map, params.evidence)
        self.kidnap_detector.params = params.kidnap
        self.goal_memory.params, self.memories.params = params.goal_memory, params.occupancy
        self.params = params
