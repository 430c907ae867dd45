"""Which of all transforms is the odometry, by what moves and where it leads rather than by a list of names."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from app.recordings.formats import ros_messages as ros
from app.recordings.recording import Pose

_ODOM = re.compile(r"odom", re.IGNORECASE)
_BASE = re.compile(r"(^|[_/])(base|footprint|body|chassis|robot|vehicle|car)([_/]|$)", re.IGNORECASE)
_MOVES = 1e-3  # m or rad
_MOST = 10_000  # transforms; no robot has so many

Edge = tuple[str, str]  # parent, child


@dataclass
class Moving:
    """One transform, after all messages have gone by."""

    count: int = 0  # messages in which it is
    first: Pose | None = None
    moved: bool = False

    def note(self, pose: Pose) -> None:
        self.first = self.first or pose
        self.moved |= max(abs(a - b) for a, b in zip(pose, self.first, strict=True)) > _MOVES


def transforms_in(told: Any) -> Iterator[tuple[Edge, Any]]:
    """Those of a message, each once."""
    seen = set[Edge]()
    for part in told.transforms:
        edge = part.header.frame_id.strip("/"), part.child_frame_id.strip("/")
        if edge not in seen:
            seen.add(edge)
            yield edge, part


def note(told: Any, edges: dict[Edge, Moving]) -> None:
    """ValueError: one of them is broken."""
    for edge, part in transforms_in(told):
        if edge in edges or len(edges) < _MOST:
            moving = edges.setdefault(edge, Moving())
            moving.count += 1
            moving.note(ros.pose(part))


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
    """[ours] Of the transforms of all topics: one that moves rather than one that does not, then from a frame of odometry
    to the robot, then whatever moves and leads to the robot."""
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
