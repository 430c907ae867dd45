"""A histogram of the image's hues and saturations. ACRA 2005 section 7, Prasser et al. 2005."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd, checked
from ratslam_core.local_view.matcher import COLUMNS, ROWS, Features

HUES, SATURATIONS = COLUMNS, ROWS  # bins
FULL_SATURATION = 0.5  # from which on a pixel falls into the last bin
CERTAIN_SATURATION = 0.1  # from which on the hue of a pixel is trusted
FULL_BIN = 1 / 6  # share of the image that fills a bin
WIDTH, HEIGHT = 32, 24  # pixels; fewer than the camera's, which averages out its noise


@kind("hue and saturation/2")
class HueSaturation(FrontEnd):
    """A histogram of the whole image. Neither brightness nor where in the image a colour is makes a difference."""

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = False, 2.5, 5.0, 20.0, 0.0

    def look(self, image: NDArray[np.uint8] | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        rgb = checked(image)
        if rgb.ndim == 2:
            raise ValueError(f"image must be in colour, shape (h, w, 3), for hue and saturation, got {rgb.shape}")
        small = cv2.resize(rgb.astype(np.float32) / 255, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
        hsv = np.asarray(cv2.cvtColor(small, cv2.COLOR_RGB2HSV), np.float32)
        shares = histogram(hsv[..., 0].ravel(), hsv[..., 1].ravel(), FULL_SATURATION, CERTAIN_SATURATION)
        return np.minimum(np.rint(255 / FULL_BIN * shares), 255).astype(np.uint8).ravel()

    def picture(self, features: Features) -> NDArray[np.uint8]:
        """Hue to the right, saturation downwards; each bin in its colour, the brighter the larger its share."""
        value = np.minimum(features.reshape(HUES, SATURATIONS).T * 2.5, 255).astype(np.uint8)
        hue = np.tile((np.arange(HUES) * 180 // HUES).astype(np.uint8), (SATURATIONS, 1))
        saturation = np.tile((np.arange(SATURATIONS) * 255 // (SATURATIONS - 1)).astype(np.uint8)[:, None], (1, HUES))
        return np.asarray(cv2.cvtColor(np.dstack([hue, saturation, value]), cv2.COLOR_HSV2RGB), np.uint8)

    def words(self, features: Features) -> str:
        hue, saturation = divmod(int(features.argmax()), SATURATIONS)
        return f"mostly hue {hue * 360 // HUES}° at saturation {saturation} of {SATURATIONS - 1}"


def histogram(
    hue_deg: NDArray[np.float32], saturation: NDArray[np.float32], full: float, certain: float
) -> NDArray[np.float64]:
    """Shares of the bins, shape (12, 8), sum 1. Every pixel is divided between the two nearest hues and the two nearest
    saturations; a saturation of `full` or more falls into the last bin.

    [ours] A pixel of a saturation below `certain` is spread over all hues, the more evenly the greyer it is, so that
    noise does not make it jump from one hue to another. test_hue_saturation.py::test_grey_has_no_hue.
    """
    level = np.minimum(saturation / full, 1.0) * (SATURATIONS - 1)
    low = np.minimum(level.astype(np.int64), SATURATIONS - 2)
    turn = hue_deg * (HUES / 360.0)
    left = np.floor(turn).astype(np.int64)
    sure = np.minimum(saturation / certain, 1.0)
    shares = np.zeros((HUES, SATURATIONS))
    for row, by_level in ((low, low + 1 - level), (low + 1, level - low)):
        shares += np.bincount(row, by_level * (1 - sure), SATURATIONS) / HUES
        for column, by_hue in ((left, left + 1 - turn), (left + 1, turn - left)):
            bins = column % HUES * SATURATIONS + row
            shares += np.bincount(bins, by_level * by_hue * sure, HUES * SATURATIONS).reshape(HUES, SATURATIONS)
    return np.maximum(shares, 0) / len(hue_deg)
