"""[ours] A laser's scan as a view: one row of ranges from left to right, which a turn shifts as it shifts a picture.

The papers' robots see with cameras; many recordings have a laser only. test_recorded_front_ends.py::test_a_turn_shifts_the_view.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd
from ratslam_core.local_view.matcher import Features
from ratslam_core.types import Bytes

LASER_COLUMNS = 60
LEAST_M, MOST_M = 0.3, 20.0  # nearer and farther ranges count as these; a range twice as long is 42 bytes more
BLAND = 0.25  # share of the columns in which something must be within reach


@kind("laser/1")
class Laser(FrontEnd):
    """Logarithms of ranges, since what is far away changes less with a step."""

    columns, rows = LASER_COLUMNS, 1
    shifts, scale, threshold, surprise, vague = True, 1.0, 7.0, 9.5, 0.0

    def look(
        self, _image: object = None, _scene: int | None = None, ranges_m: NDArray[np.floating] | None = None
    ) -> Features:
        """ranges_m: (n_beams,), from the rightmost beam to the leftmost, as lasers count."""
        if ranges_m is None:
            raise ValueError("ranges_m must be given for the front end laser, got None")
        share = np.log(np.clip(ranges_m, LEAST_M, MOST_M) / LEAST_M) / math.log(MOST_M / LEAST_M)
        bounds = np.arange(LASER_COLUMNS) * len(share) // LASER_COLUMNS
        width = np.diff(np.append(bounds, len(share)))
        columns = np.add.reduceat(share, bounds) / np.maximum(width, 1)
        return np.rint(255 * columns[::-1]).astype(np.uint8)

    def bland(self, features: Features) -> bool:
        """A hall without walls within reach."""
        return float((features < 255).mean()) < BLAND

    def picture(self, features: Features) -> Bytes:
        """The nearer, the brighter, from left to right."""
        return np.tile(255 - features, (8, 1))

    def words(self, features: Features) -> str:
        return f"ranges in {LASER_COLUMNS} directions, {(features < 255).mean():.0%} of them within {MOST_M:.0f} m"
