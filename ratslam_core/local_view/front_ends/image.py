"""What counts as an image, checked once for all front ends."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from ratslam_core.params.local_view import COLUMNS, ROWS


def checked(image: NDArray[np.uint8] | None) -> NDArray[np.uint8]:
    """The image, or a ValueError that says what it should be: uint8, (h, w) grey or (h, w, 3) RGB, 8 x 12 pixels at least."""
    if not isinstance(image, np.ndarray) or image.dtype != np.uint8:
        raise ValueError(f"image must be an array of uint8, got {getattr(image, 'dtype', type(image).__name__)}")
    if image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] != 3):
        raise ValueError(f"image must have shape (h, w) or (h, w, 3), got {image.shape}")
    if image.shape[0] < ROWS or image.shape[1] < COLUMNS:
        raise ValueError(f"image must be at least {ROWS} x {COLUMNS} pixels, got {image.shape[:2]}")
    return image


def grey(image: NDArray[np.uint8] | None) -> NDArray[np.uint8]:
    """Its luminance, shape (h, w)."""
    good = checked(image)
    return np.asarray(cv2.cvtColor(good, cv2.COLOR_RGB2GRAY), np.uint8) if good.ndim == 3 else good
