"""Converts between the map frame and the map plate: turned like the office (for the eye only) and scaled in steps."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

WIDTH, DEPTH = 10.0, 8.0  # the floor of the plate
ROOM = 0.35  # kept clear around the map
STEP = 2**0.25  # ratio of successive scales
LARGEST = 1.0 * STEP
GRID = 0.25  # the centre moves in steps of this size, in plate units


@dataclass(frozen=True)
class MapFit:
    """plate = scale * turn(map - centre)."""

    scale: float = LARGEST
    turn_rad: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)

    def to_plate(self, xy: NDArray[np.floating]) -> NDArray[np.float64]:
        """From (n, 2) metres in the map to (n, 2) on the plate."""
        return (np.asarray(xy, np.float64).reshape(-1, 2) - self.centre) @ _turned(self.turn_rad).T * self.scale

    def to_map(self, xy: NDArray[np.floating]) -> NDArray[np.float64]:
        """The inverse of `to_plate`."""
        return np.asarray(xy, np.float64).reshape(-1, 2) / self.scale @ _turned(self.turn_rad) + self.centre


def refit(fit: MapFit, xy: NDArray[np.floating], turn_rad: float) -> MapFit:
    """`fit` itself while it still suits the map (n, 2), else a fit at the largest scale that shows all of the map."""
    if len(xy) == 0:
        return MapFit(LARGEST, turn_rad)
    if fit.turn_rad == turn_rad and _suits(fit, xy):
        return fit
    turned = np.asarray(xy, np.float64) @ _turned(turn_rad).T
    low: NDArray[np.float64] = turned.min(0)
    high: NDArray[np.float64] = turned.max(0)
    size = np.maximum(high - low, 1e-6)
    largest = min((WIDTH - 2 * ROOM) / size[0], (DEPTH - 2 * ROOM) / size[1])
    scale = min(LARGEST, STEP ** math.floor(math.log(largest) / math.log(STEP)))
    middle = np.round((low + high) / 2 * scale / GRID) * GRID / scale @ _turned(turn_rad)
    return MapFit(scale, turn_rad, (float(middle[0]), float(middle[1])))


def _suits(fit: MapFit, xy: NDArray[np.floating]) -> bool:
    """Whether all of the map is on the floor, and would not be at a scale two steps larger."""
    placed = fit.to_plate(xy)
    low, high = placed.min(0), placed.max(0)
    if low[0] < -WIDTH / 2 + 0.2 or high[0] > WIDTH / 2 - 0.2 or low[1] < -DEPTH / 2 + 0.2 or high[1] > DEPTH / 2 - 0.2:
        return False
    small = fit.scale < LARGEST / STEP**1.5
    larger = STEP**2 * (high - low)
    return not (small and larger[0] < WIDTH - 2 * ROOM and larger[1] < DEPTH - 2 * ROOM)


def _turned(angle_rad: float) -> NDArray[np.float64]:
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s], [s, c]])
