"""Local view cells: each stands for one scene, a 12 x 8 grey template found again by its sum of absolute differences.

ACRA 2006 section 7 (view matcher), ACRA 2004 section 3.3 (one cell per scene), IROS 2005 (recruitment).
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from ratslam_core.params import LocalViewParams
from ratslam_core.types import Recognition

COLUMNS, ROWS = 12, 8
NOTHING = -1
TURNS = (0, 1, -1, 2, -2, 3, -3)  # columns by which one tick of turning may shift the image


class LocalView:
    """The known scenes. `observe` recognises an image or recruits a new cell for it."""

    def __init__(self, params: LocalViewParams | None = None) -> None:
        self.params = params or LocalViewParams()
        self._templates = np.zeros((1024, COLUMNS * ROWS), np.uint8)  # column by column, so that a shift is a slice
        self._count = 0
        self.template = np.zeros((ROWS, COLUMNS), np.uint8)
        self.recognition = Recognition(NOTHING, False, NOTHING, math.inf)
        self.surprised = False  # the image is so unlike the one before that the robot cannot have driven here
        self._last: NDArray[np.uint8] | None = None

    def __len__(self) -> int:
        return self._count

    @property
    def templates(self) -> NDArray[np.uint8]:
        """All known scenes, shape (n, 96), column by column. A view."""
        return self._templates[: self._count]

    def stored(self, view: int) -> NDArray[np.uint8]:
        """The template of one view, shape (8, 12)."""
        if not 0 <= view < self._count:
            raise ValueError(f"view must be from 0 to {self._count - 1}, got {view!r}")
        return self._templates[view].reshape(COLUMNS, ROWS).T

    def observe(self, image: NDArray[np.uint8]) -> Recognition:
        """The active cell for this image, shape (h, w) grey or (h, w, 3) RGB, uint8; a new one if it is like none known.

        [ours] An image without contrast (a wall at arm's length) shows nothing: no cell is active and none is recruited,
        since such views look alike everywhere. test_local_view.py::test_a_bland_view_shows_nothing. With vision off nothing does.
        """
        template = grey_template(image)
        column_major = np.ascontiguousarray(template.T).reshape(1, -1)
        self.surprised = self._jumped(column_major)
        self.template, self._last = template, column_major
        best, difference, shift = self._nearest(column_major)
        if not self.params.enabled or float(cv2.meanStdDev(template)[1][0, 0]) < self.params.min_contrast:
            self.recognition = Recognition(NOTHING, False, best, difference)
        elif difference <= self.params.match_threshold:
            facing = self._sub_column(column_major, best, shift) * self.params.field_of_view / COLUMNS
            self.recognition = Recognition(best, False, best, difference, facing)
        else:
            self._recruit(column_major)
            self.recognition = Recognition(self._count - 1, True, best, difference)
        return self.recognition

    def _jumped(self, template: NDArray[np.uint8]) -> bool:
        """Whether no turn within one tick makes the last image look like this one."""
        if self._last is None or not self.params.enabled:
            return False
        return all(_difference(template[0], self._last[0], shift) > self.params.surprise for shift in TURNS)

    def _nearest(self, template: NDArray[np.uint8]) -> tuple[int, float, int]:
        """The most similar known view, the mean absolute difference over the columns that overlap, and the shift."""
        best, least, at = NOTHING, math.inf, 0
        if self._count == 0:
            return best, least, at
        known = self._templates[: self._count]
        for shift in range(-self.params.shift, self.params.shift + 1):
            here, there, width = _overlap(shift)
            distance, which = cv2.batchDistance(
                template[:, here : here + width], known[:, there : there + width], cv2.CV_32S, normType=cv2.NORM_L1, K=1
            )
            mean = float(distance[0, 0]) / width
            if mean < least:
                best, least, at = int(which[0, 0]), mean, shift
        return best, least, at

    def _sub_column(self, template: NDArray[np.uint8], view: int, shift: int) -> float:
        """The shift in fractions of a column: where the two flanks of the difference around its least value meet."""
        if self.params.shift == 0:
            return 0.0
        left, least, right = (_difference(template[0], self._templates[view], shift + k) for k in (-1, 0, 1))
        steepest = max(left, right) - least
        return shift + (left - right) / (2 * steepest) if steepest > 0 else float(shift)

    def _recruit(self, template: NDArray[np.uint8]) -> None:
        if self._count == len(self._templates):
            self._templates = np.concatenate([self._templates, np.zeros_like(self._templates)])
        self._templates[self._count] = template
        self._count += 1


def _overlap(shift: int) -> tuple[int, int, int]:
    """Where the columns that overlap begin in the new and in the stored template, and how many values they hold."""
    return max(shift, 0) * ROWS, max(-shift, 0) * ROWS, (COLUMNS - abs(shift)) * ROWS


def _difference(a: NDArray[np.uint8], b: NDArray[np.uint8], shift: int) -> float:
    here, there, width = _overlap(shift)
    return float(cv2.norm(a[here : here + width], b[there : there + width], cv2.NORM_L1)) / width


def grey_template(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """An image as 12 x 8 grey levels, shape (8, 12), each the mean of its area."""
    if not isinstance(image, np.ndarray) or image.dtype != np.uint8:
        raise ValueError(f"image must be an array of uint8, got {getattr(image, 'dtype', type(image).__name__)}")
    if image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] != 3):
        raise ValueError(f"image must have shape (h, w) or (h, w, 3), got {image.shape}")
    if image.shape[0] < ROWS or image.shape[1] < COLUMNS:
        raise ValueError(f"image must be at least {ROWS} x {COLUMNS} pixels, got {image.shape[:2]}")
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) if image.ndim == 3 else image
    return np.asarray(cv2.resize(grey, (COLUMNS, ROWS), interpolation=cv2.INTER_AREA), np.uint8)
