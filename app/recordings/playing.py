"""A recording played through the engine: a stand-in until the engine's rules for recordings are there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

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
            estimate = brain.step(moment.image, motion, behaviour=moment.behaviour)
            yield Step(moment, estimate, brain, motion)
