"""What a brain learns beside its map: a goal memory (IROS 2005 section III) and pictures of occupancy (ACRA 2004 6.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.beats import Tick
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.goal_memory import GoalMemory
from ratslam_core.occupancy_grid import MapGrid, OccupancyGrid
from ratslam_core.params import OccupancyParams
from ratslam_core.parts import PoseCellsPart
from ratslam_core.types import Floats, Packet


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

    def require_sonars(self, ranges_m: NDArray[np.floating] | None) -> Floats | None:
        """The ranges as they are needed, or a ValueError that says what is wrong with them."""
        if ranges_m is None:
            return None
        if self.occupancy is None:
            raise ValueError("ranges_m needs a RatSlam that was made with sonar_angles_rad")
        return self.occupancy.require(ranges_m)

    def learn(
        self,
        tick: Tick,
        scan: Floats | None,
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
