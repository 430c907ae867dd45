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
from ratslam_core.local_view.front_ends.image_and_sonars import along_rows
from ratslam_core.local_view.front_ends.template import grey_template
from ratslam_core.local_view.matcher import Features
from ratslam_core.params import LocalViewParams
from ratslam_core.params.local_view import COLUMNS, ROWS

GAIN = 90.0  # bytes for a brightness that is e times as large
MOST = 40.0  # levels: a pixel that is half as bright again as its column, and more
MIDDLE = 128.0  # the byte of a pixel as bright as this grey where its column is, too


@kind("limited levels/1")
class LimitedLevels(FrontEnd):
    """Logarithms of grey levels, less most of their column's mean, limited."""

    columns, rows = COLUMNS, ROWS
    shifts, scale, vague = True, 1.0, 0.0

    def __init__(self, params: LocalViewParams) -> None:
        self._even = params.even_light
        self._levels = (GAIN * np.log(np.arange(256) + params.dark)).astype(np.float32)

    def look(self, image: NDArray[np.uint8] | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        levels = self._levels[grey_template(image)]
        column, middle = levels.mean(axis=0), self._levels[int(MIDDLE)]
        off = levels - self._even * column - (1 - self._even) * middle
        return np.rint(MIDDLE + np.clip(off, -MOST, MOST)).astype(np.uint8).T.ravel()

    def bland(self, features: Features, params: LocalViewParams) -> bool:
        """A wall at arm's length looks the same to either side."""
        return along_rows(features) < params.min_pattern

    def threshold(self, params: LocalViewParams) -> float:
        return params.composite_threshold

    def surprise(self, params: LocalViewParams) -> float:
        return params.composite_surprise

    def picture(self, features: Features) -> NDArray[np.uint8]:
        return features.reshape(COLUMNS, ROWS).T

    def words(self, features: Features) -> str:
        return f"12 x 8 limited levels in even light, {features.mean():.0f} on average"
