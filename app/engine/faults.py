"""Faults: an exception in words, and the check that all numbers of a session are still finite."""

from __future__ import annotations

import math

import numpy as np

from app.session import Session


def words_of(error: BaseException) -> str:
    text = str(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def require_finite(session: Session) -> None:
    """FloatingPointError names what is not finite after this tick. Summing all poses costs microseconds."""
    truth, robot, packet = session.truth, session.estimate.pose_map_robot, session.estimate.packet
    numbers = {
        "the robot's true pose": () if truth is None else (truth.x, truth.y, truth.heading_rad),
        "the robot's pose in the map": (robot.x, robot.y, robot.heading_rad),
        "the winning packet": (packet.x, packet.y, packet.heading_rad, packet.mass),
        "the activity of the pose cells": (float(session.brain.pose_cells.active[1].sum(dtype=np.float64)),),
        "the map's poses": (float(session.brain.experience_map.poses.sum()),),
    }
    for name, values in numbers.items():
        if not all(math.isfinite(value) for value in values):
            raise FloatingPointError(f"not finite after tick {session.tick_count}: {name}")
