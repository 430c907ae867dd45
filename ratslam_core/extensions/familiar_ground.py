"""[ours] Map density and pruning: ground that is recognised often enough gets no more views and experiences.

The papers' robot recruits a view for each observation that is unlike all others, and an experience for each view at a new
state of the pose cells, so its memory grows for as long as it drives, even in an office that never changes. Here each
experience knows which share of the latest observations near it were recognised. Where the shares of the experiences near the
robot add up to ENOUGH, one more would tell it nothing, and what it sees is let go: it goes on by odometry until it
recognises something again, never for long. Where a place changes, nothing is recognised any more, the shares fall, and
the new appearance is learnt. A robot that is not sure of its place learns as in the papers.
test_familiar_ground.py. `NewGround` is the plain twin: every place is new for ever.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Protocol

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.beats import weight
from ratslam_core.extensions import evidence
from ratslam_core.extensions.pose_filter import PoseFilter
from ratslam_core.extensions.submaps import Submaps
from ratslam_core.pose_graph.transitions import Transitions
from ratslam_core.types import Floats, Ints, Ints32, Odometry, Recognition, grown

ENOUGH = 0.5  # a place is familiar when the shares of recognised observations of the experiences there add up to this
OBSERVATIONS = 20  # over which that share is averaged
NEAR = 1.6  # cells; experiences this near are of one place
NEAR_RAD = math.radians(17)  # if their headings differ by no more
SURE = 1.2  # cells: only a robot whose place is known to this precision calls it familiar
VIEWS = 5  # a place of so many gets another only in the room of that which was longest not recognised
LINKS = 4  # two experiences that both have so many get none between them
MOST_NEAR = 256  # experiences near the robot that are looked at


class Map(evidence.Map, Protocol):
    """What has to be known of an experience map."""

    here: int
    agrees: bool  # whether the last observation agreed with where the robot believed itself to be
    submaps: Submaps
    pose_filter: PoseFilter

    def __len__(self) -> int: ...


@kind("familiar ground/4")
class FamiliarGround:
    """`familiar` says whether the robot is at a place that is known well enough."""

    def __init__(self) -> None:
        self.familiar = False
        self.faded = -1  # the view whose room the next one gets, -1 for none: the place has room
        # How much was not kept so far, for people to see: sights that would have become experiences, or were taken for one that
        # is near in the map; links; and views that another took the room of.
        self.let_go = {"sights": 0, "experiences_adopted": 0, "links": 0, "views_faded": 0}
        self._let_go = False  # what was seen in this step
        self._share = np.zeros(1024)
        self._unseen = np.zeros(1024, np.int64)  # counted observations near each experience since it was recognised
        self._near = np.zeros(MOST_NEAR, np.int64)
        self._found = 0

    @property
    def near(self) -> Ints:
        """The experiences near the robot that face alike; none if it is not sure of its place. A view."""
        return self._near[: self._found]

    @property
    def share(self) -> Floats:
        """For each experience, which share of the latest observations near it was recognised. A view, with room to spare."""
        return self._share

    def forget(self) -> None:
        """The robot was carried away: nothing is near."""
        self.familiar, self.faded, self._found = False, -1, 0

    def of_view(self, map_: Map, view: int) -> int:
        """The experience of this view that is nearest to the robot, of those near it; -1 for none.

        The pose cells have drifted from it, but map and image agree that the robot is there.
        test_familiar_ground.py::test_a_known_view_at_its_place_makes_no_experience.
        """
        own = self.near[map_.views[self.near] == view] if view >= 0 else self.near[:0]
        if len(own) == 0:
            return -1
        self.let_go["experiences_adopted"] += 1
        robot = map_.robot_here
        return int(own[np.argmin(np.hypot(map_.poses[own, 0] - robot.x, map_.poses[own, 1] - robot.y))])

    def prune(self) -> bool:
        """Whether to let go what was seen, which fits no experience."""
        self._let_go = self.familiar
        self.let_go["sights"] += self.familiar
        return self.familiar

    def well_tied(self, t: Transitions, i: int, j: int) -> bool:
        """Whether both experiences have as many links as a place needs, so that another between them tells nothing.

        Only links that were driven and that the map bears out count. A new experience has none, and is always tied.
        test_familiar_ground.py::test_no_place_gets_links_without_end.
        """
        tied = min(_ties(t, i), _ties(t, j)) >= LINKS
        self.let_go["links"] += tied
        return tied

    def note(self, map_: Map, seen: Recognition, created: bool, odometry: Odometry, lost: bool, beats: int = 1) -> None:
        """The end of a step: count what was seen for the place where the robot was, and look where it is now.

        Only observations on the way count, since one that lasts says no more than one; and neither do those of nothing. An
        experience that was just made begins with the mean share of those around it. beats: for how many observations this
        one counts.
        """
        while len(map_) > len(self._share):
            self._share, self._unseen = grown(self._share), grown(self._unseen)
        self.let_go["views_faded"] += seen.recruited and seen.view == self.faded
        if not odometry.still and (seen.view >= 0 or seen.familiar):
            hit = map_.agrees and not (created or self._let_go)
            _count(self._share, self._unseen, self.near, float(hit), weight(1 / OBSERVATIONS, beats), beats)
            if hit:
                self._unseen[map_.here] = 0
        if created:
            self._share[map_.here] = self._share[self.near].mean() if self._found else 0.0
        self._let_go = False
        self._look(map_, lost)

    def _look(self, map_: Map, lost: bool) -> None:
        robot, cell_m = map_.robot_here, map_.cell_m
        self.forget()
        if lost or map_.pose_filter.sigma_m > SURE * cell_m:
            return
        self._found, total = _near(
            map_.poses, map_.views, map_.submap_of, map_.submaps.current, self._share, robot.x, robot.y, robot.heading_rad,
            NEAR * cell_m, NEAR_RAD, self._near,
        )  # fmt: skip
        self.familiar = total * self._found >= ENOUGH
        if self._found >= VIEWS and not self.familiar:
            self.faded = self._oldest(map_)

    def _oldest(self, map_: Map) -> int:
        """The view of the experience near the robot that was longest not recognised; of equals, the first."""
        others = self.near[self.near != map_.here]
        return int(map_.views[others[np.argmax(self._unseen[others])]]) if len(others) else -1


@kind("new ground/2")
class NewGround:
    """As in the papers: every observation that is unlike all others is kept."""

    near = np.zeros(0, np.int64)  # no experience is known to be near
    familiar = False
    faded = -1
    let_go: Mapping[str, int] = MappingProxyType({})

    def forget(self) -> None:
        """There is nothing to forget."""

    def of_view(self, _map: Map, _view: int) -> int:
        return -1

    def prune(self) -> bool:
        return False

    def well_tied(self, _t: Transitions, _i: int, _j: int) -> bool:
        return False

    def note(
        self, _map: Map, _seen: Recognition, _created: bool, _odometry: Odometry, _lost: bool, _beats: int = 1
    ) -> None:
        """Nothing is counted."""


def _ties(t: Transitions, experience: int) -> int:
    rows = t.graph.at(experience)[0] >> 1
    return int(np.count_nonzero(t.travelled[rows] & (2 * t.believed[rows] > t.weight[rows])))


@njit(cache=True, nogil=True)
def _count(share: Floats, unseen: Ints, near: Ints, hit: float, rate: float, beats: int) -> None:
    for i in near:
        unseen[i] += beats
        share[i] += rate * (hit - share[i])


@njit(cache=True, nogil=True)
def _near(
    poses: Floats, views: Ints, submaps: Ints32, submap: int, share: Floats, x: float, y: float, heading: float,
    near_m: float, near_rad: float, out: Ints,
) -> tuple[int, float]:  # fmt: skip
    """The experiences of a submap near a place that face alike and have a view, and the sum of their shares.

    As many as there is room for in `out`.
    """
    found, total = 0, 0.0
    for i in range(len(poses)):
        dx, dy = poses[i, 0] - x, poses[i, 1] - y
        other = views[i] < 0 or submaps[i] != submap
        if other or dx * dx + dy * dy > near_m * near_m or found == len(out):
            continue
        turn = abs(poses[i, 2] - heading) % (2 * math.pi)
        if min(turn, 2 * math.pi - turn) <= near_rad:
            out[found] = i
            total += share[i]
            found += 1
    return found, total
