"""Messages of ROS unpacked: pictures, odometry, gyros, scans, transforms, poses."""

from __future__ import annotations

import math
import struct
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from app.recordings.formats.pictures import require_size, unpacked
from app.recordings.formats.ros_packets import Packet
from app.recordings.formats.sensed import heading_of
from app.recordings.formats.streamed import Beams
from app.recordings.recording import Pose

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
ODOMETRY, IMU, SCAN = "nav_msgs/msg/Odometry", "sensor_msgs/msg/Imu", "sensor_msgs/msg/LaserScan"
TF, TF_OLD = "tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"
POSE, POSE_COVARIANCE = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORM = "geometry_msgs/msg/TransformStamped"
FLOATS, NUMBER = "std_msgs/msg/Float64MultiArray", "std_msgs/msg/UInt8"
STAMPED = (IMAGE, COMPRESSED, ODOMETRY, IMU, SCAN, POSE, POSE_COVARIANCE, TRANSFORM)

# Encoding of a sensor_msgs/Image -> channels, and which of them are red, green and blue.
_ENCODINGS = {
    "rgb8": (3, (0, 1, 2)), "bgr8": (3, (2, 1, 0)), "8UC3": (3, (2, 1, 0)), "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)), "8UC4": (4, (2, 1, 0)), "mono8": (1, (0, 0, 0)), "8UC1": (1, (0, 0, 0)),
}  # fmt: skip
_MOST_BEAMS = 10_000
_FAR = 1e7


@cache
def _store(ros1: bool) -> Any:
    return get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)


def message(packet: Packet) -> Any:
    """The message. ValueError: it is broken."""
    store = _store(packet.ros1)
    type_ = TF if packet.type == TF_OLD else packet.type
    try:
        return (store.deserialize_ros1 if packet.ros1 else store.deserialize_cdr)(packet.data, type_)
    except Exception as error:  # of a reader that was made for whole messages: whatever a broken one makes of it
        raise ValueError(f"cannot be unpacked as {packet.type}: {error}") from None


def stamp_ns(packet: Packet) -> int:
    """The time in its header, without unpacking the rest; 0 if there is none."""
    try:
        if packet.ros1:
            seconds, nanoseconds = struct.unpack_from("<II", packet.data, 4)
        else:
            order = "<" if packet.data[1] & 1 else ">"
            seconds, nanoseconds = struct.unpack_from(order + "iI", packet.data, 4)
    except (struct.error, IndexError):
        return 0
    return int(seconds) * 10**9 + int(nanoseconds)


def picture(packet: Packet) -> NDArray[np.uint8]:
    """RGB. ValueError: it is broken, or of a kind that is not read."""
    told = message(packet)
    if packet.type == COMPRESSED:
        return unpacked(bytes(told.data))
    if told.encoding not in _ENCODINGS:
        raise ValueError(f"a picture of encoding {str(told.encoding)[:30]!r}; {', '.join(_ENCODINGS)} are read")
    channels, order = _ENCODINGS[told.encoding]
    require_size(told.width, told.height)
    row = told.width * channels
    if told.step < row or len(told.data) < told.step * told.height:
        raise ValueError(
            f"{len(told.data)} bytes are too few for {told.width} x {told.height} pixels of {told.encoding}"
        )
    rows = told.data[: told.step * told.height].reshape(told.height, told.step)[:, :row]
    return np.ascontiguousarray(rows.reshape(told.height, told.width, channels)[:, :, list(order)])


def pose(told: Any) -> Pose:
    """Of anything with a pose or a transform in it. ValueError: it is none."""
    while hasattr(told, "pose"):
        told = told.pose
    told = getattr(told, "transform", told)
    place = told.translation if hasattr(told, "translation") else told.position
    turn = told.rotation if hasattr(told, "rotation") else told.orientation
    if not (math.hypot(place.x, place.y) < _FAR and 0.5 < math.hypot(turn.w, turn.x, turn.y, turn.z) < 2):
        raise ValueError("its pose is not finite, or far off")
    return float(place.x), float(place.y), heading_of(turn.w, turn.x, turn.y, turn.z)


def twist(told: Any) -> tuple[float, float]:
    """Speed (m/s) and yaw rate (rad/s) of an odometry message."""
    speed, yaw_rate = float(told.twist.twist.linear.x), float(told.twist.twist.angular.z)
    if not (abs(speed) < 1e3 and abs(yaw_rate) < 1e3):
        raise ValueError("its twist is not finite, or far too large")
    return speed, yaw_rate


def gyro(told: Any, up: NDArray[np.float64]) -> float:
    """The yaw rate (rad/s): the turn about what is up for the sensor, which may lie on its side."""
    rate = told.angular_velocity
    turn = float(np.dot([rate.x, rate.y, rate.z], up))
    if not abs(turn) < 1e3:
        raise ValueError("its angular velocity is not finite, or far too large")
    return turn


def scan_beams(told: Any) -> Beams:
    """ValueError: the angles are none of a laser."""
    n, start, step = len(told.ranges), float(told.angle_min), float(told.angle_increment)
    limit = float(told.range_max)
    if not (0 < n <= _MOST_BEAMS and abs(start) < 10 and abs(step) < 10 and 0 < limit < 1e6):
        raise ValueError("its angles or its range are none of a laser")
    return Beams(tuple(start + k * step for k in range(n)), limit)


def scan_ranges(told: Any, beams: int) -> NDArray[np.float64]:
    """ValueError: not as many as in the first scan."""
    ranges = np.asarray(told.ranges, np.float64)
    if len(ranges) != beams:
        raise ValueError(f"{len(ranges)} ranges, but the first scan has {beams}")
    return np.where(np.isfinite(ranges) & (ranges >= told.range_min) & (ranges < told.range_max), ranges, np.inf)
