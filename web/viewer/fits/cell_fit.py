"""Converts between pose cells [theta, y, x] and the glass box on their plate: a torus unrolled into 7 x 7 x 4.6."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from web.messages import Packet

SIDE, HEIGHT = 7.0, 4.6
Array = NDArray[np.float64]


class CellFit:
    """`shape` is (n_theta, n_y, n_x); x' and y' start at the box's left front corner, theta' at its floor."""

    def __init__(self, shape: tuple[int, int, int]) -> None:
        self.shape = shape
        self.voxel = (SIDE / shape[2], SIDE / shape[1], HEIGHT / shape[0])

    def cells(self, cells: NDArray[np.integer]) -> Array:
        """From (k, 3) theta, y, x of cells to the (k, 3) centres of their voxels."""
        share = (cells[:, ::-1].astype(np.float64) + 0.5) / np.array(self.shape[::-1], np.float64)
        return share * np.array([SIDE, SIDE, HEIGHT]) - np.array([SIDE / 2, SIDE / 2, 0.0])

    def path(self, path: NDArray[np.floating]) -> Array:
        """From (p, 3) x, y in cells and heading to (p, 3) in the box."""
        x = (path[:, 0] + 0.5) / self.shape[2] % 1.0 * SIDE - SIDE / 2
        y = (path[:, 1] + 0.5) / self.shape[1] % 1.0 * SIDE - SIDE / 2
        z = path[:, 2] % math.tau / math.tau * HEIGHT
        return np.column_stack([x, y, z]).astype(np.float64)

    def packet(self, packet: Packet) -> Array:
        return self.path(np.array([[packet.x, packet.y, packet.heading_rad]]))[0]


def broken_where_it_wraps(points: Array) -> NDArray[np.float32]:
    """From (p, 3) points to segments, without those that jump around the torus."""
    segments = np.stack([points[:-1], points[1:]], 1)
    jumps = np.abs(segments[:, 1] - segments[:, 0]) > np.array([SIDE, SIDE, HEIGHT]) / 2
    return segments[~jumps.any(1)].astype(np.float32)
