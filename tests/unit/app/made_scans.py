"""Scans of rooms that are given by a formula."""

from __future__ import annotations

import numpy as np

ANGLES = np.radians(np.arange(-89.5, 90.0))


def room(x: float, y: float, heading: float) -> np.ndarray:
    """Ranges in a room of 8 m x 5 m."""
    c, s = np.cos(ANGLES + heading), np.sin(ANGLES + heading)
    with np.errstate(divide="ignore"):
        ahead = np.where(c > 0, (4.5 - x) / c, (-3.5 - x) / c)
        aside = np.where(s > 0, (3.0 - y) / s, (-2.0 - y) / s)
    return np.minimum(np.minimum(np.abs(ahead), np.abs(aside)), 20.0)


def between_walls(heading: float) -> np.ndarray:
    """Ranges between two walls 2 m apart that have no end."""
    with np.errstate(divide="ignore"):
        return np.minimum(np.abs(1.0 / np.sin(ANGLES + heading)), 20.0)
