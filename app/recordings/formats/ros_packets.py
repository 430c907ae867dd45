"""A message as a file of ROS holds it: topic, type and bytes, whichever file it came from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Packet:
    """A message that is not unpacked yet."""

    topic: str
    type: str  # as ROS 2 writes it: nav_msgs/msg/Odometry
    ros1: bool  # packed as in ROS 1, otherwise CDR
    time_ns: int  # when it was written down
    data: bytes
    number: int  # in the file, from 0

    @property
    def where(self) -> str:
        return f"message {self.number} ({self.topic})"


def type_of(name: str) -> str:
    """The type's name as ROS 2 writes it."""
    parts = name.split("/")
    return f"{parts[0]}/msg/{parts[1]}" if len(parts) == 2 else name


MOST_CHUNK = 256_000_000  # bytes, packed and unpacked; a file that claims more is not believed
