"""[ours] A robot that was carried away maps a submap, until the evidence says where it belongs.

While the robot does not know where it is, a single look that is believed would tie what it sees now to a place where it
is not, and bend both. On a submap it maps what is there. Where the evidence is strong enough (`evidence.py`), the younger
submap is moved as a whole, and a closure ties the two. test_evidence.py::{
test_what_is_believed_changes_no_map_and_a_submap_is_merged_as_a_whole,test_the_younger_submap_becomes_part_of_the_older}.
With `experience_map.islands` off there is one map, as in the papers, and a robot that is lost believes every look.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.types import Pose2


@kind("islands/2")
class Islands:
    """The island that the robot is on. Islands have numbers, 0 for the first; `Experiences.island` says which lies where."""

    def __init__(self) -> None:
        self.current = 0
        self.begun = 0  # how many were begun after the first
        self.joined = 0  # how many of them were joined with another

    def begin(self) -> None:
        """The robot was carried away: what it makes from now on lies on a new island."""
        self.begun += 1
        self.current = self.begun

    def join(
        self, other: int, islands: NDArray[np.int32], poses: NDArray[np.float64], robot: Pose2, claimed: Pose2
    ) -> None:
        """The robot, which is at `robot` on the current island, is at `claimed` on the other. The younger one moves, and becomes
        part of the older.

        islands: of each experience, (n,); poses: of each, (n, 3). Both are changed in place.
        """
        younger, older = max(self.current, other), min(self.current, other)
        moved = islands == younger
        move(np.flatnonzero(moved), poses, *((robot, claimed) if self.current == younger else (claimed, robot)))
        islands[moved] = self.current = older
        self.joined += 1


def move(which: NDArray[np.intp], poses: NDArray[np.float64], robot: Pose2, claimed: Pose2) -> None:
    """Move these experiences in the map, in place and as a whole, so that `robot` comes to `claimed`."""
    way = claimed.compose(robot.inverse())
    for i in which:
        moved = way.compose(Pose2(*poses[i].tolist()))
        poses[i] = moved.x, moved.y, moved.heading_rad
