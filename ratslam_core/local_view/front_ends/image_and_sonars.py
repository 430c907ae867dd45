"""[ours] A view as 12 x 8 levels that hardly depend on the light, and the echoes of the sonars.

ACRA 2006 section 7 compares grey levels: `Template` is the plain twin. Lamps and daylight change these, and walls look
alike; the sonars see in the dark and undo much of this perceptual aliasing. benchmarks/recognition.py measures what each part is
worth. test_image_and_sonars.py::{test_light_is_mostly_taken_off, test_sonars_tell_aliased_places_apart},
test_front_ends.py::test_a_bare_wall_shows_nothing_to_the_front_end_that_is_ours.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd, grey_template
from ratslam_core.local_view.matcher import COLUMNS, ROWS, SIZE, Features
from ratslam_core.types import Bytes, Floats, Singles

ECHOES = 8
GAIN = 90.0  # bytes for a brightness that is e times as large
MIDDLE = 128.0  # the byte of a column whose mean is this grey
DARK = 40.0  # grey levels added before the logarithm is taken, so that noise in the dark is not amplified
EVEN = 0.8  # share of the mean of an image's column that is taken for light
ECHO_WEIGHT = 0.12  # of the echoes' mean difference against that of the picture
LEAST_M, MOST_M = 0.2, 4.0  # nearer echoes count as the first, farther ones as none
FULL_PATTERN = 12.0  # levels that an image must change along its rows to be trusted altogether
LEAST_PATTERN = 2.0  # levels; an image that changes less shows nothing
PLAIN_DOUBT = 6.0  # levels added for an image that does not change along its rows at all,
SILENT_DOUBT = 1.0  # when nothing is within reach of the sonars,
DEAF_DOUBT = 3.0  # and for a robot without sonars, which the picture alone must tell apart

LEVELS = (GAIN * np.log(np.arange(256) + DARK)).astype(np.float32)  # of each grey level


@kind("image and sonars/2")
class ImageAndSonars(FrontEnd):
    """Logarithms of grey levels, less most of their column's mean; behind them logarithms of ranges.

    In logarithms, light is something added. A lamp changes a whole column of the image by about the same amount, so the
    mean of a column tells more of the lamp than of the wall, and the pattern within the column is what stays.
    """

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = True, 1.0, 7.0, 9.5, 0.0
    echoes, echo_weight = ECHOES, ECHO_WEIGHT

    def look(
        self, image: Bytes | None, _scene: int | None = None, ranges_m: NDArray[np.floating] | None = None
    ) -> Features:
        features = np.zeros(SIZE + ECHOES, np.uint8)
        _picture_bytes(grey_template(image), LEVELS, EVEN, features)
        if ranges_m is not None:
            _echo_bytes(np.asarray(ranges_m, np.float64), LEAST_M, MOST_M, features)
        return features

    def bland(self, features: Features) -> bool:
        """A wall at arm's length, or an empty hall, looks the same to either side."""
        return along_rows(features) < LEAST_PATTERN

    def doubt(self, features: Features) -> float:
        """[ours] The less the rows differ from left to right, and the fewer echoes there are, the less a match means.

        Floors and ceilings alone look alike everywhere. test_image_and_sonars.py::test_what_tells_little_is_doubted.
        """
        return _doubt(features)

    def picture(self, features: Features) -> Bytes:
        """The levels; below them a strip with the echoes from left to right, the nearer the brighter."""
        near = np.where(features[SIZE:] == 0, 0, 255 - features[SIZE:].astype(np.int64))
        strip = near[np.arange(COLUMNS) * ECHOES // COLUMNS].astype(np.uint8)
        return np.vstack([features[:SIZE].reshape(COLUMNS, ROWS).T, strip])

    def words(self, features: Features) -> str:
        heard = np.count_nonzero((features[SIZE:] > 0) & (features[SIZE:] < 255))
        return f"12 x 8 levels in even light, {features[:SIZE].mean():.0f} on average, and {heard} echoes"


@njit(cache=True, nogil=True)
def _picture_bytes(grey: Bytes, levels: Singles, even: float, out: Features) -> None:
    """Column after column; `even` is the share of a column's mean that is taken off."""
    rows, columns = grey.shape
    middle = levels[int(MIDDLE)]
    for c in range(columns):
        mean = 0.0
        for r in range(rows):
            mean += levels[grey[r, c]]
        mean /= rows
        base = MIDDLE - even * mean - (1.0 - even) * middle
        for r in range(rows):
            out[c * rows + r] = np.uint8(min(max(round(base + levels[grey[r, c]]), 0.0), 255.0))


@njit(cache=True, nogil=True)
def _echo_bytes(ranges_m: Floats, least_m: float, most_m: float, out: Features) -> None:
    """1 for the nearest and 255 for none within reach. Of more than 8 sonars, the nearest of each group counts."""
    n = len(ranges_m)
    groups = min(n, ECHOES)
    for g in range(groups):
        nearest = most_m
        for k in range(g * n // groups, (g + 1) * n // groups):
            nearest = min(nearest, ranges_m[k])
        share = math.log(max(nearest, least_m) / least_m) / math.log(most_m / least_m)
        out[SIZE + g] = np.uint8(round(1 + 254 * share))


@njit(cache=True, nogil=True)
def along_rows(features: Features) -> float:
    """How much the picture changes along its rows: root mean square difference from the mean of each row, in bytes."""
    total = 0.0
    for r in range(ROWS):
        mean, square = 0.0, 0.0
        for c in range(COLUMNS):
            value = float(features[c * ROWS + r])
            mean += value
            square += value * value
        total += square - mean * mean / COLUMNS
    return (max(total, 0.0) / SIZE) ** 0.5


@njit(cache=True, nogil=True)
def _doubt(features: Features) -> float:
    silent = deaf = 0
    for code in features[SIZE:]:
        silent += code == 255
        deaf += code == 0
    plain = max(0.0, 1.0 - along_rows(features) / FULL_PATTERN)
    return PLAIN_DOUBT * plain + SILENT_DOUBT * (silent / ECHOES) + DEAF_DOUBT * (deaf / ECHOES)


MOST = 40.0  # levels: a pixel that is half as bright again as its column, and more


@kind("limited levels/2")
class LimitedLevels(FrontEnd):
    """[ours] A view as 12 x 8 levels in even light, each limited, for the pictures of real cameras, and no echoes.

    Lamps, windows and black chairs are some hundred times as bright as one another: a pixel of theirs that moves to the
    next would weigh more than the whole of the rest. So no pixel differs from the mean of its column by more than so many
    levels. test_recorded_front_ends.py::test_a_lamp_counts_no_more_than_a_wall.
    """

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = True, 1.0, 7.0, 9.5, 0.0

    def look(self, image: Bytes | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        levels = LEVELS[grey_template(image)]
        column, middle = levels.mean(axis=0), LEVELS[int(MIDDLE)]
        off = levels - EVEN * column - (1 - EVEN) * middle
        return np.rint(MIDDLE + np.clip(off, -MOST, MOST)).astype(np.uint8).T.ravel()

    def bland(self, features: Features) -> bool:
        """A wall at arm's length looks the same to either side."""
        return along_rows(features) < LEAST_PATTERN

    def picture(self, features: Features) -> Bytes:
        return features.reshape(COLUMNS, ROWS).T

    def words(self, features: Features) -> str:
        return f"12 x 8 limited levels in even light, {features.mean():.0f} on average"
