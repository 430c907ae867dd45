"""A run as an MCAP file in the ROS 2 profile, tick by tick. What the brain was given can be read back to the last bit.

Times are simulated ones from 0, so that the same run is the same file. The robot itself is told nothing of /truth. The
messages' definitions and their coding come from the library rosbags.
"""

# The message classes are made when the library is loaded, so their fields have no types.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import IO, Any, Literal, TypeAlias

import cv2
import numpy as np
from mcap.well_known import SchemaEncoding
from mcap.writer import CompressionType, Writer
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from app.code_version import code_version
from app.config.toml_file import to_toml
from app.session import Session
from app.views.events import EventLog, EventWatch
from ratslam_core import Pose2
from sim2d import SONAR_ANGLES_RAD

Pictures: TypeAlias = Literal["png", "jpeg", "none"]
MAP_EVERY_S = 60.0  # a map is large
SONAR_STEP_RAD = math.radians(20)  # the sonars stand at multiples of it from the rightmost one; some places are empty
_LINKS, _EXPERIENCES = (5, 0.03, (0.35, 0.38, 0.42)), (8, 0.08, (0.0, 0.45, 0.7))
_STORE = get_typestore(Stores.ROS2_HUMBLE)
_NO_COVARIANCE = np.zeros(36)


def write_mcap(ticks: Iterator[Session], file: IO[bytes], pictures: Pictures = "png") -> int:
    """Write what was sensed and believed in every tick; numbers that stay the same only once. Returns the number of ticks.

    pictures: "png" loses nothing; with "jpeg" the file is a third as large, but what the robot sees in it is no longer the same.
    """
    bag, recorder, count = _Bag(file), None, 0
    for session in ticks:
        if recorder is None:
            bag.describe(session)
            recorder = _Recorder(bag, session, pictures)
        recorder.tick()
        count += 1
    if recorder is not None:
        recorder.map()
    bag.close()
    return count


class _Bag:
    """The file: a channel for each topic, made when it is first used."""

    def __init__(self, file: IO[bytes]) -> None:
        self._writer = Writer(file, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="RatSLAM")
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}

    def describe(self, session: Session) -> None:
        """What has to be known to play the recording as the run was: beginning, parameters, places of the sonars."""
        said = {
            "world": session.world.name,
            "seed": str(session.seed),
            "code_version": code_version(),
            "config": to_toml(session.config),
            "sonar_angles_rad": json.dumps(SONAR_ANGLES_RAD),
            "began_with_experiences": str(
                len(session.brain.experience_map) - (session.tick_count == 0 and session.estimate.created)
            ),
            "began_at_tick": str(session.tick_count),
        }
        self._writer.add_metadata("ratslam", said)

    def put(self, topic: str, kind: str, content: object, time_ns: int) -> None:
        """Write a message, coded as CDR, the way ROS 2 sends it."""
        name = _full(kind)
        if topic not in self._channels:
            if name not in self._schemas:
                text = _STORE.generate_msgdef(name, ros_version=2)[0]  # with all the types that it is made of
                self._schemas[name] = self._writer.register_schema(name, SchemaEncoding.ROS2, text.encode())
            self._channels[topic] = self._writer.register_channel(topic, "cdr", self._schemas[name])
        self._writer.add_message(self._channels[topic], time_ns, bytes(_STORE.serialize_cdr(content, name)), time_ns)

    def close(self) -> None:
        self._writer.finish()


class _Recorder:
    """Looks at a session after each tick."""

    def __init__(self, bag: _Bag, session: Session, pictures: Pictures) -> None:
        self._bag, self._session, self._pictures = bag, session, pictures
        self._odometry = Pose2(0.0, 0.0, 0.0)
        self._log = EventLog(session)
        self._events = EventWatch(session, self._log)
        self._values: dict[str, float] = {}
        self._told, self._kidnaps = 0, len(session.evaluation.kidnaps)
        self._map_due_s = session.time_s + MAP_EVERY_S
        self._first = True

    def tick(self) -> None:
        self._senses()
        self._poses()
        self._beliefs()
        self._happenings()
        self._first = False
        if self._session.time_s >= self._map_due_s:
            self._map_due_s += MAP_EVERY_S
            self.map()

    def map(self) -> None:
        """The experience map as it is now: to be drawn, and as JSON."""
        map_, now = self._session.brain.experience_map, self._now
        lines = map_.poses[map_.links.ravel(), :2].tolist()
        marks = (_LINKS, lines), (_EXPERIENCES, map_.poses[:, :2].tolist())
        markers = [_marker(now, i, *look, ends) for i, (look, ends) in enumerate(marks)]
        self._put("/map", "visualization_msgs/MarkerArray", markers)
        self._put("/topological_map", "std_msgs/String", topological_map(self._session))

    @property
    def _now(self) -> int:
        return round(self._session.time_s * 1e9)

    def _put(self, topic: str, kind: str, *fields: object) -> None:
        self._bag.put(topic, kind, _message(kind, *fields), self._now)

    def _change(self, topic: str, kind: str, value: float) -> None:
        """Only when it is another one: what was said last holds."""
        if self._values.get(topic) != value:
            self._values[topic] = value
            self._put(topic, kind, value)

    def _senses(self) -> None:
        """What the brain was given in this tick, and nothing else."""
        session, now = self._session, self._now
        frame, told = session.frame, session.odometry
        if self._pictures != "none":
            picture = _header(now, "base_link"), self._pictures, _packed(frame.image, self._pictures)
            self._put("/camera/image/compressed", "sensor_msgs/CompressedImage", *picture)
        step, turn = told.speed * told.dt, told.yaw_rate * told.dt
        if not self._first:
            driven = Pose2(step * math.cos(turn / 2), step * math.sin(turn / 2), turn)
            self._odometry = self._odometry.compose(driven)
        self._bag.put("/odom", "nav_msgs/Odometry", _moved(now, self._odometry, told.speed, told.yaw_rate), now)
        self._bag.put("/scan", "sensor_msgs/LaserScan", self._scan(), now)
        self._bag.put("/sonars", "std_msgs/Float64MultiArray", _floats(frame.ranges_m), now)
        self._change("/dt", "std_msgs/Float64", told.dt)
        self._change("/behaviour", "std_msgs/UInt8", session.pilot.behaviour.number)
        if session.brain.params.local_view.front_end == "scene numbers":
            self._change("/scene_number", "std_msgs/Int64", frame.scene)

    def _scan(self) -> object:
        """The laser, or of a robot without one its sonars in the places of a laser's beams."""
        frame, robot = self._session.frame, self._session.config.robot
        if len(frame.laser_m):
            fan = robot.laser_fov_rad
            n = len(frame.laser_m)
            step = fan / n if fan > math.tau - 1e-9 else fan / max(n - 1, 1)  # round about, both ends would be one beam
            first = fan / 2 - step * (n - 1)
            return _beams(self._now, first, step, frame.dt, robot.laser_range_m, frame.laser_m[::-1].copy())
        first = SONAR_ANGLES_RAD[-1]
        places = [round((angle - first) / SONAR_STEP_RAD) for angle in SONAR_ANGLES_RAD]
        beams = np.full(max(places) + 1, np.nan, np.float32)
        beams[places] = frame.ranges_m
        return _beams(self._now, first, SONAR_STEP_RAD, frame.dt, robot.sonar_range_m, beams)

    def _poses(self) -> None:
        """Ground truth and pose estimate, each in a frame of its own."""
        session, now, truth = self._session, self._now, self._session.simulator.truth
        believed = session.estimate.pose_map_robot
        true = Pose2(truth.x, truth.y, truth.heading_rad)
        for topic, frame, pose in (("/truth", "office", true), ("/estimate", "map", believed)):
            self._bag.put(topic, "geometry_msgs/PoseStamped", _pose_stamped(now, frame, pose), now)
        drift = believed.compose(self._odometry.inverse())
        tree = [_transform(now, "map", "odom", drift), _transform(now, "odom", "base_link", self._odometry)]
        self._put("/tf", "tf2_msgs/TFMessage", tree)

    def _happenings(self) -> None:
        """What the timeline of the page marks, so far as it is seen in the session."""
        kidnaps = len(self._session.evaluation.kidnaps)
        if kidnaps > self._kidnaps:
            self._log.note("kidnap", "carried to another place")
        self._kidnaps = kidnaps
        if not self._first:
            self._events.watch()
        for event in self._log.events:
            if event.number > self._told:
                self._told = event.number
                self._put("/events", "std_msgs/String", f"{event.kind}: {event.text}")

    def _beliefs(self) -> None:
        estimate = self._session.estimate
        self._change("/view_template", "std_msgs/Int32", estimate.recognition.view)
        self._change("/experience", "std_msgs/Int32", estimate.experience)


def topological_map(session: Session) -> str:
    """The map as JSON: experiences with place (m), heading (rad) and view, links with their ends, move and time (s)."""
    map_ = session.brain.experience_map
    rows = zip(
        map_.links.tolist(), np.round(map_.moves, 4).tolist(), np.round(map_.link_times, 2).tolist(), strict=True
    )
    nodes = zip(np.round(map_.poses, 4).tolist(), map_.views.tolist(), strict=True)
    return json.dumps(
        {
            "active": map_.active,
            "experiences": [[*pose, view] for pose, view in nodes],
            "links": [[*ends, *move, time_s] for ends, move, time_s in rows],
            "columns": {
                "experiences": ["x_m", "y_m", "heading_rad", "view"],
                "links": ["from", "to", "dx_m", "dy_m", "turn_rad", "time_s"],
            },
        },
        separators=(",", ":"),
    )


def _packed(image: NDArray[np.uint8], pictures: str) -> NDArray[np.uint8]:
    done, data = cv2.imencode(".png" if pictures == "png" else ".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR))
    if not done:
        raise ValueError(f"a picture of shape {image.shape} cannot be packed as {pictures}")
    return data.ravel()


def _message(name: str, *fields: Any) -> Any:
    """A message such as "nav_msgs/Path" with its fields in order."""
    return _STORE.types[_full(name)](*fields)


def _full(name: str) -> str:
    return name.replace("/", "/msg/", 1)


def _header(time_ns: int, frame: str) -> Any:
    return _message("std_msgs/Header", _stamp(time_ns), frame)


def _stamp(time_ns: int) -> Any:
    return _message("builtin_interfaces/Time", *divmod(time_ns, 1_000_000_000))


def _vector(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:
    return _message("geometry_msgs/Vector3", x, y, z)


def _point(x: float, y: float) -> Any:
    return _message("geometry_msgs/Point", float(x), float(y), 0.0)


def _turned(heading_rad: float) -> Any:
    half = heading_rad / 2
    return _message("geometry_msgs/Quaternion", 0.0, 0.0, math.sin(half), math.cos(half))


def _pose(at: Pose2) -> Any:
    return _message("geometry_msgs/Pose", _point(at.x, at.y), _turned(at.heading_rad))


def _pose_stamped(time_ns: int, frame: str, at: Pose2) -> Any:
    return _message("geometry_msgs/PoseStamped", _header(time_ns, frame), _pose(at))


def _transform(time_ns: int, parent: str, child: str, at: Pose2) -> Any:
    moved = _message("geometry_msgs/Transform", _vector(at.x, at.y), _turned(at.heading_rad))
    return _message("geometry_msgs/TransformStamped", _header(time_ns, parent), child, moved)


def _moved(time_ns: int, at: Pose2, speed: float, yaw_rate: float) -> Any:
    """speed, yaw_rate: of the odometry, to the last bit; the pose is what they add up to."""
    twist = _message("geometry_msgs/Twist", _vector(speed), _vector(z=yaw_rate))
    return _message(
        "nav_msgs/Odometry", _header(time_ns, "odom"), "base_link",
        _message("geometry_msgs/PoseWithCovariance", _pose(at), _NO_COVARIANCE),
        _message("geometry_msgs/TwistWithCovariance", twist, _NO_COVARIANCE),
    )  # fmt: skip


def _beams(
    time_ns: int, first_rad: float, step_rad: float, dt: float, most_m: float, ranges: NDArray[np.float32]
) -> Any:
    """ranges: counter-clockwise from `first_rad`; NaN where nothing measures."""
    last_rad = first_rad + step_rad * (len(ranges) - 1)
    return _message(
        "sensor_msgs/LaserScan", _header(time_ns, "base_link"), first_rad, last_rad, step_rad, 0.0, dt, 0.0, most_m,
        ranges, np.zeros(0, np.float32),
    )  # fmt: skip


def _marker(time_ns: int, number: int, kind: int, size_m: float, colour: tuple[float, float, float], ends: Any) -> Any:
    """Points (n, 2) of the map as one marker. kind: 5 for lines, each from a point to the next, 8 for points."""
    here = Pose2(0.0, 0.0, 0.0)
    return _message(
        "visualization_msgs/Marker", _header(time_ns, "map"), "experience map", number, kind, 0, _pose(here),
        _vector(size_m, size_m, size_m), _message("std_msgs/ColorRGBA", *colour, 1.0),
        _message("builtin_interfaces/Duration", 0, 0), False, [_point(x, y) for x, y in ends], [], "",
        _message("sensor_msgs/CompressedImage", _header(0, ""), "", np.zeros(0, np.uint8)), [], "",
        "", _message("visualization_msgs/MeshFile", "", np.zeros(0, np.uint8)), False,
    )  # fmt: skip


def _floats(values: NDArray[np.float32]) -> Any:
    layout = _message("std_msgs/MultiArrayLayout", [], 0)
    return _message("std_msgs/Float64MultiArray", layout, values.astype(np.float64))
