"""The small frozen values that go into the engine and come out of it. SI units, radians, counter-clockwise positive."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from disk import kind

# Arrays by what they hold. Docstrings give shapes and units.
Floats: TypeAlias = NDArray[np.float64]
Singles: TypeAlias = NDArray[np.float32]
Ints: TypeAlias = NDArray[np.int64]
Ints32: TypeAlias = NDArray[np.int32]
Uints32: TypeAlias = NDArray[np.uint32]
Bytes: TypeAlias = NDArray[np.uint8]
Flags: TypeAlias = NDArray[np.bool_]


def grown(array: NDArray[Any], rows: int = 0) -> NDArray[Any]:
    """A copy with so many rows, or twice as many. The new ones are 0, and take no memory before they are used."""
    more = np.zeros((rows or 2 * len(array), *array.shape[1:]), array.dtype)
    more[: len(array)] = array
    return more


def wrap_angle(angle_rad: float) -> float:
    """The same direction in (-pi, pi]."""
    wrapped = math.remainder(angle_rad, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def wrap_angles(angles_rad: Floats) -> Floats:
    """The same directions, between -pi and pi."""
    return np.remainder(angles_rad + math.pi, 2 * math.pi) - math.pi


def require_finite(name: str, value: float) -> float:
    """`value` as float, or a ValueError that names it."""
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{name} must be a finite number, got {value!r}")
    return number


@kind("odometry/1")
@dataclass(frozen=True, slots=True)
class Odometry:
    """What the wheels report for one step: forward speed (m/s), yaw rate (rad/s), duration (s)."""

    speed: float
    yaw_rate: float
    dt: float

    @property
    def still(self) -> bool:
        """Whether the wheels do not turn."""
        return self.speed == 0 and self.yaw_rate == 0

    def __post_init__(self) -> None:
        if not math.isfinite(self.speed + self.yaw_rate):  # one test for both, since two are made in each tick
            require_finite("odometry.speed", self.speed)
            require_finite("odometry.yaw_rate", self.yaw_rate)
        if not (math.isfinite(self.dt) and self.dt > 0):
            raise ValueError(f"odometry.dt must be a positive number of seconds, got {self.dt!r}")


@kind("pose/1")
@dataclass(frozen=True, slots=True)
class Pose2:
    """A planar pose: metres and a heading in (-pi, pi]. Composes like SE(2)."""

    x: float
    y: float
    heading_rad: float

    def compose(self, local: Pose2) -> Pose2:
        """`self` followed by `local`, which is given in the frame of `self`."""
        heading, x, y = self.heading_rad, local.x, local.y
        c, s = math.cos(heading), math.sin(heading)
        turned = math.remainder(heading + local.heading_rad, 2 * math.pi)
        return pose_of(self.x + c * x - s * y, self.y + s * x + c * y, math.pi if turned == -math.pi else turned)

    def inverse(self) -> Pose2:
        c, s = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return pose_of(-c * self.x - s * self.y, s * self.x - c * self.y, wrap_angle(-self.heading_rad))


_new, _set_x, _set_y, _set_heading = object.__new__, *(vars(Pose2)[name].__set__ for name in ("x", "y", "heading_rad"))


def pose_of(x: float, y: float, heading_rad: float) -> Pose2:
    """A pose in half the time, since twenty are made in each step: a frozen class looks every attribute up by its name."""
    pose = _new(Pose2)
    _set_x(pose, x)
    _set_y(pose, y)
    _set_heading(pose, heading_rad)
    return pose


IDENTITY = Pose2(0.0, 0.0, 0.0)


@kind("packet/1")
@dataclass(frozen=True, slots=True)
class Packet:
    """A packet of pose-cell activity: centre in cells (fractions), heading, share of all activity, id (0 = not tracked)."""

    x: float
    y: float
    heading_rad: float
    mass: float
    id: int = 0


@kind("recognition/2")
@dataclass(frozen=True, slots=True)
class Recognition:
    """What the local view says of one image."""

    view: int  # the active local view cell, -1 when there is nothing to see
    recruited: bool  # the cell is new
    best_view: int  # the most similar view known before, -1 when there was none
    difference: float  # mean absolute difference to it in levels of the front end, inf when there was none
    facing_rad: float | None = 0.0  # heading relative to that at which the active view was taken; None = unknown
    false_positive: bool = False  # the active view was put in the place of `best_view`, which was the right one
    familiar: bool = False  # unlike every known view, but no cell is recruited, because the place is known well


def nothing_seen() -> Recognition:
    """What the local view says where there is nothing to recognise."""
    return Recognition(-1, False, -1, math.inf)


@kind("estimate/1")
@dataclass(frozen=True, slots=True)
class Estimate:
    """What the engine believes after one step."""

    experience: int  # the active experience
    created: bool  # one was made: `ExperienceMap.here`, though it may believe itself at another
    pose_map_robot: Pose2  # in the frame of the experience map
    packet: Packet  # the winning packet
    recognition: Recognition
    relocalised: bool  # the winning packet jumped in this step
