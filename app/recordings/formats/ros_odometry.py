"""Which of all transforms is the odometry, by what moves and where it leads rather than by a list of names; and whether
what sources say of one motion agrees: an odometry's speed with its poses, a gyro's turns with those of the wheels.
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats import ros_messages as ros
from app.recordings.formats.sensed import Rates
from app.recordings.recording import Pose

_ODOM = re.compile(r"odom", re.IGNORECASE)
_BASE = re.compile(r"(^|[_/])(base|footprint|body|chassis|robot|vehicle|car)([_/]|$)", re.IGNORECASE)
_STIRS = 1e-3  # m or rad
_MOST = 10_000  # transforms; no robot has so many

Edge = tuple[str, str]  # parent, child


@dataclass(frozen=True, slots=True)
class Wheels:
    """The transform that is taken as odometry."""

    topic: str
    edge: Edge
    turned_over: bool  # from the robot to where it began

    def pose(self, told: Any) -> Pose | None:
        """Of a message; None: it is not in it. ValueError: it is broken."""
        for edge, part in transforms_in(told):
            if edge == self.edge:
                x, y, heading = ros.pose(part)
                if not self.turned_over:
                    return x, y, heading
                cos, sin = math.cos(heading), math.sin(heading)
                return -(x * cos + y * sin), x * sin - y * cos, -heading
        return None


def wheels_of(topics: Mapping[str, Mapping[Edge, Moving]]) -> Wheels | None:
    """[ours] Of the transforms of all topics: one that moves rather than one that does not, then from a frame of
    odometry to the robot, then whatever moves and leads to the robot."""
    tree: dict[str, list[str]] = {}
    for edges in topics.values():
        for parent, child in edges:
            tree.setdefault(parent, []).append(child)
    found = [
        ((not moving.moved, kind, -moving.count, edge, topic), Wheels(topic, edge, kind == 1))
        for topic, edges in topics.items() for edge, moving in edges.items()
        if (kind := _kind(edge, tree)) is not None and (moving.moved or kind == 0)
    ]  # fmt: skip
    return min(found, key=lambda one: one[0])[1] if found else None


def _kind(edge: Edge, tree: Mapping[str, list[str]]) -> int | None:
    """How well it could be the odometry, from 0; None: not at all."""
    parent, child = edge
    if _ODOM.search(_last(parent)):
        return 0 if _leads(child, tree) else 3
    if _is_base(parent):
        return 1 if _ODOM.search(_last(child)) else None  # a wheel or an arm
    return 2 if _leads(child, tree) else None


def _leads(frame: str, tree: Mapping[str, list[str]]) -> bool:
    """Whether it is the robot's, or one from which transforms lead to that."""
    ahead, seen = [frame], {frame}
    while ahead:
        frame = ahead.pop()
        if _is_base(frame):
            return True
        new = [child for child in tree.get(frame, ()) if child not in seen]
        seen.update(new)
        ahead += new
    return False


def _is_base(frame: str) -> bool:
    return _BASE.search(_last(frame)) is not None and not _ODOM.search(_last(frame))


def _last(frame: str) -> str:
    """Without the namespace of one of several robots."""
    return frame.rpartition("/")[2]


@dataclass
class Moving:
    """One transform, after all messages have gone by."""

    count: int = 0  # messages in which it is
    first: Pose | None = None
    moved: bool = False

    def note(self, pose: Pose) -> None:
        self.first = self.first or pose
        self.moved |= max(abs(a - b) for a, b in zip(pose, self.first, strict=True)) > _STIRS


def note(told: Any, edges: dict[Edge, Moving]) -> None:
    """ValueError: one of them is broken."""
    for edge, part in transforms_in(told):
        if edge in edges or len(edges) < _MOST:
            moving = edges.setdefault(edge, Moving())
            moving.count += 1
            moving.note(ros.pose(part))


def transforms_in(told: Any) -> Iterator[tuple[Edge, Any]]:
    """Those of a message, each once."""
    seen = set[Edge]()
    for part in told.transforms:
        edge = part.header.frame_id.strip("/"), part.child_frame_id.strip("/")
        if edge not in seen:
            seen.add(edge)
            yield edge, part


_WINDOW_NS = 10**9
_MOVES = (0.05, 0.1)  # m and rad in a window; less is noise
_UNLIKE, _MANY, _LEAST = 0.3, 0.25, 2  # share of the motion; of the windows with motion; windows
_SCALE, _FAR_M = 0.1, 5.0  # share of a way, and its least length: what is right differs by a hundredth
_TURN_S, _WHOLE_S, _TURN_RAD = 5.0, 4.0, 0.5  # windows are long, for a gyro may be late; of them heard; rad in a window


class Turns:
    """How far something turned in each window of time, about each of its axes."""

    def __init__(self) -> None:
        self._windows = defaultdict[int, NDArray[np.float64]](lambda: np.zeros(4))  # rad about x, y, z; s heard
        self._last_ns: int | None = None

    def note(self, time_ns: int, rates: tuple[float, float, float]) -> None:
        """rates: rad/s, since the message before."""
        dt = 0.0 if self._last_ns is None else (time_ns - self._last_ns) / 1e9
        self._last_ns = time_ns
        if 0 < dt < 1 and np.abs(rates).max() < 1e3:
            self._windows[int(time_ns / 1e9 / _TURN_S)] += np.multiply((*rates, 1.0), dt)

    def about(self, up: NDArray[np.float64]) -> dict[int, float]:
        """rad in each window that was heard as a whole."""
        return {window: float(turn[:3] @ up) for window, turn in self._windows.items() if turn[3] > _WHOLE_S}


def unlike_turns(wheels: dict[int, float], gyro: dict[int, float]) -> tuple[float, float] | None:
    """[ours] Both turns, rad, to and fro, where they contradict each other in a quarter of the windows in which either
    turns, two at least; else None. test_recording_ros.py::test_a_gyro_that_turns_otherwise_than_the_wheels."""
    both = [(wheels[window], gyro[window]) for window in wheels.keys() & gyro.keys()]
    turning = [(a, b) for a, b in both if max(abs(a), abs(b)) > _TURN_RAD]
    unlike = sum(abs(a - b) > _UNLIKE * max(abs(a), abs(b)) for a, b in turning)
    if unlike < _LEAST or unlike <= _MANY * len(turning):
        return None
    return sum(abs(a) for a, _ in turning), sum(abs(b) for _, b in turning)


@dataclass
class Odometer:
    """What is known of an odometry's messages after all of them have gone by."""

    twisted: bool = False  # it reports speeds
    moved: bool = False  # its poses change
    turns_by_poses: Turns = field(default_factory=Turns)
    turns_by_twist: Turns = field(default_factory=Turns)
    way_m: list[float] = field(default_factory=lambda: [0.0, 0.0])  # forwards or backwards, by poses and by twists
    _first: Pose | None = None
    _last_ns: int = 0
    _window: int = 0
    _sums: list[float] = field(default_factory=lambda: [0.0] * 4)  # way, turn by poses; way, turn by twists
    _far_m: list[float] = field(default_factory=lambda: [0.0, 0.0])  # as way_m, without noise: of windows with motion
    _moving: int = 0
    _unlike: int = 0
    _rates: Rates = field(default_factory=Rates)

    def note(self, time_ns: int, pose: Pose, twist: tuple[float, float]) -> None:
        """pose: x, y (m), heading (rad); twist: m/s forwards, rad/s, since the message before."""
        self._first = self._first or pose
        self.moved |= pose != self._first
        self.twisted |= twist != (0.0, 0.0)
        rates, dt = self._rates.since(time_ns, pose), (time_ns - self._last_ns) / 1e9
        self._last_ns = time_ns
        self.turns_by_twist.note(time_ns, (0.0, 0.0, twist[1]))
        if rates is None:
            return
        self.turns_by_poses.note(time_ns, (0.0, 0.0, rates[1]))
        if time_ns // _WINDOW_NS != self._window:
            self._compare()
            self._window, self._sums = time_ns // _WINDOW_NS, [0.0] * 4
        for at, rate in enumerate((*rates, *twist)):
            self._sums[at] += rate * dt
        self.way_m[0] += abs(rates[0] * dt)
        self.way_m[1] += abs(twist[0] * dt)

    @property
    def by_poses(self) -> bool:
        """[ours] Whether the poses are to be believed rather than the twist.

        Poses are what drivers are tested by; twists come in a wrong frame (the world's), in wrong units, or not at all.
        """
        return self.moved and (not self.twisted or self.unlike)

    @property
    def unlike(self) -> bool:
        """Whether twist and poses contradict each other wherever the robot moves."""
        return self._unlike >= _LEAST and self._unlike > _MANY * self._moving

    @property
    def longer(self) -> float | None:
        """[ours] By which share the way by twists is longer, where both tell the same motion: a wrong radius of the
        wheels. None: they agree, or it hardly moved. test_recording_ros.py::test_a_twist_of_another_scale_is_said."""
        poses, twist = self._far_m
        if self.unlike or not self.twisted or min(poses, twist) < _FAR_M or abs(twist / poses - 1) < _SCALE:
            return None
        return twist / poses - 1

    def _compare(self) -> None:
        moving = unlike = False
        if max(map(abs, self._sums[::2])) > _MOVES[0]:
            self._far_m = [far + abs(way) for far, way in zip(self._far_m, self._sums[::2], strict=True)]
        for poses, twists, least in zip(self._sums[:2], self._sums[2:], _MOVES, strict=True):
            size = max(abs(poses), abs(twists))
            moving |= size > least
            unlike |= size > least and abs(poses - twists) > _UNLIKE * size
        self._moving += moving
        self._unlike += unlike
