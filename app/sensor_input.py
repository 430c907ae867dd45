"""The input of one step of a brain, from whatever source."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ratslam_core import Estimate, ExperienceMap, Odometry, RatSlam
from ratslam_core.parts import GeometricVerification

Lap = Callable[[str], None]  # called with each part of a tick that is done


class Ties(GeometricVerification, Protocol):
    """What ties the experiences of one brain by the scans of a laser."""

    def see(self, ranges_m: NDArray[np.float64] | None) -> None: ...

    def made(self, map_: ExperienceMap) -> None: ...


@dataclass(frozen=True, slots=True, eq=False)
class SensorInput:
    """The fields are those of `RatSlam.step`. gap: the robot was away for a while."""

    image: NDArray[np.uint8] | None
    odometry: Odometry
    ranges_m: NDArray[np.floating] | None
    behaviour: int
    scene: int | None = None
    gap: bool = False
    scan_m: NDArray[np.float64] | None = None  # of a laser, in the order of its beams

    def step(self, brain: RatSlam, ties: Ties | None = None, watch: Lap | None = None) -> Estimate:
        """One step of a brain; ties: what ties its experiences by a laser's scans. The scene number is made from the true
        pose, so a brain gets it only if its front end is "scene numbers", as in the papers' own simulator."""
        if self.gap:
            brain.declare_kidnapped()
        if ties is not None:
            ties.see(self.scan_m)
        numbers = brain.params.local_view.front_end == "scene numbers"
        estimate = brain.step(
            self.image, self.odometry, scene=self.scene if numbers else None, behaviour=self.behaviour,
            ranges_m=self.ranges_m, watch=watch, verification=ties,
        )  # fmt: skip
        if ties is not None and estimate.created:
            ties.made(brain.experience_map)
        return estimate
