"""Odometry from pictures alone: the turn from the shift of their columns, the speed from what the shift does not explain.

Milford and Wyeth 2008, section III: two scanline intensity profiles are laid over each other. One unit of speed is what
changes the profile by its typical change; whoever needs metres has to scale it.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from disk import kind

Profile = NDArray[np.float64]  # (COLUMNS,) mean grey level of each column, mean 0

COLUMNS = 64
BAND = 0.75  # share of the picture, from the top: the floor before a robot flows too fast to be compared
MOST = 24  # columns that two profiles may be shifted
STANDS = 1.0  # grey levels; pictures that differ by less show the camera's noise and nothing else


def small_grey(image: NDArray[np.uint8]) -> NDArray[np.float64]:
    """A picture as 64 x 48 grey levels, in which the camera's noise has been averaged out."""
    grey = np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)) if image.ndim == 3 else image
    return np.asarray(cv2.resize(grey, (COLUMNS, 48), interpolation=cv2.INTER_AREA), np.float64)


def profile_of(small: NDArray[np.float64]) -> Profile:
    """The scanline intensity profile of a small grey picture."""
    means = small[: int(BAND * len(small))].mean(axis=0)
    return means - means.mean()


def shift_of(new: Profile, old: Profile, most: int = MOST) -> tuple[float, float]:
    """By how many columns the scene has moved to the right from `old` to `new`, to a fraction; and the mean difference left.

    A robot that turns left, which is positive, sees the scene move to the right.
    """
    apart = np.array([_apart(new, old, s) for s in range(-most, most + 1)])
    best = int(apart.argmin())
    part = 0.0
    if 0 < best < 2 * most:
        left, least, right = apart[best - 1 : best + 2]
        steepest = max(left, right) - least
        part = (left - right) / (2 * steepest) if steepest > 0 else 0.0
    return best - most + part, float(apart[best])


def _apart(new: Profile, old: Profile, shift: int) -> float:
    """Mean absolute difference of two profiles over the columns that both show."""
    here, there = new[max(shift, 0) : COLUMNS + min(shift, 0)], old[max(-shift, 0) : COLUMNS - max(shift, 0)]
    off = here - there
    return float(np.abs(off - off.mean()).mean())


@kind("visual odometry/1")
class VisualOdometry:
    """Turn and change of the picture, from one picture to the next."""

    def __init__(self, field_of_view: float) -> None:
        """field_of_view: width of the camera's view, rad."""
        self.field_of_view = field_of_view
        self._small: NDArray[np.float64] | None = None

    def see(self, image: NDArray[np.uint8]) -> tuple[float, float, bool]:
        """(turn in rad, left positive; change in grey levels; whether it stands) since the picture before.

        The first picture tells nothing: it stands.
        """
        small, before = small_grey(image), self._small
        self._small = small
        if before is None or float(np.abs(small - before).mean()) < STANDS:
            return 0.0, 0.0, True
        shift, left = shift_of(profile_of(small), profile_of(before))
        return shift * self.field_of_view / COLUMNS, left, False
