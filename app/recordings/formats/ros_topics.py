"""Which topic of a ROS recording is used for what, and which time of its messages counts: that in the header, or that
at which they were written down.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats import ros_messages as ros
from app.recordings.formats.ros_messages import Packet
from app.recordings.formats.ros_odometry import Edge, Moving, Odometer, Turns, Wheels, note, unlike_turns, wheels_of
from disk.words import plain

_TRUTH = re.compile(r"(^|[/_])(truth|ground_?truth|gt|true_pose|mocap|vicon|optitrack)([/_]|$)", re.IGNORECASE)
_NOT_A_CAMERA = re.compile(r"depth|disparity|mask|segment|label|infra|thermal|normals|debug", re.IGNORECASE)
_UP = np.array([0.0, 0.0, 1.0])
_TRUTHS = (ros.POSE, ros.ODOMETRY, ros.POSE_COVARIANCE, ros.TRANSFORM)
_ODOMETRIES = {"odom", "odometry"}


@dataclass(frozen=True, slots=True)
class Choice:
    """Topics somebody asked for; None: chosen by rule."""

    camera: str | None = None
    odometry: str | None = None
    gyro: str | None = None
    scan: str | None = None
    truth: str | None = None


@dataclass
class Topic:
    """What is known of a topic after all of its messages have gone by."""

    type: str
    count: int = 0
    stamps: Stamps | None = None  # None: of a type without a time
    odometer: Odometer = field(default_factory=Odometer)
    transforms: dict[Edge, Moving] = field(default_factory=dict[Edge, Moving])
    limit_m: float | None = None  # of a scan
    turns: Turns = field(default_factory=Turns)  # of a gyro
    accelerated: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))  # sum of a gyro's accelerations

    def note(self, packet: Packet) -> None:
        """Broken messages are told of later, when they are played."""
        self.count += 1
        if packet.type != self.type:
            return
        stamp = 0
        if self.type in ros.STAMPED:
            stamp = ros.stamp_ns(packet)
            self.stamps = self.stamps or Stamps()
            self.stamps.note(stamp, packet.time_ns)
        try:
            if self.type == ros.ODOMETRY:
                told = ros.message(packet)
                self.odometer.note(stamp or packet.time_ns, ros.pose(told), ros.twist(told))
            elif self.type in ros.TRANSFORMS:
                note(ros.message(packet), self.transforms)
            elif self.type == ros.SCAN and self.limit_m is None:
                self.limit_m = ros.scan_beams(ros.message(packet)).limit_m
            elif self.type == ros.IMU:
                told = ros.message(packet)
                a, rate = told.linear_acceleration, told.angular_velocity
                self.turns.note(stamp or packet.time_ns, (rate.x, rate.y, rate.z))
                force = np.array([a.x, a.y, a.z])
                if np.abs(force).max() < 1e3:
                    self.accelerated += force
        except ValueError:
            return

    @property
    def up(self) -> NDArray[np.float64]:
        """What is up for the sensor: its mean acceleration, the reaction of the ground."""
        size = float(np.linalg.norm(self.accelerated))
        return self.accelerated / size if size > self.count else _UP


@dataclass(frozen=True, slots=True)
class Roles:
    """Topic of each; None: there is none."""

    camera: str | None
    odometry: str | None
    wheels: Wheels | None  # a transform, used where there is no odometry
    gyro: str | None  # used where neither is there, or when it was asked for
    scan: str | None
    truth: str | None
    sonars: str | None  # of a run of ours: the ranges in full precision
    behaviour: str | None

    def used(self) -> dict[str, None]:
        """The topics."""
        wheels = None if self.wheels is None else self.wheels.topic
        names = (
            self.camera, self.odometry, wheels, self.gyro, self.scan, self.truth, self.sonars, self.behaviour,
        )  # fmt: skip
        return {name: None for name in names if name is not None}


def roles_of(topics: dict[str, Topic], choice: Choice) -> Roles:
    """By type, then by name, then by the number of messages. ValueError: a topic that was asked for is not there."""
    truth = _chosen(topics, choice.truth, _TRUTHS, _is_truth)
    camera = _chosen(topics, choice.camera, (ros.COMPRESSED, ros.IMAGE), lambda name: not _NOT_A_CAMERA.search(name))
    odometry = _chosen(
        topics, choice.odometry, (ros.ODOMETRY,), lambda name: name != truth and not _is_truth(name), _ODOMETRIES
    )
    transforms = wheels_of({name: topic.transforms for name, topic in topics.items() if topic.transforms})
    gyro = _chosen(topics, choice.gyro, (ros.IMU,), lambda _name: True)
    scan = _chosen(topics, choice.scan, (ros.SCAN,), lambda _name: True, {"scan"})
    sonars = _chosen(topics, None, (ros.FLOATS,), lambda name: name == "/sonars")
    behaviour = _chosen(topics, None, (ros.NUMBER,), lambda name: name == "/behaviour")
    by_wheels = odometry or transforms
    return Roles(
        camera, odometry, None if odometry else transforms, gyro if choice.gyro or not by_wheels else None, scan, truth,
        sonars if scan else None, behaviour,
    )  # fmt: skip


def _chosen(
    topics: dict[str, Topic],
    asked: str | None,
    types: tuple[str, ...],
    fits: Callable[[str], object],
    names: set[str] | None = None,
) -> str | None:
    if asked is not None:
        if asked not in topics or topics[asked].type not in types:
            there = ", ".join(name for name, topic in topics.items() if topic.type in types) or "none"
            raise ValueError(f"topic {asked!r}: not in the recording with a type that fits; there are: {there}")
        return asked
    fitting = [name for name, topic in topics.items() if topic.type in types and fits(name)]
    return min(fitting, key=lambda name: _rank(name, topics[name], names or set()), default=None)


def _rank(name: str, topic: Topic, names: set[str]) -> tuple[bool, int, int, str]:
    """The smallest is the best."""
    return name.strip("/").lower() not in names, -topic.count, len(name), name


def _is_truth(name: str) -> bool:
    return _TRUTH.search(name) is not None


def turned_otherwise(topics: dict[str, Topic], roles: Roles) -> Iterator[tuple[str, float, float]]:
    """Gyros that contradict the wheels: the topic, and how far the wheels and it turned, rad."""
    if roles.odometry is None:
        return
    odometer = topics[roles.odometry].odometer
    turns = odometer.turns_by_poses if odometer.by_poses else odometer.turns_by_twist
    for name, topic in topics.items():
        if topic.type == ros.IMU and (both := unlike_turns(turns.about(_UP), topic.turns.about(topic.up))) is not None:
            yield name, *both


def unused(topics: dict[str, Topic], roles: Roles) -> Iterator[str]:
    """Sentences: each topic that is not used, and why."""
    used, wheels = roles.used(), roles.wheels
    for name, topic in topics.items():
        if name not in used:
            yield f"{name}, {topic.count} messages: {_why_not(name, topic, roles)}"
        elif (
            wheels is not None and name == wheels.topic and (rest := topic.count - topic.transforms[wheels.edge].count)
        ):
            others = [edge for edge in topic.transforms if edge != wheels.edge]
            yield f"{name}, {rest} messages: of other transforms only, {_told(others)}"


def _why_not(name: str, topic: Topic, roles: Roles) -> str:
    """Why a topic is not used."""
    motion = roles.odometry or (roles.wheels and roles.wheels.topic)
    if topic.type in ros.TRANSFORMS:
        if roles.odometry is not None or (roles.wheels is not None and roles.wheels.edge not in topic.transforms):
            return f"odometry comes from {motion}"
        return f"no transform odom -> base_link among: {_told(list(topic.transforms))}"
    for types, taken, option, what in (
        ((ros.COMPRESSED, ros.IMAGE), roles.camera, "camera", "not a camera by its name"),
        ((ros.ODOMETRY,), roles.odometry, "odometry", "a truth by its name"),
        ((ros.IMU,), roles.gyro or motion, "gyro", ""),
        ((ros.SCAN,), roles.scan, "scan", ""),
        (_TRUTHS, roles.truth, "truth", "not a truth by its name"),
    ):
        if topic.type in types:
            if taken is None or (option == "camera" and _NOT_A_CAMERA.search(name)):
                return f"{what}; --{option}-topic takes it"
            source = {"gyro": "yaw rate", "scan": "ranges"}.get(option, option)
            return f"{source} comes from {taken}; --{option}-topic takes this one"
    return f"type {topic.type} is not read"


def _told(edges: list[Edge]) -> str:
    """Transforms, the first few."""
    told = ", ".join(f"{plain(parent, 40)} -> {plain(child, 40)}" for parent, child in edges[:5])
    return f"{told} and {len(edges) - 5} more" if len(edges) > 5 else told or "none"


_WINDOW_NS = 10 * 10**9
_APART_S = 0.5  # clocks that tell of one moment differ by less: it is more than a message is on its way
_MANY = 0.25  # of the windows in which they were compared
_REAL = 0.5  # a bag that was written anew in a moment has no times of its own


@dataclass
class Stamps:
    """What is known of a topic's times after all of its messages have gone by."""

    first_ns: int = 0
    last_ns: int = 0
    missing: bool = False  # a header without a time
    back: bool = False  # times that go back
    wrote_ns: list[int] = field(default_factory=list[int])  # when the first and the last one was written down
    late_ns: dict[int, int] = field(default_factory=dict[int, int])  # the least from header to record, by windows

    def note(self, stamp_ns: int, time_ns: int) -> None:
        """stamp_ns: in the header; time_ns: when it was written down."""
        self.missing |= stamp_ns <= 0
        self.back |= stamp_ns < self.last_ns
        self.first_ns, self.last_ns = self.first_ns or stamp_ns, stamp_ns
        self.wrote_ns = [self.wrote_ns[0] if self.wrote_ns else time_ns, time_ns]
        window, late = time_ns // _WINDOW_NS, time_ns - stamp_ns
        self.late_ns[window] = min(late, self.late_ns.get(window, late))


@dataclass(frozen=True, slots=True)
class Times:
    """Which times count."""

    stamped: bool  # those in the headers
    why: str = ""  # not, in words
    problem: bool = False  # whether that is a fault of the recording


def times_of(topics: Mapping[str, Stamps | None]) -> Times:
    """Which times count, of the topics that are used; None: of a type without a time.

    [ours] Headers tell better when something was than the record does. But each may have been filled in by another
    clock, which shows where messages that were written down together have headers far apart.
    """
    stamps = {name: stamp for name, stamp in topics.items() if stamp is not None and stamp.wrote_ns}
    for name, stamp in topics.items():
        if stamp is None:
            return Times(False, f"{name} has no time of its own")
    for name, stamp in stamps.items():
        if stamp.missing:
            return Times(False, f"headers of {name} are without a time")
        if stamp.back:
            return Times(False, f"times in the headers of {name} go back")
    if (apart := _apart(stamps)) is None or not _real(list(stamps.values())):
        return Times(True)
    one, other, seconds = apart
    return Times(False, f"the clocks of {one} and {other} are {seconds:.6g} s apart in their headers", True)


def _apart(stamps: Mapping[str, Stamps]) -> tuple[str, str, float] | None:
    """Two topics whose clocks differ, and by how much (s), in the middle of the windows in which they do."""
    found, compared = list[tuple[float, str, str]](), 0
    for window in sorted({window for stamp in stamps.values() for window in stamp.late_ns}):
        late = sorted((stamp.late_ns[window], name) for name, stamp in stamps.items() if window in stamp.late_ns)
        if len(late) > 1:
            compared += 1
            (least, one), (most, other) = late[0], late[-1]
            if most - least > _APART_S * 1e9:
                found.append(((most - least) / 1e9, min(one, other), max(one, other)))
    if not found or len(found) <= _MANY * compared:
        return None
    seconds, one, other = sorted(found)[len(found) // 2]
    return one, other, seconds


def _real(stamps: Sequence[Stamps]) -> bool:
    """Whether messages were written down when they came."""
    wrote = max(s.wrote_ns[1] for s in stamps) - min(s.wrote_ns[0] for s in stamps)
    return wrote >= _REAL * max(s.last_ns - s.first_ns for s in stamps)
