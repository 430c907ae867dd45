"""What RatSlam requires of its parts. Any of them may be another class, in a user's own file (docs/engine.md shows three).

A part whose class is named with `disk.kind` is included in the brain's digest and file, as ours are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from ratslam_core.pose_graph.pose_graph import PoseGraph
from ratslam_core.types import Bytes, Floats, Ints, Ints32, Odometry, Packet, Pose2, Recognition, Singles


@dataclass(frozen=True, slots=True)
class Matched:
    """Where a robot is to a known experience, as another sense than the eyes measures it."""

    pose: Pose2  # in the frame of the experience
    sigma_m: float  # how far off that may be
    apart_m: float  # how far apart both scans then are, in the mean
    points: int  # of the scan with fewer


class GeometricVerification(Protocol):
    """[ours] Another sense, such as a laser, that measures where the robot is to a known experience."""

    def verified(self, map_: Any, experience: int, observation: Pose2, /) -> tuple[Pose2, float] | None:
        """The robot in the frame of the experience, and give or take what (m), near where an observation puts it.

        map_: an `ExperienceMap`. An infinite error: it is as imprecise as the observation. None: it is not there.
        """
        ...

    def match(self, map_: Any, experience: int, observation: Pose2, /) -> Matched | None:
        """The same, whether or not it is there; None where that cannot be told."""
        ...


class Room(Protocol):
    """[ours] Whether there is room for what is new: a `FamiliarGround`, or `NewGround`, where there always is."""

    @property
    def familiar(self) -> bool:
        """The place is known so well that an unknown observation becomes no view."""
        ...

    @property
    def faded(self) -> int:
        """The view whose room a new one gets, -1 for a room of its own."""
        ...


class LocalViewPart(Protocol):
    """Recognises scenes."""

    params: Any
    recognition: Recognition  # of the last `observe`
    image_change: float  # since the step before, as a share of what driving can explain; above 1 it cannot

    def __len__(self) -> int: ...

    def observe(
        self,
        image: Bytes | None,
        scene: int | None = None,
        ranges_m: Floats | None = None,
        turned_rad: float = 0.0,
        room: Room | None = None,
        /,
    ) -> Recognition:
        """The active cell for what is seen now, after a turn of which the wheels tell. When it raises a ValueError, nothing
        may have changed."""
        ...

    @property
    def column_rad(self) -> float:
        """The heading that a view shifted by a column stands for, 0 where none is told."""
        ...

    def apart_at(self, views: Ints, shifts: Ints, slack: int, /) -> tuple[Floats, Ints]:
        """How unlike each of these known views (k,) is to what was seen last, shifted by so many columns, give or take
        `slack`, in any unit; and by how many of these columns it is least unlike."""
        ...

    def difference_to(self, view: int, /) -> float:
        """How unlike a known view is to what was seen last, in the unit of `Recognition.difference`."""
        ...

    def strength(self, seen: Recognition, /) -> float:
        """How sure a recognition is, 0 to 1."""
        ...


class PoseCellsPart(Protocol):
    """Represents where the robot is. Cells have a flat index, (theta * n_y + y) * n_x + x."""

    params: Any
    shape: tuple[int, int, int]  # layers, cells along y' and x'

    @property
    def active(self) -> tuple[Ints32, Singles]:
        """Rows (x, y, theta, flat index) of the n cells with activity, shape (n, 4), and their activities, shape (n,)."""
        ...

    @property
    def slot(self) -> Ints32:
        """For each cell 1 + its row in `active`, 0 when it is not active."""
        ...

    @property
    def packets(self) -> tuple[Packet, ...]: ...
    @property
    def winner(self) -> Packet: ...

    def integrate(self, distance_m: float, turn_rad: float, /) -> None:
        """Path integration: the robot moved as its wheels say."""
        ...

    def inject(self, cells: Ints32, values: Singles, /) -> None:
        """Add activity to cells, by their flat indices."""
        ...

    def attract(self) -> Packet:
        """Let the packets compete for one step; returns the winner."""
        ...

    def cells_apart(self, x1: float, y1: float, x2: float, y2: float, /) -> float: ...
    def set_params(self, params: Any, /) -> None: ...


class ExperienceMapPart(Protocol):
    """Builds the map. The pilot and the page need more than this; for them, inherit from ExperienceMap."""

    here: int  # the experience at which the map is learnt
    carried: bool  # it knows that it was carried away, and has not been put onto the map again
    agrees: bool  # whether the last observation agreed with where the robot believed itself to be
    yaw_bias: float  # rad/s, learnt: odometry turns too far by so much
    ground: Any  # a `FamiliarGround`, or `NewGround()`, with which every observation is learnt

    def __len__(self) -> int: ...
    @property
    def active(self) -> int:
        """The experience at which it believes itself to be."""
        ...

    @property
    def lost(self) -> bool:
        """It was carried, and believes no place."""
        ...

    @property
    def local_pose(self) -> Pose2: ...
    @property
    def robot(self) -> Pose2: ...
    def declare_kidnapped(self) -> None:
        """The robot was carried, not driven."""
        ...

    def suspect_kidnap(self) -> bool:
        """Perhaps it was. False if the map cannot find that out and has to be told one or the other."""
        ...

    def declare_found(self) -> None:
        """It knows again where it is."""
        ...

    def step(
        self, packet: Packet, seen: Recognition, odometry: Odometry, behaviour: int, /, *,
        beats: int, views: LocalViewPart, verification: GeometricVerification | None,
    ) -> bool:  # fmt: skip
        """Find or make the active experience; True when it is new. The robot has moved so in each of the beats."""
        ...

    def move(self, odometry: Odometry, /) -> None:
        """The robot moved, and nothing is looked at: a tick between two beats."""
        ...

    def correct(self, beats: int, /) -> None:
        """Once in each beat."""
        ...

    def set_params(self, params: Any, evidence: Any, /) -> None: ...


class Optimiser(Protocol):
    """Moves experiences until links and map agree, a step at a time."""

    def correct(self, graph: PoseGraph, /) -> None:
        """Change `graph.poses` (n, 3) in place; the first experience stays where it is. `graph.links` and `graph.moves`
        are the constraints: where the end of each link should be, in the frame of its beginning (m, m, rad)."""
        ...


class KidnapDetectorPart(Protocol):
    """Notices that the robot was carried away, and when it knows again where it is."""

    kidnapped: bool
    sure: bool  # whether the last jump can be nothing else
    params: Any

    def observe(self, image_change: float, ranges_m: Floats | None, beats: int = 1, /) -> bool: ...
    def declare(self, experiences: int, /) -> None: ...
    def find(self) -> None: ...
    def settle(self, agrees: bool, known: int, beats: int = 1, /) -> bool:
        """Whether the robot that was lost has found itself in these beats."""
        ...
