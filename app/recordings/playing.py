"""A recording played through the engine: at each moment the same brain looks, moves and maps as in the simulator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.config import Config
from app.recordings.brain_rules import rules
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
    """Plays a recording; each time from the beginning, with a new brain, and with the same result."""

    def __init__(self, recording: Recording, seed: int = 0, config: Config | None = None) -> None:
        """config: wins over the rules that look at the recording."""
        self.recording, self.seed = recording, seed
        ruled, self._motion = rules(recording)
        self.config = ruled if config is None else config

    def brain(self) -> RatSlam:
        """A new one, as a session of this seed would make it."""
        brain_seed, _ = np.random.SeedSequence([self.seed, 1]).spawn(2)
        angles = self.recording.about.beam_angles_rad
        return RatSlam(self.config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=angles)

    def steps(self) -> Iterator[Step]:
        """Every moment in turn. It counts moments and not time, so the pace of whoever asks changes nothing."""
        brain = self.brain()
        motion = self._motion.anew()
        for moment in self.recording.moments():
            moved = motion.of(moment)
            if motion.gap:
                brain.declare_kidnapped()
            estimate = brain.step(moment.image, moved, ranges_m=moment.ranges_m)
            yield Step(moment, estimate, brain, moved)
