"""Scene numbers given by a simulator, as in the papers' own simulations. ACRA 2005 section 5, ACRA 2006 section 5.1."""

# Callers may not be type-checked.
# pyright: reportUnnecessaryIsInstance=false

from __future__ import annotations

import math
import numbers

import cv2
import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.front_ends.front_end import FrontEnd
from ratslam_core.local_view.matcher import COLUMNS, ROWS, SIZE, Features

LARGEST = 2**63 - 1
NUMBER = slice(0, 8)  # where the number is kept in the features


@kind("scene numbers/1")
class SceneNumbers(FrontEnd):
    """Each number is one local view cell, recruited at first sight. The image is ignored."""

    columns, rows = COLUMNS, ROWS
    shifts, scale, vague = False, 1000.0, 5.0  # other numbers are 10 levels away or more; a scene is no point
    threshold, surprise = vague, math.inf  # a number is either known or not, and does not tell how far apart scenes are

    def look(self, _image: NDArray[np.uint8] | None, scene: int | None = None, _ranges_m: object = None) -> Features:
        if not isinstance(scene, numbers.Integral) or isinstance(scene, bool) or not 0 <= scene <= LARGEST:
            raise ValueError(f"scene must be a whole number from 0 to {LARGEST} for scene numbers, got {scene!r}")
        features = np.zeros(SIZE, np.uint8)
        features[NUMBER] = np.frombuffer(int(scene).to_bytes(8, "little"), np.uint8)
        return features

    def picture(self, features: Features) -> NDArray[np.uint8]:
        """The number in digits."""
        text = self.words(features).removeprefix("scene ")
        (width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_DUPLEX, 1.0, 1)
        paper = np.full((max(height + below, 2 * width // 3) + 8, width + 8), 40, np.uint8)
        at = (4, (len(paper) + height) // 2)
        return np.asarray(cv2.putText(paper, text, at, cv2.FONT_HERSHEY_DUPLEX, 1.0, 235, 1, cv2.LINE_AA), np.uint8)

    def words(self, features: Features) -> str:
        return f"scene {int.from_bytes(features[NUMBER].tobytes(), 'little')}"
