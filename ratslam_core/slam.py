"""RatSLAM in one step: image and odometry in, place in the map out. ACRA 2004 section 4, ACRA 2006 section 3."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ratslam_core.experience_map import ExperienceMap
from ratslam_core.goal_memory import GoalMemory
from ratslam_core.local_view import NOTHING, LocalView
from ratslam_core.occupancy_grid import MapGrid, OccupancyGrid
from ratslam_core.params import RatSlamParams
from ratslam_core.pose_cells import PoseCells
from ratslam_core.range_jump import RangeJump
from ratslam_core.transitions import require_behaviour
from ratslam_core.types import Estimate, Odometry, Recognition
from ratslam_core.view_links import ViewLinks

FOUND_AGAIN = 8  # steps
HALF_SURPRISED = 0.5  # of what the image alone needs to tell of a kidnap
# In the order in which `RatSlam.step` does them.
STAGES = ("view match", "path integration", "injection", "attractor", "experience", "correction", "memories")


class RatSlam:
    """The whole engine: local view, pose cells, experience map, and beside them goal memory and occupancy."""

    def __init__(
        self,
        params: RatSlamParams | None = None,
        rng: np.random.Generator | None = None,
        *,
        sonar_angles_rad: Sequence[float] = (),
    ) -> None:
        """sonar_angles_rad: of each sonar from straight ahead, left is positive; without sonars there is no occupancy."""
        self.params = params or RatSlamParams()
        self.rng = rng or np.random.default_rng(0)
        self.local_view = LocalView(self.params.local_view, self.rng.spawn(1)[0])
        self.view_links = ViewLinks(self.params.local_view)
        self.pose_cells = PoseCells(self.params.pose_cells)
        self.experience_map = ExperienceMap(
            self.pose_cells.shape, self.params.pose_cells.cell_m, self.params.experience_map
        )
        self.goal_memory = GoalMemory(self.params.goal_memory, self.pose_cells.shape, self.params.pose_cells.cell_m)
        self.occupancy: OccupancyGrid | None = None
        self.map_grid: MapGrid | None = None
        if len(sonar_angles_rad) > 0:
            self.occupancy = OccupancyGrid(
                self.params.occupancy, self.pose_cells.shape, self.params.pose_cells.cell_m, sonar_angles_rad
            )
            self.map_grid = MapGrid(self.params.occupancy, sonar_angles_rad)
        self._range_jump = RangeJump()
        self.relocalisations = 0
        self.learning_rate = 0.0  # of the last association
        self._time_s = self._under_way_s = 0.0
        self.lost = False
        self._known_before = self._agreed = 0
        self._learnt_s: list[float] = []  # when each view was recruited

    def step(
        self,
        image: NDArray[np.uint8] | None,
        odometry: Odometry,
        *,
        scene: int | None = None,
        behaviour: int = 0,
        ranges_m: NDArray[np.floating] | None = None,
        watch: Callable[[str], None] | None = None,
    ) -> Estimate:
        """One iteration at the end of a movement: `odometry` is what the wheels report of it, `image` what is seen then.

        image: (h, w) or (h, w, 3) uint8; scene: its number, for the front end "scene numbers", which looks
        at no image; behaviour: 0 to 15, the local movement that led here (D 3.2); ranges_m: what the
        sonars say, shape (n_sonars,), for the occupancy and to notice a kidnap; watch: called after each of STAGES with its
        name, to look and not to touch. ValueError when one of them cannot be; then nothing has changed.

        The papers' four stages; path integration comes first because the image belongs to the end of the movement [ours].
        """
        require_behaviour(behaviour)
        if ranges_m is not None:
            ranges_m = self._require_sonars(ranges_m)
        watch = watch or _nobody
        recognition = self.local_view.observe(image, scene)
        watch("view match")
        self._time_s += odometry.dt
        odometry = self._calibrated(odometry)
        if self._carried(self.local_view.surprise, self._range_jump.observe(ranges_m)):
            self.lose_track()
        self.pose_cells.integrate(odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt)
        watch("path integration")
        expected = self.pose_cells.winner
        if recognition.recruited:
            self._learnt_s.append(self._time_s)
        if recognition.view != NOTHING:
            self._associate(recognition)
        watch("injection")
        packet = self.pose_cells.attract()
        watch("attractor")
        jump = self.pose_cells.cells_apart(expected.x, expected.y, packet.x, packet.y)
        relocalised = jump > self.params.pose_cells.snap_cells
        self.relocalisations += relocalised
        created = self.experience_map.step(packet, recognition, odometry, behaviour)
        self._find_again(created, recognition.view)
        watch("experience")
        self.experience_map.correct()
        watch("correction")
        self._remember_ways(odometry, relocalised)
        if ranges_m is not None and self.occupancy is not None and self.map_grid is not None:
            self.occupancy.update(packet, ranges_m)
            self.map_grid.add(self.experience_map.active, self.experience_map.local_pose, ranges_m)
        watch("memories")
        return Estimate(
            self.experience_map.active, created, self.experience_map.robot, packet, recognition, relocalised
        )

    def digest(self) -> bytes:
        """SHA-256 of all that decides what the engine will do: equal for equal histories."""
        from ratslam_core.brain_snapshot import take_snapshot  # it knows this class

        return bytes.fromhex(take_snapshot(self).digest())

    def set_params(self, params: RatSlamParams) -> None:
        """Take new live parameters while running; ValueError when the size of the pose cells or the front end would change."""
        now, then = self.params.local_view.front_end, params.local_view.front_end
        if now != then:
            raise ValueError(f"front_end is fixed at {now!r} until a reset, got {then!r}")
        self.pose_cells.set_params(params.pose_cells)
        self.local_view.params = self.view_links.params = params.local_view
        self.experience_map.params = params.experience_map
        self.goal_memory.params = params.goal_memory
        for grid in (self.occupancy, self.map_grid):
            if grid is not None:
                grid.params = params.occupancy
        self.params = params

    def lose_track(self) -> None:
        """[ours] The robot was moved and knows it: image and sonars jumped though the wheels did not, or it is told so.

        test_slam.py::{test_a_kidnap_is_noticed_and_survived, test_sonars_help_to_notice_a_kidnap}.
        """
        self.lost, self._known_before, self._agreed = True, len(self.experience_map), 0
        self.experience_map.lose_track()

    def _find_again(self, created: bool, view: int) -> None:
        """Lost no more once experiences from before the kidnap have been recognised FOUND_AGAIN times in a row."""
        if not self.lost or view == NOTHING:
            return
        known = not created and self.experience_map.active < self._known_before
        self._agreed = self._agreed + 1 if known else 0
        self.lost = self._agreed < FOUND_AGAIN

    def _carried(self, seen: float, heard_m: float) -> bool:
        """[ours] Whether image and sonars say that the robot was carried away. Sonars alone do not: a robot that turns
        between two walls has all of them jump.

        test_slam.py::test_sonars_help_to_notice_a_kidnap.
        """
        return seen > HALF_SURPRISED and seen + self.params.local_view.range_surprise * heard_m > 1

    def _calibrated(self, odometry: Odometry) -> Odometry:
        """[ours] Odometry without the yaw bias that the map has learnt; wheels that stand have none."""
        bias = self.experience_map.yaw_bias
        if bias == 0.0 or (odometry.speed == 0 and odometry.yaw_rate == 0):
            return odometry
        return Odometry(odometry.speed, odometry.yaw_rate - bias, odometry.dt)

    def _associate(self, seen: Recognition) -> None:
        """Visual calibration by what the view is linked to, then association with where the packet is."""
        cells, activity = self.pose_cells.active
        rate = self.learning_rate = self._rate(seen)
        if seen.recruited:
            self.view_links.learn(seen.view, cells, activity, self.pose_cells.slot, rate)
        if self._time_s - self._learnt_s[seen.view] < self.params.local_view.rest:
            return
        linked, injection = self.view_links.recall(seen.view, self.lost)
        linked = linked.copy()
        self.view_links.learn(seen.view, cells, activity, self.pose_cells.slot, rate)
        self.pose_cells.inject(linked, injection)

    def _rate(self, seen: Recognition) -> float:
        """The Hebbian learning rate of this step: fixed, or adaptive.

        [ours] Adaptive, which ACRA 2004 section 6.3 names as future work: twice the rate x strength of vision (1 for a view
        like the one known, 0 at the threshold) x confidence (the winning packet's share of all activity, 0 while lost).
        What is hardly recognised, or seen while hypotheses compete, is hardly learnt; a clear sight at a sure place is
        learnt twice as fast. test_slam.py::test_the_adaptive_rate_follows_vision_and_confidence.
        """
        p = self.params.local_view
        if not p.adaptive:
            return p.learning_rate
        strength = self.local_view.strength(seen)
        return 2 * p.learning_rate * strength * (0.0 if self.lost else min(1.0, self.pose_cells.winner.mass))

    def _remember_ways(self, odometry: Odometry, relocalised: bool) -> None:
        """Goal memory learns while the robot drives. [ours] A packet that jumped has not driven: nothing is linked over it.

        test_slam.py::test_a_leap_of_the_packet_is_no_way.
        """
        if relocalised or self.lost:
            self.goal_memory.interrupt()
        if odometry.speed != 0 or odometry.yaw_rate != 0:
            self._under_way_s += odometry.dt
            self.goal_memory.learn(*self.pose_cells.active, self._under_way_s)

    def _require_sonars(self, ranges_m: NDArray[np.floating]) -> NDArray[np.float64]:
        if self.occupancy is None:
            raise ValueError("ranges_m needs a RatSlam that was made with sonar_angles_rad")
        return self.occupancy.require(ranges_m)


def _nobody(_stage: str) -> None:
    """Watches."""
