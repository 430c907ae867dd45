"""A recording played through the engine: at each moment the same brain looks, moves and maps as in the simulator."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from app.config import Config
from app.recordings.brain_rules import rules
from app.recordings.motion import Motion
from app.recordings.recording import Moment, Recording
from app.recordings.scan_odometry import ScanRules, is_laser
from app.recordings.scan_ties import ScanTies
from disk import kind
from ratslam_core import Estimate, Odometry, RatSlam


@dataclass(frozen=True, slots=True)
class Step:
    """One moment, and what the brain made of it."""

    moment: Moment
    estimate: Estimate
    brain: RatSlam
    motion: Odometry
    ranges_m: NDArray[np.float64] | None = None  # as the brain was given them
    gap: bool = False  # the robot was away for a while


class Player:
    """Plays a recording; each time from the beginning, with a new brain, and with the same result."""

    def __init__(
        self,
        recording: Recording,
        seed: int = 0,
        config: Config | None = None,
        path: Path | None = None,
        scans: ScanRules | None = None,
    ) -> None:
        """config: wins over that of the recording, if it is a run of ours, and over the rules that look at it. seed: that of a
        run of ours wins. path: where the recording lies, if it is opened from there without being told more: its run can
        then be kept."""
        about = recording.about
        self.path = path
        self.recording, self.seed = recording, seed if about.seed is None else about.seed
        ruled, self._motion = rules(recording, scans)
        self._scans = scans or ScanRules()
        self.config = config or about.config or ruled
        angles = recording.about.beam_angles_rad
        # The front end for lasers takes beams from right to left; the order of sonars is that in which they were told.
        self._order = np.argsort(angles, kind="stable") if is_laser(recording.about) else np.arange(len(angles))

    def brain(self) -> RatSlam:
        """A new one, as a session of this seed would make it."""
        brain_seed, _ = np.random.SeedSequence([self.seed, 1]).spawn(2)
        angles = np.array(self.recording.about.beam_angles_rad)[self._order].tolist()
        return RatSlam(self.config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=angles)

    def begin(self) -> Playing:
        """What plays the recording, before its first moment."""
        about = self.recording.about
        ties = ScanTies(about, self._scans) if is_laser(about) else None
        return Playing(self.brain(), self._motion.anew(), ties, self._order.copy())

    def steps(self) -> Iterator[Step]:
        """Every moment in turn. It counts moments and not time, so the pace of whoever asks changes nothing."""
        playing = self.begin()
        for moment in self.recording.moments():
            yield playing.step(moment)


@kind("playing/1")
class Playing:
    """A brain on its way through a recording, and what its motion is read with: all that decides what comes of the moments
    to come. It can be copied between two of them."""

    def __init__(self, brain: RatSlam, motion: Motion, ties: ScanTies | None, order: NDArray[np.int64]) -> None:
        """order: in which the brain is told the ranges."""
        self.brain, self._motion, self._ties, self._order = brain, motion, ties, order

    @property
    def ties(self) -> ScanTies | None:
        """What ties the experiences of the brain by its laser's scans; None: it has no laser."""
        return self._ties

    def ranges_of(self, moment: Moment) -> NDArray[np.float64] | None:
        """As the brain is given them."""
        return None if moment.ranges_m is None else moment.ranges_m[self._order]

    def step(self, moment: Moment, watch: Callable[[str], None] | None = None) -> Step:
        """Play the next moment. watch: called after each stage of RatSLAM; it must not change anything."""
        brain, motion = self.brain, self._motion
        moved = motion.of(moment)
        if motion.gap:
            brain.declare_kidnapped()
        ranges_m = self.ranges_of(moment)
        if self._ties is not None:
            self._ties.see(moment.ranges_m)
        estimate = brain.step(
            moment.image, moved, behaviour=moment.behaviour, ranges_m=ranges_m, watch=watch, witness=self._ties
        )
        if self._ties is not None and estimate.created:
            self._ties.made(brain.experience_map)
        return Step(moment, estimate, brain, moved, ranges_m, motion.gap)
