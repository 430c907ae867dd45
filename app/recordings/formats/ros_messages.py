"""Messages of ROS, whichever file they came from: topic, type and bytes; unpacked: pictures, odometry, gyros, scans,
transforms and poses.
"""

from __future__ import annotations

import json
import math
import re
import struct
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

from app.recordings.formats.files import ZSTD, zstd_unpacked
from app.recordings.formats.pictures import require_size, unpacked
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
SONAR_ANGLES = "angles of the sonars"  # type of a packet that is no message: what a run of ours says of itself

MOST_CHUNK = 256_000_000  # bytes, packed and unpacked; a file that claims more is not believed
_MOST_BEAMS, _MOST_DEFINITION = 10_000, 50_000  # of a scan; characters of a type's definition
_FAR = 1e7  # m


@dataclass(frozen=True, slots=True)
class Packet:
    """A message that is not unpacked yet."""

    topic: str
    type: str  # as ROS 2 writes it: nav_msgs/msg/Odometry
    ros1: bool  # packed as in ROS 1, otherwise CDR
    time_ns: int  # when it was written down
    data: bytes
    number: int  # in the file, from 0
    definition: str = ""  # of its type, where the file has it

    @property
    def where(self) -> str:
        return f"message {self.number} ({self.topic})"


def type_of(name: str) -> str:
    """The type's name as ROS 2 writes it."""
    parts = name.split("/")
    return f"{parts[0]}/msg/{parts[1]}" if len(parts) == 2 else name


def cdr_of(data: bytes) -> bytes:
    """A message of ROS 2, which `ros2 bag record --compression-mode message` packs. ValueError: it is broken."""
    return zstd_unpacked(data, MOST_CHUNK) if data.startswith(ZSTD) else data


def message(packet: Packet) -> Any:
    """It unpacked. ValueError: it is broken."""
    store = _store(packet.ros1, packet.type, packet.definition)
    try:
        return (store.deserialize_ros1 if packet.ros1 else store.deserialize_cdr)(packet.data, packet.type)
    except Exception as error:  # of a reader that was made for whole messages: whatever a broken one makes of it
        raise ValueError(f"cannot be unpacked as {packet.type}: {error}") from None


_IDL = re.compile(r"^=+\nIDL: [A-Za-z0-9_/]+\n", re.MULTILINE)


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


@lru_cache(maxsize=2)
def _table(ros1: bool) -> Any:
    """What types usually look like. rosbags' table of ROS 1 has no transforms."""
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    for type_ in TRANSFORMS:
        if type_ not in store.types:
            store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", type_))
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
        times = "builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"
        if inner[0] == Nodetype.NAME and inner[1] not in times:
            _require_like(inner[1], told, usual)


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


def scan_ranges(told: Any) -> NDArray[np.float64]:
    """inf: nothing in range, or no measurement."""
    ranges = np.asarray(told.ranges, np.float64)
    return np.where(np.isfinite(ranges) & (ranges >= told.range_min) & (ranges < told.range_max), ranges, np.inf)


def told_angles(packet: Packet) -> Beams:
    """Where the sonars of a run of ours look; a scan of ROS can hold only beams that are spread evenly."""
    try:
        angles: Any = json.loads(packet.data)
        beams = tuple(float(angle) for angle in angles)
    except (ValueError, TypeError, RecursionError):
        beams = ()
    return Beams(beams if len(beams) <= _MOST_BEAMS and all(abs(angle) < 10 for angle in beams) else ())


def picture(packet: Packet) -> NDArray[np.uint8]:
    """RGB. ValueError: it is broken, or of a kind that is not read."""
    told = message(packet)
    if packet.type == COMPRESSED:
        return unpacked(bytes(told.data), told.format)
    return decoded(told.encoding, told.width, told.height, told.step, told.data, bool(told.is_bigendian))


_Pixels = NDArray[Any]  # of 8 or 16 bits


@dataclass(frozen=True, slots=True)
class _Layout:
    """How pixels lie in memory, and what OpenCV makes RGB of them with."""

    channels: int
    code: int | None  # None: they are RGB
    depth: int = 8  # bits of each channel
    rows: tuple[int, int] = (1, 1)  # of memory for rows of the picture: planes of colour come after the grey one


def _layouts() -> dict[str, _Layout]:
    """By the names of sensor_msgs/image_encodings and of usb_cam."""
    found = {
        "rgb": _Layout(3, None), "bgr": _Layout(3, cv2.COLOR_BGR2RGB), "rgba": _Layout(4, cv2.COLOR_RGBA2RGB),
        "bgra": _Layout(4, cv2.COLOR_BGRA2RGB), "mono": _Layout(1, cv2.COLOR_GRAY2RGB),
    }  # fmt: skip
    for pattern in ("rggb", "bggr", "gbrg", "grbg"):
        found[f"bayer_{pattern}"] = _Layout(1, getattr(cv2, f"COLOR_Bayer{pattern.upper()}2RGB"))
    layouts = {
        f"{name}{depth}": _Layout(it.channels, it.code, depth) for name, it in found.items() for depth in (8, 16)
    }
    for depth in (8, 16):
        of_type = {1: "mono", 3: "bgr", 4: "bgra"}  # as cv_bridge takes pictures that say their type alone
        layouts |= {f"{depth}uc{n}": layouts[f"{name}{depth}"] for n, name in of_type.items()}
    uyvy, yuyv = _Layout(2, cv2.COLOR_YUV2RGB_UYVY), _Layout(2, cv2.COLOR_YUV2RGB_YUYV)
    layouts |= dict.fromkeys(("yuv422", "uyvy", "uyvy8", "yuv422_uyvy"), uyvy)
    layouts |= dict.fromkeys(("yuv422_yuy2", "yuy2", "yuyv", "yuyv8", "yuv422_yuyv"), yuyv)
    layouts |= {"yvyu": _Layout(2, cv2.COLOR_YUV2RGB_YVYU), "yuv444": _Layout(3, cv2.COLOR_YUV2RGB)}
    for names, code in (
        (("nv12",), cv2.COLOR_YUV2RGB_NV12), (("nv21",), cv2.COLOR_YUV2RGB_NV21), (("yv12",), cv2.COLOR_YUV2RGB_YV12),
        (("i420", "iyuv", "yuv420", "yu12"), cv2.COLOR_YUV2RGB_I420),
    ):  # fmt: skip
        layouts |= dict.fromkeys(names, _Layout(1, code, rows=(3, 2)))
    return layouts | {"nv24": _Layout(1, cv2.COLOR_YUV2RGB, rows=(3, 1))}


_LAYOUTS = _layouts()


def decoded(
    encoding: str, width: int, height: int, step: int, data: NDArray[np.uint8], bigendian: bool = False
) -> NDArray[np.uint8]:
    """A raw picture as RGB, (h, w, 3). step: bytes a row. Of 16 bits the upper 8 count. ValueError: it is none."""
    layout = _LAYOUTS.get(str(encoding).strip().lower())
    if layout is None:
        raise ValueError(f"a picture of encoding {str(encoding)[:30]!r}; {', '.join(_LAYOUTS)} are read")
    require_size(width, height)
    size, rows = layout.depth // 8, height * layout.rows[0] // layout.rows[1]
    row = width * layout.channels * size
    if rows == 1:
        step = row
    elif layout.rows != (1, 1):
        step = width  # their planes follow one another without a gap, whatever is said
    if step < row or len(data) < step * (rows - 1) + row:
        raise ValueError(f"{len(data)} bytes are too few for {width} x {height} pixels of {encoding}")
    whole = np.zeros(step * rows, np.uint8)  # the last row may end with its last pixel
    whole[: min(len(data), len(whole))] = data[: len(whole)]
    flat = np.ascontiguousarray(whole.reshape(rows, step)[:, :row])
    pixels: _Pixels = flat
    if layout.depth == 16:
        pixels = (flat.view(">u2" if bigendian else "<u2") >> 0).astype(np.uint16)
    pixels = pixels.reshape(rows, width, layout.channels) if layout.channels > 1 else pixels
    if layout.rows == (3, 1):  # NV24: grey, then both colours by turns
        pixels = np.dstack((pixels[:height], pixels[height:].reshape(height, width, 2)))
    return _rgb(pixels, layout)


def _rgb(pixels: _Pixels, layout: _Layout) -> NDArray[np.uint8]:
    if layout.code is not None:
        try:
            pixels = np.asarray(cv2.cvtColor(pixels, layout.code))
        except cv2.error as error:
            raise ValueError(f"its pixels cannot be converted: {error.err or 'odd sides'}") from None
    return np.asarray(pixels >> 8 if layout.depth == 16 else pixels, np.uint8)
