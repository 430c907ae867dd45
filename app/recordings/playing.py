"""A recording played through the engine: at each moment the same brain looks, moves and maps as in the simulator."""

from __future__ import annotations

from collections.abc import Iterator
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
from app.sensor_input import SensorInput
from disk import kind
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

    @property
    def beam_angles_rad(self) -> list[float]:
        """Of the ranges, as the brain is given them."""
        return np.array(self.recording.about.beam_angles_rad)[self._order].tolist()

    def brain(self) -> RatSlam:
        """A new one, as a session of this seed would make it."""
        brain_seed, _ = np.random.SeedSequence([self.seed, 1]).spawn(2)
        return RatSlam(self.config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=self.beam_angles_rad)

    def new_ties(self) -> ScanTies | None:
        """What ties the experiences of a new brain by its laser's scans; None: it has no laser."""
        about = self.recording.about
        return ScanTies(about, self._scans) if is_laser(about) else None

    def reader(self) -> MomentReader:
        """What reads the recording, before its first moment."""
        return MomentReader(self._motion.anew(), self._order.copy())

    def steps(self) -> Iterator[Step]:
        """Every moment in turn. It counts moments and not time, so the pace of whoever asks changes nothing."""
        brain, ties, reader = self.brain(), self.new_ties(), self.reader()
        for moment in self.recording.moments():
            sensed = reader.read(moment)
            yield Step(moment, sensed.tell(brain, ties), brain, sensed.odometry)


@kind("moment reader/1")
class MomentReader:
    """What the motion of a recording is read with: all that decides what a brain is given of the moments to come."""

    def __init__(self, motion: Motion, order: NDArray[np.int64]) -> None:
        """order: in which the brain is told the ranges."""
        self._motion, self._order = motion, order

    def read(self, moment: Moment) -> SensorInput:
        """The next moment, as a brain is given it."""
        return self.input_of(moment, self._motion.of(moment), gap=self._motion.gap)

    def input_of(self, moment: Moment, moved: Odometry, *, gap: bool = False) -> SensorInput:
        ranges_m = None if moment.ranges_m is None else moment.ranges_m[self._order]
        return SensorInput(moment.image, moved, ranges_m, moment.behaviour, gap=gap, scan_m=moment.ranges_m)
