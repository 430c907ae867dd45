"""[ours] Odometry between an experience and the one made before it, when the robot passed known ones in between.

These edges serve map correction only; no route takes them. Without them a stretch over known experiences, each known to
some decimetres only, interrupts the rigid chain of odometry, and the map shrinks.
test_experience_map_transitions.py::test_odometry_past_known_places_keeps_the_chain_rigid. `NoOdometryEdges` is the plain
twin: in the papers only transitions tie experiences.
"""

from __future__ import annotations

from collections.abc import Callable

from disk import kind
from ratslam_core.experience_map.preintegrated import PreintegratedOdometry
from ratslam_core.experience_map.transitions import Transitions
from ratslam_core.types import Odometry, Pose2


@kind("odometry edges/1")
class OdometryEdges:
    """Remembers the newest experience: where it was made is known exactly."""

    def __init__(self) -> None:
        self.latest = -1
        self.since = PreintegratedOdometry()

    def move(self, moved: Pose2, odometry: Odometry) -> None:
        self.since.add(moved, odometry)

    def forget(self) -> None:
        """The robot was carried away: odometry no longer ties it to the newest experience."""
        self.latest = -1

    def made(self, active: int, before: int, transitions: Transitions, weight_of: Callable[[float], float]) -> None:
        """`active` was just made, coming from `before`. weight_of: the weight of a row after a distance (m)."""
        if self.latest >= 0 and self.latest != before:
            row = transitions.add(self.latest, active, travelled=False)
            weight = weight_of(self.since.way_m)
            transitions.measure(row, self.since.moved, weight, transitions.move[row], 0.0)
            transitions.take_time(row, 0.0, self.since.turning_s)
        self.latest, self.since = active, PreintegratedOdometry()


@kind("no odometry edges/1")
class NoOdometryEdges:
    """As in the papers."""

    def move(self, _moved: Pose2, _odometry: Odometry) -> None:
        """Nothing is remembered."""

    def forget(self) -> None:
        """There is nothing to forget."""

    def made(self, _active: int, _before: int, _transitions: Transitions, _weight_of: Callable[[float], float]) -> None:
        """A transition is learnt, and nothing else."""
