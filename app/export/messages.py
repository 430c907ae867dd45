"""ROS 2 messages of what a session knows after a tick. Their definitions and their coding come from the library rosbags."""

# The message classes are made when the library is loaded, so their fields have no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from ratslam_core import Pose2

_STORE = get_typestore(Stores.ROS2_HUMBLE)
_NO_COVARIANCE = np.zeros(36)


def message(name: str, *fields: Any) -> Any:
    """A message such as "nav_msgs/Path" with its fields in order."""
    return _STORE.types[_full(name)](*fields)


def coded(name: str, content: object) -> bytes:
    """As CDR, the way ROS 2 sends it."""
    return bytes(_STORE.serialize_cdr(content, _full(name)))


def definition(name: str) -> tuple[str, str]:
    """The full name of a type and the text of its definition with all those that it is made of."""
    return _full(name), _STORE.generate_msgdef(_full(name), ros_version=2)[0]


def _full(name: str) -> str:
    return name.replace("/", "/msg/", 1)


def header(time_ns: int, frame: str) -> Any:
    return message("std_msgs/Header", stamp(time_ns), frame)


def stamp(time_ns: int) -> Any:
    return message("builtin_interfaces/Time", *divmod(time_ns, 1_000_000_000))


def vector(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:
    return message("geometry_msgs/Vector3", x, y, z)


def point(x: float, y: float) -> Any:
    return message("geometry_msgs/Point", float(x), float(y), 0.0)


def turned(heading_rad: float) -> Any:
    half = heading_rad / 2
    return message("geometry_msgs/Quaternion", 0.0, 0.0, math.sin(half), math.cos(half))


def pose(at: Pose2) -> Any:
    return message("geometry_msgs/Pose", point(at.x, at.y), turned(at.heading_rad))


def pose_stamped(time_ns: int, frame: str, at: Pose2) -> Any:
    return message("geometry_msgs/PoseStamped", header(time_ns, frame), pose(at))


def transform(time_ns: int, parent: str, child: str, at: Pose2) -> Any:
    moved = message("geometry_msgs/Transform", vector(at.x, at.y), turned(at.heading_rad))
    return message("geometry_msgs/TransformStamped", header(time_ns, parent), child, moved)


def odometry(time_ns: int, at: Pose2, speed: float, yaw_rate: float) -> Any:
    """speed, yaw_rate: as the robot is told, to the last bit; the pose is what they add up to."""
    twist = message("geometry_msgs/Twist", vector(speed), vector(z=yaw_rate))
    return message(
        "nav_msgs/Odometry", header(time_ns, "odom"), "base_link",
        message("geometry_msgs/PoseWithCovariance", pose(at), _NO_COVARIANCE),
        message("geometry_msgs/TwistWithCovariance", twist, _NO_COVARIANCE),
    )  # fmt: skip


def scan(time_ns: int, first_rad: float, step_rad: float, dt: float, most_m: float, ranges: NDArray[np.float32]) -> Any:
    """ranges: counter-clockwise from `first_rad`; NaN where nothing measures."""
    last_rad = first_rad + step_rad * (len(ranges) - 1)
    return message(
        "sensor_msgs/LaserScan", header(time_ns, "base_link"), first_rad, last_rad, step_rad, 0.0, dt, 0.0, most_m,
        ranges, np.zeros(0, np.float32),
    )  # fmt: skip


def marker(time_ns: int, number: int, kind: int, size_m: float, colour: tuple[float, float, float], ends: Any) -> Any:
    """Points (n, 2) of the map as one marker. kind: 5 for lines, each from a point to the next, 8 for points."""
    here = Pose2(0.0, 0.0, 0.0)
    return message(
        "visualization_msgs/Marker", header(time_ns, "map"), "experience map", number, kind, 0, pose(here),
        vector(size_m, size_m, size_m), message("std_msgs/ColorRGBA", *colour, 1.0),
        message("builtin_interfaces/Duration", 0, 0), False, [point(x, y) for x, y in ends], [], "",
        message("sensor_msgs/CompressedImage", header(0, ""), "", np.zeros(0, np.uint8)), [], "",
        "", message("visualization_msgs/MeshFile", "", np.zeros(0, np.uint8)), False,
    )  # fmt: skip


def floats(values: NDArray[np.float32]) -> Any:
    layout = message("std_msgs/MultiArrayLayout", [], 0)
    return message("std_msgs/Float64MultiArray", layout, values.astype(np.float64))
