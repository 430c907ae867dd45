"""Paths in the format of the TUM benchmark: a line "timestamp x y z qx qy qz qw" for each tick, as evo reads it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from app.session import Session

_Array = NDArray[np.float64]


def tum_files(ticks: Iterator[Session]) -> dict[str, bytes]:
    """Three paths: the truth (office frame), the estimate as the map tells it at the end, and what was believed at the time.

    The second is the path that SLAM programs are compared by: corrections of the map have moved what came before. The first is
    absent where a recording has no truth.
    """
    time_s: list[float] = []
    true_s: list[float] = []
    truth: list[tuple[float, float, float]] = []
    believed: list[tuple[float, float, float]] = []
    local: list[tuple[float, float, float]] = []
    at: list[int] = []
    session = None
    for session in ticks:
        true, map_ = session.truth, session.brain.experience_map
        robot, inside = session.estimate.pose_map_robot, map_.local_pose
        time_s.append(session.time_s)
        if true is not None:
            true_s.append(session.time_s)
            truth.append((true.x, true.y, true.heading_rad))
        believed.append((robot.x, robot.y, robot.heading_rad))
        local.append((inside.x, inside.y, inside.heading_rad))
        at.append(map_.active)
    if session is None:
        return {}
    mapped = _through(session.brain.experience_map.poses[at], np.array(local))
    paths = {"estimate": (time_s, mapped), "believed": (time_s, np.array(believed))}
    if truth:
        paths = {"truth": (true_s, np.array(truth)), **paths}
    return {name: _tum(*path) for name, path in paths.items()}


def _through(poses: _Array, local: _Array) -> _Array:
    """(n, 3): poses that are given in frames which themselves lie at these poses."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x = poses[:, 0] + c * local[:, 0] - s * local[:, 1]
    y = poses[:, 1] + s * local[:, 0] + c * local[:, 1]
    return np.stack([x, y, poses[:, 2] + local[:, 2]], axis=1)


def _tum(time_s: list[float], poses: _Array) -> bytes:
    lines = [
        f"{at:.6f} {x:.6f} {y:.6f} 0 0 0 {math.sin(heading / 2):.9f} {math.cos(heading / 2):.9f}\n"
        for at, (x, y, heading) in zip(time_s, poses.tolist(), strict=True)
    ]
    return "".join(lines).encode()
