"""A recording played through the engine: a stand-in until the engine's rules for recordings are there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.config import Config
from app.recordings.recording import Moment, Recording
from ratslam_core import Estimate, Odometry, RatSlam


@dataclass(frozen=True, slots=True)
class Step:
    """One moment, and what the brain made of it."""

    moment: Moment
    estimate: Estimate
    brain: RatSlam
    motion: Odometry


class Player:
    """Plays a recording, each time from the beginning."""

    def __init__(self, recording: Recording, seed: int = 0, config: Config | None = None) -> None:
        self.recording, self.seed, self.config = recording, seed, config or Config()

    def steps(self) -> Iterator[Step]:
        """Every moment in turn."""
        brain = RatSlam(self.config.engine, np.random.default_rng(self.seed))
        for moment in self.recording.moments():
            speed = moment.throttle if moment.speed is None else moment.speed
            motion = Odometry(speed or 0.0, moment.yaw_rate or 0.0, moment.dt)
            estimate = brain.step(_seen(moment), motion, behaviour=moment.behaviour)
            yield Step(moment, estimate, brain, motion)


def _seen(moment: Moment) -> NDArray[np.uint8]:
    """The picture, or the scan as one: each beam a column, the nearer the brighter."""
    if moment.image is not None or moment.ranges_m is None:
        return moment.image if moment.image is not None else np.zeros((8, 8), np.uint8)
    row = (255 * np.exp(-moment.ranges_m / 4)).astype(np.uint8)
    return np.tile(np.repeat(row, max(1, -(-32 // len(row)))), (16, 1))
