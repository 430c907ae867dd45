"""A view as 12 x 8 grey levels. ACRA 2006 section 7."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd, grey
from ratslam_core.local_view.matcher import COLUMNS, ROWS, Features


@kind("template/2")
class Template(FrontEnd):
    """Every change counts, the light included, so several views may stand for one place."""

    columns, rows = COLUMNS, ROWS
    shifts, scale, threshold, surprise, vague = True, 1.0, 6.0, 20.0, 0.0

    def look(self, image: NDArray[np.uint8] | None, _scene: int | None = None, _ranges_m: object = None) -> Features:
        return np.ascontiguousarray(grey_template(image).T).ravel()

    def picture(self, features: Features) -> NDArray[np.uint8]:
        return features.reshape(COLUMNS, ROWS).T

    def words(self, features: Features) -> str:
        return f"12 x 8 grey levels, {features.mean():.0f} on average"


def grey_template(image: NDArray[np.uint8] | None) -> NDArray[np.uint8]:
    """An image as 12 x 8 grey levels, shape (8, 12), each the mean of its area."""
    return np.asarray(cv2.resize(grey(image), (COLUMNS, ROWS), interpolation=cv2.INTER_AREA), np.uint8)
