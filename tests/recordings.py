"""Small recordings that the tests write themselves, in every format, and what they should be read as."""

from __future__ import annotations

import csv
import gzip
import json
import math
import sqlite3
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from mcap.writer import CompressionType, Writer
from numpy.typing import NDArray
from rosbags.rosbag1 import Writer as Bag1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2
from rosbags.typesys import Stores, get_typestore

N, HZ, BEGAN_NS = 8, 10, 1_700_000_000_000_000_000
HEIGHT, WIDTH, BEAMS = 12, 16, 61
ROS1, ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)


@dataclass(frozen=True)
class Row:
    """One moment of the drive that all of the recordings hold."""

    time_ns: int
    image: NDArray[np.uint8]
    speed: float
    yaw_rate: float
    pose: tuple[float, float, float]
    ranges: NDArray[np.float32]


def drive() -> list[Row]:
    """Forwards in a bend to the left, ever faster. Speed and yaw rate are those since the row before."""
    rng, pose, rows = np.random.default_rng(5), (1.0, -2.0, 3.0), list[Row]()
    for k in range(N):
        speed, yaw_rate, dt = 0.25 + 0.125 * k, 0.5, 1 / HZ
        if k:
            middle = pose[2] + yaw_rate * dt / 2
            x, y = pose[0] + speed * dt * math.cos(middle), pose[1] + speed * dt * math.sin(middle)
            pose = (x, y, math.remainder(pose[2] + yaw_rate * dt, math.tau))
        image = rng.integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
        ranges = np.float32(1 + k) + np.arange(BEAMS, dtype=np.float32) / 64
        rows.append(Row(BEGAN_NS + k * 10**9 // HZ, image, speed, yaw_rate, pose, ranges))
    return rows


def png(image: NDArray[np.uint8]) -> bytes:
    return cv2.imencode(".png", cv2.cvtColor(image, cv2.COLOR_RGB2BGR))[1].tobytes()


def image_folder(folder: Path) -> Path:
    """Names of columns and units as somebody might choose them."""
    folder.mkdir()
    with (folder / "wheels.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["Timestamp [ms]", "Filename", "linear.x", "yaw_rate_deg", "x", "y", "heading_deg", "note"])
        for k, row in enumerate(drive()):
            (folder / f"img{k}.png").write_bytes(png(row.image))
            x, y, heading = row.pose
            table.writerow([
                row.time_ns // 10**6, f"img{k}.png", row.speed, math.degrees(row.yaw_rate), x, y, math.degrees(heading), "-"
            ])  # fmt: skip
    return folder


def plain_folder(folder: Path) -> Path:
    folder.mkdir()
    for k, row in enumerate(drive()):
        (folder / f"p{k + 5}.png").write_bytes(png(row.image))
    return folder


def airsim(folder: Path) -> Path:
    """North, east, down: y and the turn have the other sign."""
    (folder / "images").mkdir(parents=True)
    lines = ["TimeStamp\tPOS_X\tPOS_Y\tPOS_Z\tQ_W\tQ_X\tQ_Y\tQ_Z\tSpeed\tImageFile"]
    for k, row in enumerate(drive()):
        (folder / "images" / f"img_{k}.png").write_bytes(png(row.image))
        x, y, heading = row.pose
        w, z = math.cos(-heading / 2), math.sin(-heading / 2)
        lines.append(f"{row.time_ns // 10**6}\t{x}\t{-y}\t0.1\t{w}\t0\t0\t{z}\t{row.speed}\timg_{k}.png")
    (folder / "airsim_rec.txt").write_text("\n".join(lines) + "\n")
    return folder


def tub(folder: Path) -> Path:
    (folder / "images").mkdir(parents=True)
    records = [_record(folder / "images", k, row) for k, row in enumerate(drive())]
    for number, part in enumerate((records[:5], records[5:])):
        (folder / f"catalog_{number}.catalog").write_text("".join(json.dumps(record) + "\n" for record in part))
    about = {"paths": ["catalog_0.catalog", "catalog_1.catalog"], "current_index": N, "deleted_indexes": []}
    (folder / "manifest.json").write_text('["cam/image_array"]\n["image_array"]\n{}\n{}\n' + json.dumps(about) + "\n")
    return folder


def _record(folder: Path, k: int, row: Row) -> dict[str, Any]:
    name = f"{k}_cam_image_array_.png"
    (folder / name).write_bytes(png(row.image))
    return {
        "_index": k, "_timestamp_ms": row.time_ns // 10**6, "cam/image_array": name, "user/mode": "user",
        "user/angle": 0.1, "user/throttle": row.speed / 2, "imu/gyr_z": math.degrees(row.yaw_rate), "enc/speed": row.speed,
    }  # fmt: skip


def old_tub(folder: Path) -> Path:
    folder.mkdir()
    for k, row in enumerate(drive()):
        record = _record(folder, k, row)
        record["milliseconds"] = record.pop("_timestamp_ms")
        (folder / f"record_{k}.json").write_text(json.dumps(record))
    return folder


def carmen(path: Path, word: str = "FLASER") -> Path:
    lines = ["# a comment", "PARAM robot_length 0.5"]
    for row in drive():
        ranges, (x, y, heading) = " ".join(str(r) for r in row.ranges), row.pose
        time = f"{row.time_ns // 10**9}.{row.time_ns % 10**9:09d}"
        raw = f"0 -1.5 3.0 0.05 20.0 0.01 0 {BEAMS} {ranges} 1 7"
        lines += {
            "FLASER": [f"FLASER {BEAMS} {ranges} 9 9 9 {x} {y} {heading} {time} host {time}"],
            "ROBOTLASER1": [f"ROBOTLASER1 {raw} 9 9 9 {x} {y} {heading} 0 0 0 0 0 {time} host {time}"],
            "RAWLASER1": [f"ODOM {x} {y} {heading} 9 9 0 {time} host {time}", f"RAWLASER1 {raw} {time} host {time}"],
        }[word]
    data = ("\n".join(lines) + "\n").encode()
    path.write_bytes(gzip.compress(data) if path.suffix == ".gz" else data)
    return path


def scans(path: Path) -> Path:
    scans = {
        f"{row.time_ns // 10**9}.{row.time_ns % 10**9:09d}":
        {"range": row.ranges.tolist(), "x": row.pose[0], "y": row.pose[1], "theta": row.pose[2]} for row in drive()
    }  # fmt: skip
    path.write_bytes(gzip.compress(json.dumps({"map": scans}).encode()))
    return path


def video(path: Path) -> Path:
    """Frames of one colour each: red grows, blue shrinks. Beside it, its wheels."""
    out = cv2.VideoWriter(
        str(path), cv2.VideoWriter.fourcc(*("MJPG" if path.suffix == ".avi" else "mp4v")), HZ, (64, 48)
    )
    with path.with_suffix(".csv").open("w", newline="") as file:
        table = csv.writer(file, delimiter=";")
        table.writerow(["time_s", "v", "omega"])
        for k, row in enumerate(drive()):
            out.write(np.full((48, 64, 3), (250 - 30 * k, 0, 30 * k), np.uint8))
            table.writerow([k / HZ, row.speed, row.yaw_rate])
    out.release()
    return path


def _stamp(store: Any, time_ns: int) -> Any:
    return store.types["builtin_interfaces/msg/Time"](sec=time_ns // 10**9, nanosec=time_ns % 10**9)


def ros_messages(ros1: bool, poses_only: bool = False, packed: bool = False) -> Iterator[tuple[str, str, int, Any]]:
    """Topic, type, time and message of each: camera, odometry, scan, truth, and some that nobody needs."""
    store: Any = ROS1 if ros1 else ROS2
    t = store.types
    point, turn = t["geometry_msgs/msg/Point"], t["geometry_msgs/msg/Quaternion"]
    vector = t["geometry_msgs/msg/Vector3"]

    def header(time_ns: int) -> Any:
        extra = {"seq": 0} if ros1 else {}
        return t["std_msgs/msg/Header"](stamp=_stamp(store, time_ns), frame_id="base", **extra)

    for row in drive():
        h, (x, y, heading) = header(row.time_ns), row.pose
        pose = t["geometry_msgs/msg/Pose"](
            point(x, y, 0.0), turn(0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))
        )
        speed, yaw_rate = (0.0, 0.0) if poses_only else (row.speed, row.yaw_rate)
        twist = t["geometry_msgs/msg/Twist"](vector(speed, 0.0, 0.0), vector(0.0, 0.0, yaw_rate))
        with_pose = t["geometry_msgs/msg/PoseWithCovariance"](pose, np.zeros(36))
        with_twist = t["geometry_msgs/msg/TwistWithCovariance"](twist, np.zeros(36))
        if packed:
            image = t["sensor_msgs/msg/CompressedImage"](h, "png", np.frombuffer(png(row.image), np.uint8))
            yield "/camera/image/compressed", "sensor_msgs/msg/CompressedImage", row.time_ns, image
        else:
            bgr = np.ascontiguousarray(row.image[:, :, ::-1]).reshape(-1)
            image = t["sensor_msgs/msg/Image"](h, HEIGHT, WIDTH, "bgr8", 0, WIDTH * 3, bgr)
            yield "/camera/image", "sensor_msgs/msg/Image", row.time_ns, image
        odometry = t["nav_msgs/msg/Odometry"](h, "base_link", with_pose, with_twist)
        yield "/odom", "nav_msgs/msg/Odometry", row.time_ns, odometry
        bare = np.zeros(0, np.float32)
        beams = t["sensor_msgs/msg/LaserScan"](h, -1.5, 1.5, 0.05, 0.0, 0.1, 0.1, 30.0, row.ranges, bare)
        yield "/scan", "sensor_msgs/msg/LaserScan", row.time_ns, beams
        yield "/truth", "geometry_msgs/msg/PoseStamped", row.time_ns, t["geometry_msgs/msg/PoseStamped"](h, pose)
        yield "/words", "std_msgs/msg/String", row.time_ns, t["std_msgs/msg/String"]("hello")


def _tell(
    ros1: bool, channel: Callable[[str, str], Any], write: Callable[[Any, int, bytes], object], **kind: Any
) -> None:
    """Write every message to its channel, which begins with the first."""
    channels: dict[str, Any] = {}
    for topic, type_, time_ns, message in ros_messages(ros1, **kind):
        if topic not in channels:
            channels[topic] = channel(topic, type_)
        data = ROS1.serialize_ros1(message, type_) if ros1 else ROS2.serialize_cdr(message, type_)
        write(channels[topic], time_ns, bytes(data))


def mcap(
    path: Path, ros1: bool = False, packing: CompressionType = CompressionType.ZSTD, chunk: int = 2000, **kind: Any
) -> Path:
    """Written by the library of MCAP."""
    profile, of_schema, of_data = ("ros1", "ros1msg", "ros1") if ros1 else ("ros2", "ros2msg", "cdr")
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=chunk, compression=packing)
        writer.start(profile, "tests")

        def channel(topic: str, type_: str) -> int:
            return writer.register_channel(topic, of_data, writer.register_schema(type_, of_schema, b""))

        _tell(ros1, channel, lambda to, time_ns, data: writer.add_message(to, time_ns, data, time_ns), **kind)
        writer.finish()
    return path


def bag1(path: Path, packing: str = "LZ4", **kind: Any) -> Path:
    """Written by rosbags."""
    bag = Bag1(path)
    bag.chunk_threshold = 2000
    if packing:
        bag.set_compression(Bag1.CompressionFormat[packing])
    with bag:
        _tell(True, lambda topic, type_: bag.add_connection(topic, type_, typestore=ROS1), bag.write, **kind)
    return path


def bag2(folder: Path, plugin: StoragePlugin = StoragePlugin.SQLITE3, **kind: Any) -> Path:
    """Written by rosbags."""
    with Bag2(folder, version=9, storage_plugin=plugin) as bag:
        _tell(False, lambda topic, type_: bag.add_connection(topic, type_, typestore=ROS2), bag.write, **kind)
    return folder


def db3(path: Path) -> Path:
    """One file of such a bag, as ROS writes it."""
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
    base.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
    topic = "INSERT INTO topics(name, type, serialization_format) VALUES(?, ?, 'cdr')"
    message = "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)"
    _tell(False, lambda *about: base.execute(topic, about).lastrowid, lambda *row: base.execute(message, row))
    base.commit()
    base.close()
    return path


WHEELS, ROS = {"speed", "yaw rate"}, {"camera", "ranges", "speed", "yaw rate", "truth"}
# Of each format: how it is written below a name, and what it has.
FORMATS: dict[str, tuple[str, Callable[[Path], Path], set[str]]] = {
    "image folder": ("pictures", image_folder, {"camera", "truth"} | WHEELS),
    "plain folder": ("plain", plain_folder, {"camera"}),
    "airsim": ("airsim", airsim, {"camera", "truth"}),
    "tub": ("tub", tub, {"camera", "throttle"} | WHEELS),
    "old tub": ("old", old_tub, {"camera", "throttle"} | WHEELS),
    "carmen": ("a.log", carmen, {"ranges"} | WHEELS),
    "carmen packed": ("a.log.gz", carmen, {"ranges"} | WHEELS),
    "carmen robot": ("b.log", lambda path: carmen(path, "ROBOTLASER1"), {"ranges"} | WHEELS),
    "carmen raw": ("c.log", lambda path: carmen(path, "RAWLASER1"), {"ranges"} | WHEELS),
    "scans": ("scans.gz", scans, {"ranges"} | WHEELS),
    "avi": ("v.avi", video, {"camera"} | WHEELS),
    "mp4": ("v.mp4", video, {"camera"} | WHEELS),
    "mcap": ("a.mcap", mcap, ROS),
    "mcap lz4": ("b.mcap", lambda path: mcap(path, packing=CompressionType.LZ4, packed=True), ROS),
    "mcap ros1": ("c.mcap", lambda path: mcap(path, True), ROS),
    "mcap poses": ("d.mcap", lambda path: mcap(path, poses_only=True), ROS),
    "bag": ("a.bag", bag1, ROS),
    "bag bz2": ("b.bag", lambda path: bag1(path, "BZ2"), ROS),
    "bag plain": ("c.bag", lambda path: bag1(path, ""), ROS),
    "bag 2": ("bag2", bag2, ROS),
    "bag 2 mcap": ("bag2m", lambda path: bag2(path, StoragePlugin.MCAP), ROS),
    "db3": ("a.db3", db3, ROS),
}  # fmt: skip
