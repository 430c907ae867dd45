"""Recordings of ROS robots, whatever file they are in: topics are chosen, messages put in order and unpacked."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from app.recordings.formats import ros_messages as ros
from app.recordings.formats.ros_messages import SONAR_ANGLES, Packet
from app.recordings.formats.ros_odometry import transforms_in
from app.recordings.formats.ros_topics import Choice, Roles, Topic, roles_of, times_of, turned_otherwise
from app.recordings.formats.ros_topics import unused as unused_topics
from app.recordings.formats.sensed import Beams, Problems, Rates, Sensed
from app.recordings.formats.streamed import StreamedRecording
from disk.words import plain

ORDER_S, ORDER_BYTES = 0.5, 64_000_000  # a message waits so long for earlier ones, or until so much waits
MOST_TOPICS = 10_000

Packets = Callable[[Problems], Iterator[Packet]]


def open_ros(
    path: Path, format_: str, packets: Packets, choice: Choice | None = None, unused: tuple[str, ...] = ()
) -> StreamedRecording:
    """packets: gives the messages, anew each time; unused: what is there beside them, and why it is not used.

    ValueError: there is nothing in it that could be played.
    """
    topics, angles = _topics(packets)
    roles = roles_of(topics, choice or Choice())
    source = _Source(packets, topics, roles, angles)
    try:
        unused = (*unused, *unused_topics(topics, roles))
        return StreamedRecording(path.name, format_, source.sensed, tuple(source.uses()), unused)
    except ValueError as error:
        there = ", ".join(f"{name} ({topic.type})" for name, topic in list(topics.items())[:6]) or "none"
        raise ValueError(f"{error} Topics of ROS in it: {there}") from None


def _topics(packets: Packets) -> tuple[dict[str, Topic], Beams]:
    """All topics, and where the sonars of a run of ours look."""
    topics, angles = dict[str, Topic](), Beams()
    for packet in packets(Problems()):
        if packet.type == SONAR_ANGLES:
            angles = angles if angles.angles_rad else ros.told_angles(packet)
            continue
        topic = topics.get(packet.topic)
        if topic is None:
            if len(topics) >= MOST_TOPICS:
                raise ValueError(f"more than {MOST_TOPICS} topics; no robot has so many")
            topic = topics[packet.topic] = Topic(packet.type)
        topic.note(packet)
    return topics, angles


class _Source:
    def __init__(self, packets: Packets, topics: dict[str, Topic], roles: Roles, angles: Beams) -> None:
        self._packets, self._topics, self._roles = packets, topics, roles
        self._sonars = Beams(angles.angles_rad, topics[roles.scan].limit_m if roles.scan else None)
        self._times = times_of({name: topics[name].stamps for name in roles.used()})

    def uses(self) -> Iterator[str]:
        """Sentences: which topic is used for what."""
        r = self._roles
        how = "its twist"
        if r.odometry and self._topics[r.odometry].odometer.by_poses:
            how = "its poses, since it reports no speeds"
            if self._topics[r.odometry].odometer.unlike:
                how = "its poses, since its twist does not lead from one to the next"
        edge = " to ".join(plain(frame, 60) for frame in r.wheels.edge) if r.wheels else ""
        for words, name in (
            ("camera", r.camera),
            (f"speed and yaw rate ({how})" if r.gyro is None else f"speed ({how})", r.odometry),
            (f"speed and yaw rate ({edge})", r.wheels and r.wheels.topic),
            ("yaw rate (gyro, about what is up)", r.gyro), ("ranges", r.scan if r.sonars is None else r.sonars),
            ("truth", r.truth), ("behaviour", r.behaviour),
        ):  # fmt: skip
            if name is not None:
                yield f"{words}: {name}, {self._topics[name].count} messages of {self._topics[name].type}"
        times, why = self._times, f", since {self._times.why}" if self._times.why else ""
        yield f"time: {'that in the headers' if times.stamped else f'when a message was written down{why}'}"

    def sensed(self, problems: Problems) -> Iterator[Sensed]:
        """Everything that is used, in the order of time."""
        self._contradictions(problems)
        rates = Rates()
        for time_ns, packet in self._in_order(problems):
            try:
                sensed = self._unpacked(packet, Sensed(time_ns, packet.where, source=_source(packet)), rates)
            except ValueError as error:
                problems.add(f"messages of {packet.topic} left out", packet.where, f"left out: {error}")
                continue
            yield sensed

    def _contradictions(self, problems: Problems) -> None:
        """What sources say of each other."""
        if self._times.problem:
            problems.add("times", "time", f"{self._times.why}; what counts is when a message was written down")
        name = self._roles.odometry
        if name is not None and self._topics[name].odometer.unlike:
            poses, twist = self._topics[name].odometer.way_m
            ways = f"{poses:.2f} m by poses, {twist:.2f} m by twist, forwards and backwards"
            problems.add(
                "odometry", name, f"its twist does not lead from one pose to the next ({ways}); poses are used"
            )
        elif name is not None and (longer := self._topics[name].odometer.longer) is not None:
            ways = f"{abs(longer):.0%} {'longer' if longer > 0 else 'shorter'}"
            problems.add("odometry", name, f"the way by its twist is {ways} than that by its poses; the twist is used")

        for gyro, wheels_rad, gyro_rad in turned_otherwise(self._topics, self._roles):
            turns = f"{wheels_rad:.1f} rad by the wheels, {gyro_rad:.1f} rad by the gyro, to and fro"
            used = (
                "the gyro is used" if gyro == self._roles.gyro else "the wheels are used; --gyro-topic takes the gyro"
            )
            problems.add("gyro", plain(gyro, 60), f"it turns otherwise than {self._roles.odometry} ({turns}); {used}")

    def _in_order(self, problems: Problems) -> Iterator[tuple[int, Packet]]:
        used, waiting, size, newest = self._roles.used(), list[tuple[int, int, Packet]](), 0, 0
        for order, packet in enumerate(self._packets(problems)):
            if packet.topic not in used or not self._tells(packet, problems):
                continue
            time = ros.stamp_ns(packet) if self._times.stamped else packet.time_ns
            heapq.heappush(waiting, (time, order, packet))
            size, newest = size + len(packet.data), max(newest, time)
            while waiting and (waiting[0][0] < newest - ORDER_S * 1e9 or size > ORDER_BYTES):
                time, _, packet = heapq.heappop(waiting)
                size -= len(packet.data)
                yield time, packet
        while waiting:
            time, _, packet = heapq.heappop(waiting)
            yield time, packet

    def _tells(self, packet: Packet, problems: Problems) -> bool:
        """Whether it is one of its topic. Counts it."""
        wheels = self._roles.wheels
        if packet.type != self._topics[packet.topic].type:
            problems.seen(_source(packet))
            told = f"left out: its type is {packet.type}, and not that of the others"
            problems.add(f"messages of {packet.topic} left out", packet.where, told)
            return False
        if wheels is not None and packet.topic == wheels.topic:
            try:
                if all(edge != wheels.edge for edge, _ in transforms_in(ros.message(packet))):
                    return False  # it is one of those that are told of as unused
            except ValueError:
                pass  # told when it is unpacked
        problems.seen(_source(packet))
        return True

    def _unpacked(self, packet: Packet, empty: Sensed, rates: Rates) -> Sensed:
        """What a message tells, added to what has its time and place. ValueError: it is broken."""
        r, name = self._roles, packet.topic
        if name == r.camera:
            return replace(empty, image=partial(ros.picture, packet))
        told = ros.message(packet)
        if name == r.odometry:
            by_poses = self._topics[name].odometer.by_poses
            moved = rates.since(empty.time_ns, ros.pose(told)) if by_poses else ros.twist(told)
            sensed = _moving(empty, moved)
            return sensed if r.gyro is None else replace(sensed, yaw_rate=None)
        if r.wheels is not None and name == r.wheels.topic:
            pose = r.wheels.pose(told)
            return empty if pose is None else _moving(empty, rates.since(empty.time_ns, pose))
        if name == r.gyro:
            return replace(empty, yaw_rate=ros.gyro(told, self._topics[name].up))
        if name == r.truth:
            return replace(empty, truth=ros.pose(told))
        if name == r.behaviour:
            return replace(empty, behaviour=int(told.data))
        return self._scan(told, empty, name)

    def _scan(self, told: object, empty: Sensed, name: str) -> Sensed:
        r = self._roles
        if name == r.scan:
            beams = ros.scan_beams(told)
            if not r.sonars:
                return replace(empty, ranges_m=ros.scan_ranges(told), beams=beams)
            self._sonars = Beams(self._sonars.angles_rad or beams.angles_rad, self._sonars.limit_m)
            return empty
        ranges = np.array(getattr(told, "data", ()), np.float64)
        if np.isnan(ranges).any() or len(ranges) != len(self._sonars.angles_rad or ranges):
            raise ValueError("its ranges are no numbers, or not as many as those of the scan")
        return replace(empty, ranges_m=ranges, beams=self._sonars if self._sonars.angles_rad else None)


def _source(packet: Packet) -> str:
    return f"messages of {packet.topic}"


def _moving(sensed: Sensed, moved: tuple[float, float] | None) -> Sensed:
    return sensed if moved is None else replace(sensed, speed=moved[0], yaw_rate=moved[1])
