"""Four bytes that tell one tick of a run from another: where the robot is, what it sees, and where it believes to be."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.session import Session

SIZE = 4
_NUMBERS = struct.Struct("<12d")


def pulse_of(session: Session) -> bytes:
    """The pulse of the tick that the session has just run. It costs some microseconds; a `state_hash` ten thousand times that.

    Of the picture it holds how much it differs from the most similar view: a sum over the picture alone would cost more
    than all the rest.
    """
    truth, frame, estimate = session.truth, session.frame, session.estimate
    x, y, heading_rad = (truth.x, truth.y, truth.heading_rad) if truth else (0.0, 0.0, 0.0)  # a recording may have none
    pose, packet, seen = estimate.pose_map_robot, estimate.packet, estimate.recognition
    numbers = _NUMBERS.pack(
        x, y, heading_rad, frame.odometry_speed, frame.odometry_yaw_rate, pose.x, pose.y,
        pose.heading_rad, packet.mass, estimate.experience, seen.view, seen.difference,
    )  # fmt: skip
    return zlib.crc32(numbers).to_bytes(SIZE, "little")
