"""[ours] A look that would move the robot farther than it can be off is held back, and kept as a hypothesis.

Look-alikes weld places together that are metres apart. A robot that knows how far off it may be need not believe them:
it takes the place for a new one, and goes on. What it held back is not forgotten. It is a second robot in the map, which
moves by the same odometry; each sight speaks for it or against it, and when enough have agreed, the robot was wrong, and
jumps. Experiences made while in doubt are no witnesses: they would only repeat what the robot believed. A sight counts several
times where the robot knows the place that it believes in and it looks different: in a twin it looks alike.
test_gate.py::test_one_look_alike_closes_no_loop, ::test_sights_that_agree_win. With `pose_filter.gate` off every look is
believed at once, as in the papers.
"""

from __future__ import annotations

import math

from disk import kind
from ratslam_core.params import PoseFilterParams
from ratslam_core.types import Pose2, wrap_angle


@kind("gate/3")
class Gate:
    """How far looks may reach, and the hypothesis that those beyond have in common."""

    def __init__(self, params: PoseFilterParams) -> None:
        self.params = params
        self.sights = 0  # that agree on the hypothesis
        self.needed = params.gate_sights  # that must agree before it is believed
        self.known = 0  # how many experiences there were when it arose
        self._views: list[int] = []  # that were seen at these sights
        self._robot = Pose2(0.0, 0.0, 0.0)  # in the map, at the latest of these sights
        self._other = Pose2(0.0, 0.0, 0.0)  # where that put it

    def reach_m(self, sigma_m: float) -> float:
        """How far a look may move a robot whose place is uncertain by `sigma_m`."""
        p = self.params
        return max(p.snap_m, p.gate_sigma * sigma_m) if p.gate else math.inf

    def hypothesis(self, robot: Pose2) -> Pose2 | None:
        """Where the robot would be by what was held back; None without a hypothesis."""
        return self._other.compose(self._robot.inverse().compose(robot)) if self.sights else None

    def doubt(self, times: int = 1) -> None:
        """A sight spoke against the hypothesis; it counts so many times."""
        self.sights = max(self.sights - times, 0)

    def dismiss(self) -> None:
        """There is no doubt any more."""
        self.sights = 0

    def believes(
        self,
        robot: Pose2,
        claimed: Pose2,
        needed: int,
        experiences: int,
        *,
        view: int = -1,
        views: int = 1,
        beats: int = 1,
        surprised: bool = False,
    ) -> bool:
        """Weigh one look beyond reach: whether the robot should believe that it is at `claimed`, not where it believes to be.

        A sight that contradicts the hypothesis takes one away from those that agree; with the last of them, its own claim
        takes their place. needed: how many must agree; experiences: how many there are; view: what it sees; views: how
        many different ones must be among those that agree, since a robot that stands sees one thing all the time; beats: for how
        many sights this one counts, since it lasts so long; surprised: where it believes itself to be, the robot expects
        something else than it sees.
        """
        self.needed = needed
        expected = self.hypothesis(robot)
        if expected is not None and not self._alike(expected, claimed):
            self.doubt(beats)
            if self.sights > 0:
                return False
        if self.sights == 0:
            self.known, self._views = experiences, []
        if view not in self._views:
            self._views.append(view)
        self.sights += beats * (self.params.gate_surprise if surprised else 1)
        self._robot, self._other = robot, claimed
        if self.sights < needed or len(self._views) < views:
            return False
        self.dismiss()
        return True

    def _alike(self, a: Pose2, b: Pose2) -> bool:
        p = self.params
        near = math.hypot(a.x - b.x, a.y - b.y) <= p.agrees_m
        return near and abs(wrap_angle(a.heading_rad - b.heading_rad)) <= p.agrees_rad
