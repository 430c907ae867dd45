"""Which topic of a ROS recording is used for what."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats import ros_messages as ros
from app.recordings.formats.ros_packets import Packet

_TRUTH = re.compile(r"(^|[/_])(truth|ground_?truth|gt|true_pose|mocap|vicon|optitrack)([/_]|$)", re.IGNORECASE)
_NOT_A_CAMERA = re.compile(r"depth|disparity|mask|segment|label|infra|thermal|normals|debug", re.IGNORECASE)
_ODOMETRIES = {"odom", "odometry"}
_BASES = {"base_link", "base_footprint", "base"}


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
    last_stamp_ns: int = 0
    stamped: bool = True  # every message has a time of its own, and they never go back
    twisted: bool = False  # an odometry that reports speeds
    moved: bool = False  # an odometry whose poses change
    first_pose: tuple[float, float, float] | None = None
    accelerated: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))  # sum of a gyro's accelerations

    def note(self, packet: Packet) -> None:
        """Broken messages are told of later, when they are played."""
        self.count += 1
        if self.type in ros.STAMPED:
            stamp = ros.stamp_ns(packet)
            self.stamped &= stamp > 0 and stamp >= self.last_stamp_ns
            self.last_stamp_ns = stamp
        try:
            if self.type == ros.ODOMETRY and not (self.twisted and self.moved):
                told = ros.message(packet)
                self.twisted |= ros.twist(told) != (0.0, 0.0)
                self.first_pose = self.first_pose or ros.pose(told)
                self.moved |= ros.pose(told) != self.first_pose
            elif self.type == ros.IMU:
                a = ros.message(packet).linear_acceleration
                force = np.array([a.x, a.y, a.z])
                if np.abs(force).max() < 1e3:
                    self.accelerated += force
        except ValueError:
            return

    @property
    def up(self) -> NDArray[np.float64]:
        """What is up for the sensor: what it feels on the whole is the ground that carries it."""
        size = float(np.linalg.norm(self.accelerated))
        return self.accelerated / size if size > self.count else np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class Roles:
    """Topic of each; None: there is none."""

    camera: str | None
    odometry: str | None
    transforms: str | None  # used where there is no odometry
    gyro: str | None  # used where neither is there, or when it was asked for
    scan: str | None
    truth: str | None
    sonars: str | None  # of a run of ours: the ranges in full precision
    behaviour: str | None


def roles_of(topics: dict[str, Topic], choice: Choice) -> Roles:
    """By type, then by name, then by the number of messages. ValueError: a topic that was asked for is not there."""
    truth = _chosen(topics, choice.truth, (ros.POSE, ros.ODOMETRY, ros.POSE_COVARIANCE, ros.TRANSFORM), _is_truth)
    camera = _chosen(topics, choice.camera, (ros.COMPRESSED, ros.IMAGE), lambda name: not _NOT_A_CAMERA.search(name))
    odometry = _chosen(
        topics, choice.odometry, (ros.ODOMETRY,), lambda name: name != truth and not _is_truth(name), _ODOMETRIES
    )
    transforms = _chosen(topics, None, (ros.TF, ros.TF_OLD), lambda name: not name.endswith("_static"))
    gyro = _chosen(topics, choice.gyro, (ros.IMU,), lambda _name: True)
    scan = _chosen(topics, choice.scan, (ros.SCAN,), lambda _name: True, {"scan"})
    sonars = _chosen(topics, None, (ros.FLOATS,), lambda name: name == "/sonars")
    behaviour = _chosen(topics, None, (ros.NUMBER,), lambda name: name == "/behaviour")
    by_wheels = odometry or transforms
    return Roles(
        camera, odometry, None if odometry else transforms, gyro if choice.gyro or not by_wheels else None, scan, truth,
        sonars if scan else None, behaviour,
    )  # fmt: skip


def _is_truth(name: str) -> bool:
    return _TRUTH.search(name) is not None


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


def is_odometry(parent: str, child: str) -> bool:
    """Whether a transform is that of the wheels."""
    return parent.strip("/").split("/")[-1] in _ODOMETRIES and child.strip("/").split("/")[-1] in _BASES
