"""Messages of ROS unpacked: pictures, odometry, gyros, scans, transforms, poses."""

from __future__ import annotations

import json
import math
import re
import struct
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

from app.recordings.formats.encodings import decoded
from app.recordings.formats.pictures import unpacked
from app.recordings.formats.ros_packets import Packet
from app.recordings.formats.sensed import Beams, heading_of
from app.recordings.recording import Pose

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
ODOMETRY, IMU, SCAN = "nav_msgs/msg/Odometry", "sensor_msgs/msg/Imu", "sensor_msgs/msg/LaserScan"
TF, TF_OLD = "tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"
POSE, POSE_COVARIANCE = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORM = "geometry_msgs/msg/TransformStamped"
FLOATS, NUMBER = "std_msgs/msg/Float64MultiArray", "std_msgs/msg/UInt8"
TRANSFORMS = (TF, TF_OLD)
STAMPED = (IMAGE, COMPRESSED, ODOMETRY, IMU, SCAN, POSE, POSE_COVARIANCE, TRANSFORM)

_MOST_BEAMS, _MOST_DEFINITION = 10_000, 50_000
_IDL = re.compile(r"^=+\nIDL: [A-Za-z0-9_/]+\n", re.MULTILINE)
_FAR = 1e7


@lru_cache(maxsize=2)
def _table(ros1: bool) -> Any:
    """What types usually look like. rosbags' table of ROS 1 has no transforms."""
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    for type_ in TRANSFORMS:
        if type_ not in store.types:
            store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", type_))
    return store


@lru_cache(maxsize=64)
def _store(ros1: bool, type_: str, definition: str) -> Any:
    """As the file itself defines the type, or as it usually is where the file says nothing that can be read."""
    if not 0 < len(definition) <= _MOST_DEFINITION:
        return _table(ros1)
    definition = definition.replace("\r\n", "\n")
    types: Any = {}
    try:
        if _IDL.search(definition):
            for part in _IDL.split(definition):
                types.update(get_types_from_idl(part))
        else:
            types = get_types_from_msg(definition, type_)
        store = get_typestore(Stores.EMPTY)
        store.register({name: ([], fields) for name, (_constants, fields) in types.items()})
        store.get_msgdef(type_)
    except Exception:  # of a parser that was made for definitions that are whole
        return _table(ros1)
    _require_like(type_, store.fielddefs, _table(ros1).fielddefs)
    return store


def _require_like(type_: str, told: Any, usual: Any) -> None:
    """ValueError: a field that is read is not there, or is something else."""
    fields = dict(told.get(type_, ((), ()))[1])
    for name, kind in usual[type_][1]:
        if fields.get(name) != kind:
            raise ValueError(
                f"as the file defines it, {type_} is another type: its field {name!r} is missing or different"
            )
        inner = kind if kind[0] == Nodetype.NAME else kind[1][0]
        if inner[0] == Nodetype.NAME and inner[1] not in (
            "builtin_interfaces/msg/Time",
            "builtin_interfaces/msg/Duration",
        ):
            _require_like(inner[1], told, usual)


def message(packet: Packet) -> Any:
    """The message. ValueError: it is broken."""
    store = _store(packet.ros1, packet.type, packet.definition)
    try:
        return (store.deserialize_ros1 if packet.ros1 else store.deserialize_cdr)(packet.data, packet.type)
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
        return unpacked(bytes(told.data), told.format)
    return decoded(told.encoding, told.width, told.height, told.step, told.data, bool(told.is_bigendian))


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
    if step == 0 and n > 1:
        step = (float(told.angle_max) - start) / (n - 1)
    limit = float(told.range_max)
    if n == 0:
        raise ValueError("it has no ranges")
    if not (n <= _MOST_BEAMS and abs(start) < 10 and abs(step) < 10 and 0 < limit < 1e6):
        raise ValueError("its angles or its range are none of a laser")
    return _beams(n, start, step, limit)


@lru_cache(maxsize=64)
def _beams(n: int, start: float, step: float, limit: float) -> Beams:
    return Beams(tuple(start + k * step for k in range(n)), limit)


def told_angles(packet: Packet) -> Beams:
    """Where the sonars of a run of ours look; a scan of ROS can hold only beams that are spread evenly."""
    try:
        angles: Any = json.loads(packet.data)
        beams = tuple(float(angle) for angle in angles)
    except (ValueError, TypeError, RecursionError):
        beams = ()
    return Beams(beams if len(beams) <= _MOST_BEAMS and all(abs(angle) < 10 for angle in beams) else ())


def scan_ranges(told: Any) -> NDArray[np.float64]:
    """inf: nothing in range, or no measurement."""
    ranges = np.asarray(told.ranges, np.float64)
    return np.where(np.isfinite(ranges) & (ranges >= told.range_min) & (ranges < told.range_max), ranges, np.inf)
