"""What only people are shown: where the wheels alone would be, how sure the estimate is, how a closure moved the map, and
which places of the office the map knows. Parts of a snapshot. SI units and radians.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from web.messages.brain import Pose


@dataclass(frozen=True, slots=True, eq=False)
class Ghost:
    """The robot as it would be if it believed its wheels alone, in the frame of where the run began."""

    pose: Pose
    path: NDArray[np.float32]  # (n, 2) of the last two minutes, the newest last
    office_start: Pose  # that frame in the office
    map_start: Pose  # that frame in the map, as the map is now


@dataclass(frozen=True, slots=True)
class Spread:
    """[ours] How far off the estimate may be: one standard deviation, as an ellipse around it. Map frame."""

    along_m: float
    across_m: float
    turn_rad: float  # of `along`
    by: str  # "filter" or "packet": what tells it


@dataclass(frozen=True, slots=True, eq=False)
class Closure:
    """A loop closure, with the map before it and after its correction. Map frame; n experiences were known then."""

    event: int  # its number on the timeline
    time_s: float
    start: int  # the link that closed the loop leads from this experience
    end: int  # to this one
    links: NDArray[np.int32]  # (m, 2)
    before_xy: NDArray[np.float32]  # (n, 2)
    after_xy: NDArray[np.float32]  # (n, 2), some seconds later
    moved_m: float = 0.0  # how far the experience moved that moved farthest


@dataclass(frozen=True, slots=True)
class KnownPlace:
    """A place of the office by its name, and where the map has it; None: the robot has not been near it."""

    name: str
    x: float  # office frame
    y: float
    map_xy: tuple[float, float] | None
