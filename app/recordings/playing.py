"""A recording played through the engine: at each moment the same brain looks, moves and maps as in the simulator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.config import Config
from app.recordings.brain_rules import rules
from app.recordings.recording import Moment, Recording
from app.recordings.scan_odometry import is_laser
from app.recordings.scan_ties import ScanTies
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
        """config: wins over that of the recording, if it is a run of ours, and over the rules that look at it. seed: that of a
        run of ours wins."""
        about = recording.about
        self.recording, self.seed = recording, seed if about.seed is None else about.seed
        ruled, self._motion = rules(recording)
        self.config = config or about.config or ruled
        angles = recording.about.beam_angles_rad
        # The front end for lasers takes beams from right to left; the order of sonars is that in which they were told.
        self._order = np.argsort(angles, kind="stable") if is_laser(recording.about) else np.arange(len(angles))

    def brain(self) -> RatSlam:
        """A new one, as a session of this seed would make it."""
        brain_seed, _ = np.random.SeedSequence([self.seed, 1]).spawn(2)
        angles = np.array(self.recording.about.beam_angles_rad)[self._order].tolist()
        return RatSlam(self.config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=angles)

    def steps(self) -> Iterator[Step]:
        """Every moment in turn. It counts moments and not time, so the pace of whoever asks changes nothing."""
        brain = self.brain()
        motion = self._motion.anew()
        ties = ScanTies(self.recording.about) if is_laser(self.recording.about) else None
        for moment in self.recording.moments():
            moved = motion.of(moment)
            if motion.gap:
                brain.declare_kidnapped()
            ranges_m = None if moment.ranges_m is None else moment.ranges_m[self._order]
            estimate = brain.step(moment.image, moved, behaviour=moment.behaviour, ranges_m=ranges_m)
            if ties is not None and estimate.created and moment.ranges_m is not None:
                ties.made(brain.experience_map, moment.ranges_m)
            yield Step(moment, estimate, brain, moved)
