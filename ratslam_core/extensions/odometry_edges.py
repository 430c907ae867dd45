"""[ours] Between each experience and the one made before it stands odometry alone: the backbone of map correction.

Looks and odometry never share a row. A look can be wrong by decimetres, or false; odometry is right to a few per cent
unless the robot is carried. If the robot came straight from the experience made before, the way is the backbone, and no
later passage, which begins and ends with looks, is averaged into it. If it passed known ones in between, an edge of its
own, which no route takes, ties the two; the way from the known one rests on a look and can be doubted.
test_experience_map_transitions.py::test_odometry_past_known_places_keeps_the_chain_rigid,
::test_no_look_is_averaged_into_the_backbone. `NoOdometryEdges` is the plain twin: in the papers only transitions tie
experiences.
"""

from __future__ import annotations

from collections.abc import Callable

from disk import kind
from ratslam_core.pose_graph.preintegrated import PreintegratedOdometry
from ratslam_core.pose_graph.transitions import Transitions
from ratslam_core.types import Odometry, Pose2


@kind("odometry edges/1")
class OdometryEdges:
    """Remembers the newest experience: where it was made is known exactly."""

    def __init__(self) -> None:
        self.latest = -1
        self.looked = False  # since then
        self.since = PreintegratedOdometry()

    def move(self, moved: Pose2, odometry: Odometry) -> None:
        self.since.add(moved, odometry)

    def look(self) -> None:
        """A known experience was recognised: what is learnt next begins with a look."""
        self.looked = True

    def forget(self) -> None:
        """The robot was carried away: odometry no longer ties it to the newest experience."""
        self.latest = -1

    def made(self, active: int, driven: int, transitions: Transitions, weight_of: Callable[[float], float]) -> None:
        """`active` was just made; `driven` is the row of the way to it. weight_of: the weight after a distance (m)."""
        if self.latest >= 0 and self.looked:
            row = transitions.add(self.latest, active, travelled=False)
            transitions.measure(row, self.since.moved, weight_of(self.since.way_m), transitions.move[row], 0.0)
            transitions.take_time(row, 0.0, self.since.turning_s)
            transitions.chain[driven] = False
        self.latest, self.looked, self.since = active, False, PreintegratedOdometry()


@kind("no odometry edges/1")
class NoOdometryEdges:
    """As in the papers."""

    def move(self, _moved: Pose2, _odometry: Odometry) -> None:
        """Nothing is remembered."""

    def look(self) -> None:
        """Nothing is remembered."""

    def forget(self) -> None:
        """There is nothing to forget."""

    def made(self, _active: int, _driven: int, _transitions: Transitions, _weight_of: Callable[[float], float]) -> None:
        """A transition is learnt, and nothing else."""
