"""A room with a gap for a door, in which things can live, and a robot without noise."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from sim2d import Door, Drive, SimParams, Simulator, Wall, World

from .rooms import GREY, room

EXACT = SimParams(
    odometry_noise=0.0, odometry_scale_error=0.0, gyro_bias=0.0, image_noise=0.0, sonar_noise_m=0.0, laser_noise_m=0.0,
    laser_beams=181,
)  # fmt: skip
FORWARD, STAY = Drive(0.5, 0.0), Drive(0.0, 0.0)
DIVIDED = (Wall(3.0, 0.0, 3.0, 1.5, "wall", 2.6, GREY), Wall(3.0, 2.5, 3.0, 4.0, "wall", 2.6, GREY))
DOOR = Door("lab", 3.0, 1.5, math.pi / 2, 1.0, swing_rad=-math.pi / 2, open=False)


def living(**things: Any) -> World:
    """The 4 m room, divided at x = 3 except for a gap of 1 m. The robot stands before the gap and faces it."""
    return replace(room(*DIVIDED), **things)


def run(simulator: Simulator, drive: Drive, ticks: int) -> Any:
    return [simulator.step(drive) for _ in range(ticks)][-1]
