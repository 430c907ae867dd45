"""[ours] A robot that was carried away begins an island: a map of its own, until many looks agree on where it lies.

Nothing is glued on a guess. While the robot does not know where it is, a single look that is believed would tie what it
sees now to a place where it is not, and bend both. On an island it maps what is there. A look at what lies on another
island is a hypothesis of how the two lie to each other (`gate.py`); when enough of them agree, the island is moved
there as a whole, and a closure joins the two. Should that prove wrong before the robot has found itself, what was made
since it was carried is moved again, and the closures that said so are dropped. test_islands.py::{
test_nothing_is_glued_on_a_guess,test_an_island_is_moved_as_a_whole,test_a_wrong_guess_is_taken_back}. Perhaps it was not
carried at all, but only came round a corner: if the image alone does not say so, looks that put it elsewhere than odometry
does must be far more (test_islands.py::test_who_was_perhaps_not_carried_asks_for_more). With
`experience_map.islands` off there is one map, as in the papers, and a robot that is lost believes every look.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.types import Pose2


@kind("islands/1")
class Islands:
    """The island that the robot is on. Islands have numbers, 0 for the first; `Experiences.island` says which lies where."""

    def __init__(self) -> None:
        self.current = 0
        self.begun = 0  # how many were begun after the first
        self.joined = 0  # how many of them were joined with another
        self.sure = True  # that the robot was carried there
        self.landed = 0  # the number of the first experience on the latest

    def begin(self, experiences: int, *, sure: bool = True) -> None:
        """The robot was carried away: what it makes from now on lies on a new island.

        experiences: how many there are; sure: nothing but being carried explains what it sees.
        """
        self.begun += 1
        self.sure = sure
        self.current, self.landed = self.begun, experiences

    def join(
        self, other: int, islands: NDArray[np.int32], poses: NDArray[np.float64], robot: Pose2, claimed: Pose2
    ) -> None:
        """Move the current island so that the robot, which is at `robot`, comes to `claimed`, and make it part of `other`.

        islands: of each experience, (n,); poses: of each, (n, 3). Both are changed in place.
        """
        own = islands == self.current
        move(np.flatnonzero(own), poses, robot, claimed)
        islands[own] = self.current = other
        self.joined += 1


def move(which: NDArray[np.intp], poses: NDArray[np.float64], robot: Pose2, claimed: Pose2) -> None:
    """Move these experiences in the map, in place and as a whole, so that `robot` comes to `claimed`."""
    way = claimed.compose(robot.inverse())
    for i in which:
        moved = way.compose(Pose2(*poses[i].tolist()))
        poses[i] = moved.x, moved.y, moved.heading_rad
