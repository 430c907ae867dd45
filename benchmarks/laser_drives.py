"""Logs of a laser in other buildings: our own robot explores them, with other lasers, other rates and other wheels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from app.config import Config
from app.session import Session
from benchmarks.laser_variants import Array, Log, moved
from sim2d import World


@dataclass(frozen=True, slots=True)
class Drive:
    """How long a robot of ours explores a world, and the laser that it has."""

    world: str  # of the simulator, or a file of a plan beside the project
    minutes: float
    seed: int
    beams: int = 181
    around: bool = False  # it sees all round, not half of it
    range_m: float = 30.0
    every_s: float = 0.5  # between two scans
    noise_m: float = 0.01
    bias: float = 0.0  # rad/s that the wheels have beside their usual errors


OF_OURS = (
    Drive("corridors", 15, 1),
    Drive("office", 10, 2, range_m=8.0, every_s=1.0, bias=0.02),
    Drive("floor", 12, 3, beams=360, around=True, range_m=12.0, every_s=0.3),
    Drive("gdc_3ne/3ne.yaml", 15, 4, every_s=2.0, range_m=80.0, noise_m=0.02),
)
OF_OURS_HELD_OUT = (
    Drive("campus", 20, 11),
    Drive("loop", 10, 12, range_m=8.0, bias=-0.02),
    Drive("living", 12, 13, beams=91, range_m=15.0, every_s=0.2),
    Drive("open-plan", 12, 14, beams=361, around=True, range_m=20.0, every_s=1.5),
    Drive("suburb", 20, 15, range_m=80.0, every_s=1.0),
    Drive("amrl/AHG2.vectormap.json", 15, 16, noise_m=0.03),
    Drive("twins", 12, 17),
)


def driven(world: World, drive: Drive) -> Log:
    """What the robot would have logged."""
    fan = math.tau if drive.around else math.pi
    config = Config().with_values(
        {
            "robot.laser_beams": drive.beams,
            "robot.laser_fov_rad": fan,
            "robot.laser_range_m": drive.range_m,
            "robot.laser_noise_m": drive.noise_m,
        }
    )
    session = Session(world, drive.seed, config)
    at, rows = np.zeros(3), list[tuple[float, Array, Array, Array]]()
    apart = round(drive.every_s / session.frame.dt)
    for k in range(round(drive.minutes * 60 / session.frame.dt)):
        session.tick()
        frame, true = session.frame, session.truth
        moves = frame.odometry_speed != 0 or frame.odometry_yaw_rate != 0
        at = moved(at, frame.odometry_speed * frame.dt, (frame.odometry_yaw_rate + drive.bias * moves) * frame.dt)
        if k % apart == 0 and true is not None:
            # as the laser counts, from the right
            rows.append(
                (k * frame.dt, at, frame.laser_m[::-1].astype(np.float64), np.array([true.x, true.y, true.heading_rad]))
            )
    times, wheels, ranges, truth = (np.array(column) for column in zip(*rows, strict=True))
    ranges = np.where(ranges >= drive.range_m - 1e-3, np.inf, ranges)
    step = fan / drive.beams if drive.around else fan / (drive.beams - 1)
    angles = np.array([fan / 2 - k * step for k in reversed(range(drive.beams))])
    return Log(times, times, wheels, ranges, angles, drive.range_m, truth)
