"""Eight sonars: the nearest echo within each cone."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim2d.geometry import ray_length

# From left to right, as on the front of a Pioneer.
SONAR_ANGLES_RAD: tuple[float, ...] = tuple(math.radians(a) for a in (90, 50, 30, 10, -10, -30, -50, -90))
CONE_RAD = math.radians(15)
RAYS = 5  # in one cone


@njit(cache=True, nogil=True)
def sonar_ranges(
    segments: NDArray[np.float64],
    x: float,
    y: float,
    heading: float,
    angles: NDArray[np.float64],
    farthest: float,
    errors: NDArray[np.float64],
) -> NDArray[np.float32]:
    """(n,): metres from the robot's middle to the nearest of five rays in each cone; `farthest` when nothing echoes.

    errors: (n,) added to each echo, metres.
    """
    out = np.empty(angles.size, np.float32)
    for i in range(angles.size):
        shortest = farthest
        for k in range(RAYS):
            angle = heading + angles[i] + CONE_RAD * (k / (RAYS - 1) - 0.5)
            shortest = ray_length(segments, x, y, angle, shortest)
        if shortest < farthest:
            shortest = min(max(shortest + errors[i], 0.0), farthest)
        out[i] = shortest
    return out
