"""[ours] A view as 12 x 8 levels in even light, each limited, for the pictures of real cameras.

As `image_and_sonars`, without echoes. Lamps, windows and black chairs are some hundred times as bright as one another: a pixel
of theirs that moves to the next would weigh more than the whole of the rest. So no pixel differs from the mean of its column
by more than so many levels. test_recorded_front_ends.py::test_a_lamp_counts_no_more_than_a_wall.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd
from ratslam_core.local_view.front_ends.image_and_sonars import EVEN, LEAST_PATTERN, LEVELS, MIDDLE, along_rows
from ratslam_core.local_view.front_ends.template import grey_template
from ratslam_core.local_view.matcher import Features
from ratslam_core.params import COLUMNS, ROWS

MOST = 40.0  # levels: a pixel that is half as bright again as its column, and more


@kind("limited levels/2")
class LimitedLevels(FrontEnd):
    """Logarithms of grey levels, less most of their column's mean, limited."""

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = True, 1.0, 7.0, 9.5, 0.0

    def look(self, image: NDArray[np.uint8] | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        levels = LEVELS[grey_template(image)]
        column, middle = levels.mean(axis=0), LEVELS[int(MIDDLE)]
        off = levels - EVEN * column - (1 - EVEN) * middle
        return np.rint(MIDDLE + np.clip(off, -MOST, MOST)).astype(np.uint8).T.ravel()

    def bland(self, features: Features) -> bool:
        """A wall at arm's length looks the same to either side."""
        return along_rows(features) < LEAST_PATTERN

    def picture(self, features: Features) -> NDArray[np.uint8]:
        return features.reshape(COLUMNS, ROWS).T

    def words(self, features: Features) -> str:
        return f"12 x 8 limited levels in even light, {features.mean():.0f} on average"
