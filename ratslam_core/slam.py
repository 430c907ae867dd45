"""RatSLAM in one step: image and odometry in, place in the map out. ACRA 2004 section 4, ACRA 2006 section 3."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from disk import encode, kind
from ratslam_core.beats import Beats, shared
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.experience_map.transitions import require_behaviour
from ratslam_core.goal_memory import GoalMemory
from ratslam_core.local_view.recogniser import NOTHING, LocalView
from ratslam_core.local_view.view_links import ViewLinks
from ratslam_core.occupancy_grid import MapGrid, OccupancyGrid
from ratslam_core.params import RatSlamParams
from ratslam_core.parts import ExperienceMapPart, KidnapDetectorPart, LocalViewPart, Optimiser, PoseCellsPart, Witness
from ratslam_core.pose_cells.network import PoseCells
from ratslam_core.standard_parts import StandardParts
from ratslam_core.types import Estimate, Odometry, Packet, Recognition, nothing_seen
from ratslam_core.visual_association import VisualAssociation

# The stages of `RatSlam.step`. In the papers the second and the third change places (`pose_cells.move_first` off).
STAGES = ("view match", "path integration", "injection", "attractor", "experience", "correction", "memories")


@kind("ratslam/3")
class RatSlam:
    """The whole engine: local view, pose cells, experience map, and beside them goal memory and occupancy.

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
        ours = StandardParts(p, self.rng)
        # A part that was handed in does what `parts.py` says. Code that needs more has to know its class.
        self.local_view = ours.local_view() if local_view is None else cast(LocalView, local_view)
        self.pose_cells = ours.pose_cells() if pose_cells is None else cast(PoseCells, pose_cells)
        shape, cell_m = self.pose_cells.shape, p.pose_cells.cell_m
        if experience_map is None:
            experience_map = ours.experience_map(shape, optimiser)
        self.experience_map = cast(ExperienceMap, experience_map)
        self.kidnap_detector = ours.kidnap_detector() if kidnap_detector is None else kidnap_detector
        self.association = VisualAssociation(p.local_view)
        self.goal_memory = GoalMemory(p.goal_memory, shape, cell_m)
        self.occupancy: OccupancyGrid | None = None
        self.map_grid: MapGrid | None = None
        if len(sonar_angles_rad) > 0:
            self.occupancy = OccupancyGrid(p.occupancy, shape, cell_m, sonar_angles_rad)
            self.map_grid = MapGrid(p.occupancy, sonar_angles_rad)
        self.beats = Beats()
        self.relocalisations = 0
        self._under_way_s = 0.0

    def step(
        self,
        image: NDArray[np.uint8] | None,
        odometry: Odometry,
        *,
        scene: int | None = None,
        behaviour: int = 0,
        ranges_m: NDArray[np.floating] | None = None,
        watch: Callable[[str], None] | None = None,
        witness: Witness | None = None,
    ) -> Estimate:
        """One iteration at the end of a movement: `odometry` is what the wheels report of it, `image` what is seen then.

        image: (h, w) or (h, w, 3) uint8; scene: its number, for the front end "scene numbers", which ignores the image;
        behaviour: 0 to 15, the local movement that led here (D 3.2); ranges_m: the sonars' ranges in m, shape
        (n_sonars,), for the front end "image and sonars", the occupancy pictures and to notice a kidnap; watch: called
        after each of STAGES with its name; it may look but change nothing; witness: looks that it does not confirm are
        none. ValueError when one of them is not valid; nothing has changed then.

        [ours] Vision, attractor and map act in beats of 0.1 s (`beats.py`). Between two beats nothing is looked at, and
        only the robot's pose in the map moves on.
        """
        require_behaviour(behaviour)
        scan = None if ranges_m is None else self._require_sonars(ranges_m)
        watch = watch or _nobody
        if self.beats.due(odometry.dt) == 0:
            return self._coast(odometry, watch)
        ground = self.experience_map.ground
        self.local_view.recruits, self.local_view.faded = not ground.familiar, ground.faded
        seen = self.local_view.observe(image, scene, scan, self.beats.turned_by(odometry))
        beats, moved = self.beats.take(odometry)
        watch("view match")
        if self.kidnap_detector.observe(self.local_view.image_change, scan, beats):
            self.declare_kidnapped(sure=self.kidnap_detector.sure)
        moved = self.experience_map.calibrated(moved)
        packet, relocalised = self._move_cells(seen, moved, beats, watch)
        self.relocalisations += relocalised
        odometry = shared(self.experience_map.calibrated(odometry), beats)
        for _ in range(beats - 1):
            self.experience_map.move(odometry)
        self.experience_map.gate.beats = beats
        self.experience_map.gate.surprised = self._misses_what_it_expects()
        foreign = self.experience_map.foreign_views
        self.experience_map.elsewhere = self.local_view.nearest_of(foreign) if len(foreign) else nothing_seen()
        heard = {} if witness is None else {"witness": witness}  # a part of a user's own need not know of it
        created = self.experience_map.step(packet, seen, odometry, behaviour, **heard)
        known = NOTHING if created or seen.view == NOTHING else self.experience_map.active
        for _ in range(beats):
            self._settle(known)
        ground.note(self.experience_map, seen, created, moved, self.lost, beats)
        watch("experience")
        for _ in range(beats):
            self.experience_map.correct()
        watch("correction")
        self._remember(moved, beats, scan, packet, relocalised)
        watch("memories")
        active, robot = self.experience_map.active, self.experience_map.robot
        return Estimate(active, created, robot, packet, seen, relocalised)

    @property
    def view_links(self) -> ViewLinks:
        return self.association.links

    @property
    def lost(self) -> bool:
        """Whether the robot knows that it was carried away and has not found itself again."""
        return self.kidnap_detector.kidnapped

    def declare_kidnapped(self, *, sure: bool = True) -> None:
        """[ours] The robot was carried and knows it: image and sonars jumped although the wheels did not, or it is told so.

        sure: nothing else can explain it.
        """
        self.kidnap_detector.declare(len(self.experience_map))
        if self.lost:
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

    def _misses_what_it_expects(self) -> bool:
        """[ours] Whether a known view is seen, but the place where the robot believes itself to be is known and looks different.

        test_gate.py::test_who_misses_what_it_expects_gives_way_sooner.
        """
        map_, view, seen = self.experience_map, self.local_view, self.local_view.recognition
        if not map_.gate.sights or seen.view < 0 or seen.recruited:
            return False
        views = map_.views[map_.ground.near]
        if np.any(views == seen.view):
            return False
        limit = self.params.pose_filter.gate_unlike * view.front_end.threshold(self.params.local_view)
        return len(views) > 0 and all(view.difference_to(int(v)) > limit for v in views if v >= 0)

    def _settle(self, known: int) -> None:
        lost = self.lost
        self.kidnap_detector.settle(self.experience_map.agrees, known)
        if lost and not self.lost:
            self.experience_map.declare_found()

    def digest(self) -> bytes:
        """SHA-256 of everything that decides what the engine will do: equal for equal histories."""
        return bytes.fromhex(encode(self).digest())

    def set_params(self, params: RatSlamParams) -> None:
        """Take new live parameters while running; ValueError when the size of the pose cells or the front end would change."""
        now, then = self.params.local_view.front_end, params.local_view.front_end
        if now != then:
            raise ValueError(f"front_end is fixed at {now!r} until a reset, got {then!r}")
        self.pose_cells.set_params(params.pose_cells)
        self.local_view.params = params.local_view
        self.association.set_params(params.local_view)
        self.experience_map.set_params(params.experience_map, params.pose_filter, params.solver)
        self.experience_map.ground.params = params.memory
        self.kidnap_detector.params, self.kidnap_detector.view_params = params.kidnap, params.local_view
        self.goal_memory.params = params.goal_memory
        for grid in (self.occupancy, self.map_grid):
            if grid is not None:
                grid.params = params.occupancy
        self.params = params

    # ------------------------------------------------------------ inside

    def _coast(self, odometry: Odometry, watch: Callable[[str], None]) -> Estimate:
        """A tick between two beats: the movement is kept for the next one, and the robot moves on in the map."""
        self.beats.take(odometry)
        map_, seen = self.experience_map, self.local_view.recognition
        map_.move(map_.calibrated(odometry))
        for stage in STAGES:
            watch(stage)
        return Estimate(map_.active, False, map_.robot, self.pose_cells.winner, _again(seen), False)

    def _move_cells(
        self, seen: Recognition, odometry: Odometry, beats: int, watch: Callable[[str], None]
    ) -> tuple[Packet, bool]:
        """Path integration, association and attractor. Returns the winner, and whether it jumped.

        odometry: of one beat. Several beats in one tick: the way is driven beat by beat, and the image, which belongs
        to its end, is associated there once for each. The attractor follows every such part of a stage.
        """
        jumped = False
        for stage, do in self._cell_stages():
            for beat in range(beats):
                do(seen if beat == 0 else _again(seen), odometry)
                if beat < beats - 1:
                    jumped |= self._attract()[1]
            watch(stage)
        packet, jumps = self._attract()
        watch("attractor")
        return packet, jumped or jumps

    def _attract(self) -> tuple[Packet, bool]:
        """One step of the attractor. Returns the winner, and whether it has jumped from where it was."""
        expected, packet = self.pose_cells.winner, self.pose_cells.attract()
        jump = self.pose_cells.cells_apart(expected.x, expected.y, packet.x, packet.y)
        return packet, jump > self.params.pose_cells.snap_cells

    def _cell_stages(self) -> list[tuple[str, Callable[[Recognition, Odometry], None]]]:
        """[ours] The image belongs to the end of the movement, so path integration comes first. Otherwise every view
        would be linked one step behind. ACRA 2004 section 4 associates first. test_papers.py.
        """
        stages = [("path integration", self._integrate), ("injection", self._associate)]
        return stages if self.params.pose_cells.move_first else stages[::-1]

    def _integrate(self, _seen: Recognition, odometry: Odometry) -> None:
        """With `yaw_bias`, the cells turn too far and the map does not: ACRA 2005 5.2, figures 8 to 10. test_biased_loop.py."""
        moves = odometry.speed != 0 or odometry.yaw_rate != 0
        yaw_rate = odometry.yaw_rate + (self.params.pose_cells.yaw_bias if moves else 0.0)
        self.pose_cells.integrate(odometry.speed * odometry.dt, yaw_rate * odometry.dt)

    def _associate(self, seen: Recognition, odometry: Odometry) -> None:
        strength = self.local_view.strength(seen) if seen.view != NOTHING else 0.0
        self.association.step(seen, strength, odometry.dt, self.pose_cells, self.lost)

    def _remember(
        self, odometry: Odometry, beats: int, scan: NDArray[np.float64] | None, packet: Packet, relocalised: bool
    ) -> None:
        """Goal memory learns while the robot drives, the occupancy pictures always.

        [ours] The robot did not drive where the packet jumped, so nothing is linked across the jump.
        test_slam.py::test_a_leap_of_the_packet_is_no_way.
        """
        if (relocalised or self.lost) and not self.params.goal_memory.over_jumps:
            self.goal_memory.interrupt()
        if self.params.goal_memory.enabled and (odometry.speed != 0 or odometry.yaw_rate != 0):
            self._under_way_s += odometry.dt * beats
            self.goal_memory.learn(*self.pose_cells.active, self._under_way_s)
        if not self.params.occupancy.enabled:
            return
        if scan is not None and self.occupancy is not None and self.map_grid is not None:
            for _ in range(beats):
                self.occupancy.update(packet, scan)
            self.map_grid.add(self.experience_map.active, self.experience_map.local_pose, scan)

    def _require_sonars(self, ranges_m: NDArray[np.floating]) -> NDArray[np.float64]:
        if self.occupancy is None:
            raise ValueError("ranges_m needs a RatSlam that was made with sonar_angles_rad")
        return self.occupancy.require(ranges_m)


def _again(seen: Recognition) -> Recognition:
    """The same sight a beat later. A view that was just recruited is known by then, and equal to itself."""
    return replace(seen, recruited=False, best_view=seen.view, difference=0.0) if seen.recruited else seen


def _nobody(_stage: str) -> None:
    """The default for `watch`: does nothing."""
