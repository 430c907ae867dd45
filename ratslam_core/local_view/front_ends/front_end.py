"""What the local view requires of a front end, and what all front ends count as an image."""

from __future__ import annotations

from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from ratslam_core.local_view.matcher import Features
from ratslam_core.params import COLUMNS, ROWS
from ratslam_core.types import Bytes


class FrontEnd(Protocol):
    """Features are uint8, shape (columns * rows + echoes,). Their mean absolute difference says how unlike two views are.

    A class that inherits from this has no echoes, never doubts, and is shown something by every image, as in the papers.
    """

    columns: int
    rows: int  # bytes of each column
    shifts: bool  # features are columns of the image: turning the robot shifts them, and the shift tells its heading
    scale: float  # levels for a mean difference of one byte; in levels all front ends are about equally strict
    threshold: float  # the difference in levels up to which a view is recognised
    surprise: float  # between two successive images, above which driving cannot explain it; inf = cannot be told
    vague: float  # least difference in levels, since even an equal view leaves the place uncertain
    echoes: int = 0  # bytes behind the columns that do not shift, for what is heard; 0 = unknown
    echo_weight: float = 0.0  # of their mean difference against that of the columns

    def look(
        self, image: Bytes | None, scene: int | None = None, ranges_m: NDArray[np.floating] | None = None, /
    ) -> Features:
        """The features of what is sensed now; ValueError says what is wrong with it."""
        ...

    def bland(self, _features: Features, /) -> bool:
        """[ours] Whether they show nothing that could be told apart from elsewhere."""
        return False

    def doubt(self, _features: Features, /) -> float:
        """Levels that are added to every difference, since the features tell little."""
        return 0.0

    def picture(self, features: Features, /) -> Bytes:
        """The features as a picture for people: (h, w) grey or (h, w, 3) RGB."""
        ...

    def words(self, features: Features, /) -> str:
        """The features in words, for people who cannot see the picture."""
        ...


def grey(image: Bytes | None) -> Bytes:
    """Its luminance, shape (h, w)."""
    good = checked(image)
    return np.asarray(cv2.cvtColor(good, cv2.COLOR_RGB2GRAY), np.uint8) if good.ndim == 3 else good


def grey_template(image: Bytes | None) -> Bytes:
    """An image as 12 x 8 grey levels, shape (8, 12), each the mean of its area."""
    return np.asarray(cv2.resize(grey(image), (COLUMNS, ROWS), interpolation=cv2.INTER_AREA), np.uint8)


def checked(image: Bytes | None) -> Bytes:
    """The image, or a ValueError that says what it should be: uint8, (h, w) grey or (h, w, 3) RGB, 8 x 12 pixels at least."""
    if not isinstance(image, np.ndarray) or image.dtype != np.uint8:
        raise ValueError(f"image must be an array of uint8, got {getattr(image, 'dtype', type(image).__name__)}")
    if image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] != 3):
        raise ValueError(f"image must have shape (h, w) or (h, w, 3), got {image.shape}")
    if image.shape[0] < ROWS or image.shape[1] < COLUMNS:
        raise ValueError(f"image must be at least {ROWS} x {COLUMNS} pixels, got {image.shape[:2]}")
    return image
