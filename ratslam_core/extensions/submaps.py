"""[ours] A robot that was carried away maps a submap, until the evidence says where it belongs.

While the robot does not know where it is, a single false loop closure would tie what it sees now to a place where it is
not, and bend both. On a submap it maps what is there. Where the evidence is strong enough (`evidence.py`), the younger
submap is moved as a whole, and a loop closure ties the two. test_evidence.py::{
test_what_is_believed_changes_no_map_and_a_submap_is_merged_as_a_whole,test_the_younger_submap_becomes_part_of_the_older}.
A merge may be wrong, in a twin of the right place. So it is remembered which experiences came with it and how sure it was,
until the robot has driven on for long; when evidence proves that it is elsewhere, or not here, all that tied them to the
older map goes, and they are a submap again. test_evidence.py::{test_a_merge_that_proves_wrong_is_undone,
test_a_merge_is_disproved_by_what_is_missing_there}. An alarm that may be false is treated as a merge, at low odds, of what
comes after it. test_evidence.py::test_who_was_perhaps_carried_maps_on_and_is_moved_when_it_was.
With `experience_map.submaps` off there is one map, as in the papers, and a robot that is lost believes every observation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from disk import kind
from ratslam_core.pose_graph.transitions import Transitions
from ratslam_core.types import Floats, Ints, Ints32, Pose2

SURER = 0.01  # nats that each cell driven adds to the odds of a merge, as long as nothing contradicts it


@kind("merge/1")
@dataclass(slots=True)
class Merge:
    """How the robot's submap became part of an older one."""

    first: int  # this experience and all after it came with it, or were made since
    log_odds: float  # that it was right


@kind("submaps/2")
class Submaps:
    """The submap that the robot is on. Submaps have numbers, 0 for the first; `Experiences.submap` says which lies where."""

    def __init__(self) -> None:
        self.current = 0
        self.begun = 0  # how many were begun after the first
        self.merged = 0  # how many of them were merged with another
        self.merges: list[Merge] = []  # that may be undone, the oldest first

    def begin(self) -> None:
        """The robot was carried away: what it makes from now on lies on a new submap."""
        self.begun += 1
        self.current, self.merges = self.begun, []

    def move(self, cells: float, most: float) -> None:
        """The robot drove on. most: log odds of a merge above which it need no longer be undone."""
        for merge in self.merges:
            merge.log_odds += SURER * cells
        self.merges = [merge for merge in self.merges if merge.log_odds < most]

    def suspect(self, first: int, log_odds: float) -> None:
        """Perhaps the robot was carried, as the experience before `first` was the last: with these log odds it was not."""
        self.merges = [*(merge for merge in self.merges if merge.first < first), Merge(first, log_odds)]

    def confirm(self, log_odds: float) -> None:
        """The last merge was right with at least these log odds."""
        self.merges[-1].log_odds = max(self.merges[-1].log_odds, log_odds)

    def least_sure(self, experience: int = -1) -> Merge | None:
        """Of the merges since this experience was made that which is most likely to have been wrong, None if none may be."""
        since = [merge for merge in self.merges if merge.first > experience]
        return min(since, key=lambda merge: merge.log_odds, default=None)

    def merge(self, other: int, submaps: Ints32, poses: Floats, robot: Pose2, claimed: Pose2, log_odds: float) -> None:
        """The robot, which is at `robot` on the current submap, is at `claimed` on the other, with these log odds. The younger
        one moves, and becomes part of the older.

        submaps: of each experience, (n,); poses: of each, (n, 3). Both are changed in place.
        """
        younger, older = max(self.current, other), min(self.current, other)
        moved = submaps == younger
        came = self.current == younger
        move(np.flatnonzero(moved), poses, *((robot, claimed) if came else (claimed, robot)))
        self.merges = [Merge(int(np.argmax(moved)), log_odds)] if came else []
        submaps[moved] = self.current = older
        self.merged += 1

    def part(self, first: int, submaps: Ints32, t: Transitions) -> None:
        """A merge was wrong, or the robot was carried: this experience and all after it become a submap."""
        self.begin()
        came = t.ends[: t.count] >= first
        t.let_go(np.flatnonzero(came.any(axis=1) & ~came.all(axis=1)))
        submaps[first:] = self.current


def move(which: Ints, poses: Floats, robot: Pose2, claimed: Pose2) -> None:
    """Move these experiences in the map, in place and as a whole, so that `robot` comes to `claimed`."""
    way = claimed.compose(robot.inverse())
    for i in which:
        moved = way.compose(Pose2(*poses[i].tolist()))
        poses[i] = moved.x, moved.y, moved.heading_rad
