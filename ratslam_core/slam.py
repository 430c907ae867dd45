"""RatSLAM in one step: image and odometry in, place in the map out. ACRA 2004 section 4, ACRA 2006 section 3.

Beside the map it learns a goal memory (IROS 2005 section III) and pictures of occupancy (ACRA 2004 section 6.1).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from disk import encode, kind
from ratslam_core.beats import Beats, Tick
from ratslam_core.experience_map.cells_only import CellsOnly
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.extensions.exact_solver import ExactSolver
from ratslam_core.extensions.familiar_ground import FamiliarGround, NewGround
from ratslam_core.extensions.kidnap_detector import KidnapDetector, NeverKidnapped
from ratslam_core.goal_memory import GoalMemory
from ratslam_core.local_view.recogniser import NOTHING, LocalView
from ratslam_core.local_view.view_links import ViewLinks, VisualAssociation
from ratslam_core.occupancy_grid import MapGrid, OccupancyGrid
from ratslam_core.params import OccupancyParams, PoseCellParams, RatSlamParams
from ratslam_core.parts import (
    ExperienceMapPart,
    GeometricVerification,
    KidnapDetectorPart,
    LocalViewPart,
    Optimiser,
    PoseCellsPart,
)
from ratslam_core.pose_cells.network import PoseCells
from ratslam_core.pose_graph.relaxation import Relaxation
from ratslam_core.pose_graph.transitions import require_behaviour
from ratslam_core.types import Estimate, Odometry, Packet, Recognition

SNAP_CELLS = 3.0  # a longer jump of the winning packet is a relocalisation

# The stages of `RatSlam.step`, in the papers' order.
STAGES = ("view match", "injection", "path integration", "attractor", "experience", "correction", "memories")


def _nobody(_stage: str) -> None:
    """The default for `watch`: does nothing."""


@kind("ratslam/4")
class RatSlam:
    """The whole engine: local view, pose cells, experience map, and beside them goal memory and occupancy.

    Each part is the papers' or ours, as the parameters choose. Any may be handed in (`parts.py`).
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

    def step(
        self,
        image: NDArray[np.uint8] | None,
        odometry: Odometry,
        *,
        scene: int | None = None,
        behaviour: int = 0,
        ranges_m: NDArray[np.floating] | None = None,
        watch: Callable[[str], None] | None = None,
        verification: GeometricVerification | None = None,
    ) -> Estimate:
        """One iteration at the end of a movement: `odometry` is what the wheels report of it, `image` what is seen then.

        image: (h, w) or (h, w, 3) uint8; scene: its number, for the front end "scene numbers", which ignores the image;
        behaviour: 0 to 15, the local movement that led here (D 3.2); ranges_m: the sonars' ranges in m, shape
        (n_sonars,), for the front end "image and sonars", the occupancy pictures and to notice a kidnap; watch: called
        after each of STAGES with its name; it may look but change nothing; verification: drops observations that it
        does not confirm. ValueError when one of them is not valid; nothing has changed then.

        [ours] Vision, attractor and map act in beats of 0.1 s (`beats.py`). Between two beats nothing is looked at, and
        only the robot's pose in the map moves on.
        """
        require_behaviour(behaviour)
        scan, watch, map_ = self.memories.require_sonars(ranges_m), watch or _nobody, self.experience_map
        if self.beats.due(odometry.dt) == 0:
            return self._coast(self.beats.take(odometry), watch)
        seen = self.local_view.observe(image, scene, scan, self.beats.turned_by(odometry), map_.ground)
        tick = self.beats.take(odometry).without(map_.yaw_bias)
        watch("view match")
        self._notice_kidnap(scan, tick)
        packet, jumped = self.localisation.step(seen, self.local_view.strength(seen), tick, self.carried, watch)
        created = map_.step(
            packet, seen, tick.latest, behaviour, beats=tick.beats, views=self.local_view, verification=verification
        )
        self._settle(seen, created, tick)
        map_.ground.note(map_, seen, created, tick.moved, self.carried, tick.beats)
        watch("experience")
        map_.correct(tick.beats)
        watch("correction")
        self.memories.learn(tick, scan, self.pose_cells, map_, packet, jumped or self.carried)
        watch("memories")
        self.relocalisations += jumped
        return Estimate(map_.active, created, map_.robot, packet, seen, jumped)

    def _notice_kidnap(self, scan: NDArray[np.float64] | None, tick: Tick) -> None:
        if self.kidnap_detector.observe(self.local_view.image_change, scan, tick.beats):
            self.declare_kidnapped(sure=self.kidnap_detector.sure)

    def _settle(self, seen: Recognition, created: bool, tick: Tick) -> None:
        known = NOTHING if created or seen.view == NOTHING else self.experience_map.here
        map_ = self.experience_map
        if self.carried and not map_.carried:
            self.kidnap_detector.find()
        elif self.kidnap_detector.settle(map_.agrees, known, tick.beats):
            map_.declare_found()

    def _coast(self, tick: Tick, watch: Callable[[str], None]) -> Estimate:
        """A tick between two beats: the movement is kept for the next one, and the robot moves on in the map."""
        map_ = self.experience_map
        map_.move(tick.without(map_.yaw_bias).latest)
        for stage in STAGES:
            watch(stage)
        return Estimate(
            map_.active, False, map_.robot, self.pose_cells.winner, again(self.local_view.recognition), False
        )

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

    def declare_kidnapped(self, *, sure: bool = True) -> None:
        """[ours] The robot was carried and knows it: image and sonars jumped although the wheels did not, or it is told so.

        sure: nothing else can explain it.
        """
        self.kidnap_detector.declare(len(self.experience_map))
        if self.carried:
            self.experience_map.declare_kidnapped(sure=sure)

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


@kind("localisation/1")
class Localisation:
    """Moves the packets, lets views put activity there, and lets the packets compete."""

    def __init__(self, pose_cells: PoseCellsPart, association: VisualAssociation, params: PoseCellParams) -> None:
        self.pose_cells, self.association, self.params = pose_cells, association, params

    def step(
        self, seen: Recognition, strength: float, tick: Tick, lost: bool, watch: Callable[[str], None]
    ) -> tuple[Packet, bool]:
        """The winning packet at the end of the tick, and whether it has jumped.

        strength: how sure the recognition is, 0 to 1; lost: the robot knows that it was carried away; watch: called
        with the name of each stage after it.

        Several beats in one tick: what is seen at its end is seen in the last of them. The way up to there is driven beat
        by beat, then the image is associated once for each; the attractor follows every such part of a stage.
        """
        jumped = False
        for _ in range(tick.beats - 1):
            self._integrate(tick.moved)
            jumped |= self._attract()[1]
        for beat in range(tick.beats):
            if beat:
                jumped |= self._attract()[1]
            self.association.step(again(seen) if beat else seen, strength, tick.moved.dt, self.pose_cells, lost)
        watch("injection")
        self._integrate(tick.moved)
        watch("path integration")
        packet, jumps = self._attract()
        watch("attractor")
        return packet, jumped or jumps

    def _integrate(self, moved: Odometry) -> None:
        """With `yaw_bias`, the cells turn too far and the map does not: ACRA 2005 5.2, figures 8 to 10. test_biased_loop.py."""
        yaw_rate = moved.yaw_rate + (0.0 if moved.still else self.params.yaw_bias)
        self.pose_cells.integrate(moved.speed * moved.dt, yaw_rate * moved.dt)

    def _attract(self) -> tuple[Packet, bool]:
        """One step of the attractor. Returns the winner, and whether it has jumped from where it was."""
        expected, packet = self.pose_cells.winner, self.pose_cells.attract()
        jump = self.pose_cells.cells_apart(expected.x, expected.y, packet.x, packet.y)
        return packet, jump > SNAP_CELLS


def again(seen: Recognition) -> Recognition:
    """The same observation a beat later. A view that was just recruited is known by then, and equal to itself."""
    return replace(seen, recruited=False, best_view=seen.view, difference=0.0) if seen.recruited else seen


@kind("memories/2")
class Memories:
    """Gives the memories what each of them learns from."""

    def __init__(
        self,
        goal_memory: GoalMemory,
        occupancy: OccupancyGrid | None,
        map_grid: MapGrid | None,
        params: OccupancyParams,
    ) -> None:
        """params: whether the pictures are drawn."""
        self.goal_memory, self.occupancy, self.map_grid, self.params = goal_memory, occupancy, map_grid, params
        self._under_way_s = 0.0

    def require_sonars(self, ranges_m: NDArray[np.floating] | None) -> NDArray[np.float64] | None:
        """The ranges as they are needed, or a ValueError that says what is wrong with them."""
        if ranges_m is None:
            return None
        if self.occupancy is None:
            raise ValueError("ranges_m needs a RatSlam that was made with sonar_angles_rad")
        return self.occupancy.require(ranges_m)

    def learn(
        self,
        tick: Tick,
        scan: NDArray[np.float64] | None,
        pose_cells: PoseCellsPart,
        map_: ExperienceMap,
        packet: Packet,
        leapt: bool,
    ) -> None:
        """Goal memory learns while the robot drives, the occupancy pictures always.

        leapt: the way here was not driven.
        """
        self._learn_way(tick, pose_cells, leapt)
        if scan is None or self.occupancy is None or self.map_grid is None or not self.params.enabled:
            return
        for _ in range(tick.beats):
            self.occupancy.update(packet, scan)
        self.map_grid.add(map_.here, map_.pose_filter.local, scan)

    def _learn_way(self, tick: Tick, pose_cells: PoseCellsPart, leapt: bool) -> None:
        """[ours] The robot did not drive where the packet jumped, so nothing is linked across the jump.

        test_slam.py::test_a_leap_of_the_packet_is_no_way.
        """
        p = self.goal_memory.params
        if leapt and not p.over_jumps:
            self.goal_memory.interrupt()
        if p.enabled and not tick.moved.still:
            self._under_way_s += tick.moved.dt * tick.beats
            self.goal_memory.learn(*pose_cells.active, self._under_way_s)
