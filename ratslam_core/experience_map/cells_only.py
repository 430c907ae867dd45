"""No experience map, as in 2004: the packet's place in the pose cells is the robot's place."""

from __future__ import annotations

from disk import kind
from ratslam_core.experience_map.experience_map import ExperienceMap
from ratslam_core.pose_graph.transitions import moved_by
from ratslam_core.types import IDENTITY, Odometry, Packet, Recognition


@kind("cells only/1")
class CellsOnly(ExperienceMap):
    """One experience, made where the robot woke up. In its frame the winning packet's place in the pose cells is the robot's.

    A packet that leaves the network on one side comes in on the other, and with it the estimate of the robot's place.
    The network therefore has to be as large as the building. There are no links, so there are no routes.
    """

    def step(
        self, packet: Packet, seen: Recognition, odometry: Odometry, behaviour: int = 0, *,
        beats: int = 1, views: object = None, verification: object = None,
    ) -> bool:  # fmt: skip
        del odometry, behaviour, beats, views, verification  # only the packet counts
        if self.here < 0:
            self._create(packet, seen.view, IDENTITY)
            return True
        self.pose_filter.local = self._told_by_cells(0, packet)
        return False

    def move(self, odometry: Odometry) -> None:
        """Between two steps the packet stands, and the robot is where odometry leads from it."""
        self.pose_filter.move(moved_by(odometry), 0.0)

    def declare_kidnapped(self) -> None:
        """Nothing is done: only the pose cells can relocalise the robot."""

    def suspect_kidnap(self) -> bool:
        return False

    def declare_found(self) -> None:
        """Nothing was done."""
