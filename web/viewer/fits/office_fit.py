"""Converts between the office frame (metres) and the office plate: any world, scaled to fit 10 x 8 m."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

WIDTH, DEPTH = 10.0, 8.0
METRE_HIGH = 0.62 / 2.5  # plate units per metre of height, for everything but walls


class OfficeFit:
    def __init__(self, bounds: tuple[float, float, float, float]) -> None:
        low_x, low_y, high_x, high_y = bounds
        self.size_m = (max(high_x - low_x, 1e-3), max(high_y - low_y, 1e-3))
        self.low = np.array([low_x, low_y])
        self.scale = min(WIDTH / self.size_m[0], DEPTH / self.size_m[1])
        low = min(0.3, 140 * self.scale**2)  # in worlds beyond 200 m, higher walls would hide the rooms between them
        self.relief = min(1.0, max(1.5 * self.scale, low))  # scales heights and thicknesses: low where rooms are small
        self.grid_step_m = 1.0 if self.scale > 0.35 else 5.0  # between the lines of the floor
        self._centre = self.low + np.array(self.size_m) / 2

    def to_plate(self, xy: NDArray[np.floating]) -> NDArray[np.float64]:
        """From (n, 2) metres in the office to (n, 2) on the plate."""
        return (np.asarray(xy, np.float64) - self._centre) * self.scale

    def to_office(self, xy: NDArray[np.floating]) -> NDArray[np.float64]:
        """The inverse of `to_plate`."""
        return np.asarray(xy, np.float64) / self.scale + self._centre
