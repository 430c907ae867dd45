"""[ours] Whether the robot was carried away while it did not look, and when it knows again where it is.

Image and sonars jump though the wheels did not. Without it the carried way becomes a link and bends the map.
test_slam.py::{test_a_kidnap_is_noticed_and_survived, test_sonars_help_to_notice_a_kidnap}. `NeverKidnapped` is the plain twin:
the papers' robots were found again by their pose cells alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.extensions.scan_change import ScanChange
from ratslam_core.params import KidnapParams, LocalViewParams


@kind("kidnap detector/1")
class KidnapDetector:
    """`kidnapped` from the jump until known places agree."""

    def __init__(self, params: KidnapParams, view_params: LocalViewParams) -> None:
        self.params, self.view_params = params, view_params
        self.kidnapped = False
        self._scans = ScanChange()
        self._known_before = 0  # experiences when it happened
        self._agreed = self._settled = 0

    def observe(self, image_change: float, ranges_m: NDArray[np.float64] | None) -> bool:
        """Whether image and sonars say that the robot was carried away since the step before.

        image_change: as a share of what driving cannot do, `LocalView.image_change`; ranges_m: (n_sonars,). Sonars alone do not
        tell: a robot that turns between two walls has all of them jump.
        """
        heard = self.view_params.range_surprise * self._scans.observe(ranges_m, self.params)
        return image_change > self.params.least_image and image_change + heard > 1

    def declare(self, experiences: int) -> None:
        """It was carried, when there were so many experiences."""
        self.kidnapped, self._known_before = True, experiences
        self._agreed = self._settled = 0

    def settle(self, agrees: bool, known: int) -> None:
        """One more step; it ends once `found_again` sights of experiences from before, over what odometry says lies between them,
        agree on where the robot is. What is new in between says nothing: maybe only a wall was drawn. Nor is anybody lost
        who for two minutes saw nothing that contradicts: it is somewhere else, and knows its way there.

        agrees: what is seen, with where the robot believed to be; known: the experience that was recognised, -1 for none.
        test_slam.py::{test_a_changed_place_does_not_keep_the_robot_lost, test_nobody_is_lost_for_ever}.
        """
        if not self.kidnapped:
            return
        if not agrees:
            self._agreed = self._settled = 0
        self._agreed += 0 <= known < self._known_before
        self._settled += 1
        self.kidnapped = self._agreed < self.params.found_again and self._settled < self.params.settled


@kind("never kidnapped/1")
class NeverKidnapped:
    """As the papers: nobody asks."""

    kidnapped = False

    def __init__(self, params: KidnapParams, view_params: LocalViewParams) -> None:
        self.params, self.view_params = params, view_params

    def observe(self, _image_change: float, _ranges_m: NDArray[np.float64] | None) -> bool:
        return False

    def declare(self, _experiences: int) -> None:
        """It is told so, and takes no notice."""

    def settle(self, _agrees: bool, _known: int) -> None:
        """It was not lost."""
