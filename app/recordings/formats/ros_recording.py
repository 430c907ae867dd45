"""Recordings of ROS robots, whatever file they are in: topics are chosen, messages put in order and unpacked."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from app.recordings.formats import ros_messages as ros
from app.recordings.formats.problems import Problems
from app.recordings.formats.ros_packets import Packet
from app.recordings.formats.ros_topics import Choice, Roles, Topic, is_odometry, roles_of
from app.recordings.formats.sensed import Rates, Sensed
from app.recordings.formats.streamed import Beams, StreamedRecording

ORDER_S, ORDER_BYTES = 0.5, 64_000_000  # a message waits so long for earlier ones, or until so much waits
MOST_TOPICS = 10_000

Packets = Callable[[Problems], Iterator[Packet]]


def open_ros(path: Path, format_: str, packets: Packets, choice: Choice | None = None) -> StreamedRecording:
    """packets: gives the messages, anew each time. ValueError: there is nothing in it that could be played."""
    topics = _topics(packets)
    roles = roles_of(topics, choice or Choice())
    source = _Source(packets, topics, roles)
    try:
        return StreamedRecording(path.name, format_, source.sensed, lambda: source.beams, tuple(source.uses()))
    except ValueError as error:
        there = ", ".join(f"{name} ({topic.type})" for name, topic in list(topics.items())[:6]) or "none"
        raise ValueError(f"{error} Topics of ROS in it: {there}") from None


def _topics(packets: Packets) -> dict[str, Topic]:
    topics: dict[str, Topic] = {}
    for packet in packets(Problems()):
        topic = topics.get(packet.topic)
        if topic is None:
            if len(topics) >= MOST_TOPICS:
                raise ValueError(f"more than {MOST_TOPICS} topics; no robot has so many")
            topic = topics[packet.topic] = Topic(packet.type)
        topic.note(packet)
    return topics


class _Source:
    def __init__(self, packets: Packets, topics: dict[str, Topic], roles: Roles) -> None:
        self._packets, self._topics, self._roles = packets, topics, roles
        self.beams = Beams()
        used = {name: topics[name] for name in self._used() if name is not None}
        self._stamped = all(topic.stamped for topic in used.values() if topic.type in ros.STAMPED)
        self._stamped &= all(topic.type in ros.STAMPED for topic in used.values())

    def _used(self) -> list[str | None]:
        r = self._roles
        return [r.camera, r.odometry, r.transforms, r.gyro, r.scan, r.truth, r.sonars, r.behaviour]

    def uses(self) -> Iterator[str]:
        """Sentences: which topic is used for what."""
        r = self._roles
        odometry = self._topics[r.odometry] if r.odometry else None
        how = "its poses, since it reports no speeds" if odometry and self._by_poses(odometry) else "its twist"
        for words, name in (
            ("camera", r.camera),
            (f"speed and yaw rate ({how})" if r.gyro is None else f"speed ({how})", r.odometry),
            ("speed and yaw rate (odom to base_link)", r.transforms),
            ("yaw rate (gyro, about what is up)", r.gyro), ("ranges", r.scan if r.sonars is None else r.sonars),
            ("truth", r.truth), ("behaviour", r.behaviour),
        ):  # fmt: skip
            if name is not None:
                yield f"{words}: {name}, {self._topics[name].count} messages of {self._topics[name].type}"
        yield f"time: {'that in the headers' if self._stamped else 'when a message was written down'}"

    @staticmethod
    def _by_poses(topic: Topic) -> bool:
        return topic.moved and not topic.twisted

    def sensed(self, problems: Problems) -> Iterator[Sensed]:
        """Everything that is used, in the order of time."""
        rates = Rates()
        for time_ns, packet in self._in_order(problems):
            try:
                sensed = self._unpacked(packet, time_ns, rates)
            except ValueError as error:
                problems.add(f"messages of {packet.topic} left out", packet.where, f"left out: {error}")
                continue
            if sensed is not None:
                yield sensed

    def _in_order(self, problems: Problems) -> Iterator[tuple[int, Packet]]:
        used, waiting, size, newest = {*self._used()}, list[tuple[int, int, Packet]](), 0, 0
        for order, packet in enumerate(self._packets(problems)):
            if packet.topic not in used or packet.type != self._topics[packet.topic].type:
                continue
            time = ros.stamp_ns(packet) if self._stamped else packet.time_ns
            heapq.heappush(waiting, (time, order, packet))
            size, newest = size + len(packet.data), max(newest, time)
            while waiting and (waiting[0][0] < newest - ORDER_S * 1e9 or size > ORDER_BYTES):
                time, _, packet = heapq.heappop(waiting)
                size -= len(packet.data)
                yield time, packet
        while waiting:
            time, _, packet = heapq.heappop(waiting)
            yield time, packet

    def _unpacked(self, packet: Packet, time_ns: int, rates: Rates) -> Sensed | None:
        r, where, name = self._roles, packet.where, packet.topic
        if name == r.camera:
            return Sensed(time_ns, where, partial(ros.picture, packet))
        told = ros.message(packet)
        if name == r.odometry:
            return self._odometry(told, time_ns, where, rates)
        if name == r.transforms:
            return self._transform(told, time_ns, where, rates)
        if name == r.gyro:
            return Sensed(time_ns, where, yaw_rate=ros.gyro(told, self._topics[name].up))
        if name == r.truth:
            return Sensed(time_ns, where, truth=ros.pose(told))
        if name == r.behaviour:
            return Sensed(time_ns, where, behaviour=int(told.data))
        return self._scan(told, time_ns, where, name)

    def _odometry(self, told: object, time_ns: int, where: str, rates: Rates) -> Sensed | None:
        assert self._roles.odometry is not None
        if self._by_poses(self._topics[self._roles.odometry]):
            moved = rates.since(time_ns, ros.pose(told))
        else:
            moved = ros.twist(told)
        if moved is None:
            return None
        return Sensed(time_ns, where, speed=moved[0], yaw_rate=None if self._roles.gyro else moved[1])

    def _transform(self, told: object, time_ns: int, where: str, rates: Rates) -> Sensed | None:
        for part in getattr(told, "transforms", ()):
            if is_odometry(part.header.frame_id, part.child_frame_id):
                moved = rates.since(time_ns, ros.pose(part))
                return None if moved is None else Sensed(time_ns, where, speed=moved[0], yaw_rate=moved[1])
        return None

    def _scan(self, told: object, time_ns: int, where: str, name: str) -> Sensed | None:
        r = self._roles
        if name == r.scan:
            beams = ros.scan_beams(told)
            if not self.beams.angles_rad:
                self.beams = beams
            ranges = ros.scan_ranges(told, len(self.beams.angles_rad))
            return None if r.sonars else Sensed(time_ns, where, ranges_m=ranges)
        ranges = np.array(getattr(told, "data", ()), np.float64)
        if np.isnan(ranges).any() or len(ranges) > 10_000:
            raise ValueError("its ranges are no numbers")
        return Sensed(time_ns, where, ranges_m=ranges)
