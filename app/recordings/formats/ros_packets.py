"""A message as a file of ROS holds it: topic, type and bytes, whichever file it came from."""

from __future__ import annotations

from dataclasses import dataclass

from app.recordings.formats.packed import ZSTD, zstd_unpacked


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
    """A message of ROS 2; `ros2 bag record --compression-mode message` packs each. ValueError: it cannot be unpacked."""
    return zstd_unpacked(data, MOST_CHUNK) if data.startswith(ZSTD) else data


SONAR_ANGLES = "angles of the sonars"  # type of a packet that is no message: what a run of ours says of itself
MOST_CHUNK = 256_000_000  # bytes, packed and unpacked; a file that claims more is not believed
