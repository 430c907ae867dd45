"""A packet of activity put into the pose cells by hand. A demonstration: no sensor asks for it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ratslam_core import PoseCells
from ratslam_core.pose_cells.attractor_kernels import gaussian
from ratslam_core.types import wrap_angle

SIGMA, REACH = 1.2, 3  # in cells along x' and y', in layers along theta'


def put_packet(pose_cells: PoseCells, x: int, y: int, heading_rad: float, share: float) -> str:
    """Inject a packet, which competes from the next tick on. Returns what was done, in words. ValueError outside the
    pose cells.

    share: the packet's share of all activity once it is in.
    """
    n_theta, n_y, n_x = pose_cells.shape
    if not (0 <= x < n_x and 0 <= y < n_y):
        raise ValueError(f"a pose cell has x from 0 to {n_x - 1} and y from 0 to {n_y - 1}, got {x} and {y}")
    layer = round(wrap_angle(heading_rad) / math.tau * n_theta) % n_theta
    flat, value = _blob(pose_cells.shape, layer, y, x)
    value *= share / (1 - share) / value.sum()
    pose_cells.inject(flat, value.astype(np.float32))
    pose_cells.settle()
    return f"a packet of {share:.0%} put at cell ({x}, {y}) by hand"


def _blob(shape: tuple[int, int, int], layer: int, y: int, x: int) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """The cells (flat indices) within REACH of one cell, wrapped on the torus, and their Gaussian weights."""
    n_theta, n_y, n_x = shape
    around, weights = np.arange(-REACH, REACH + 1), gaussian(SIGMA, REACH).astype(np.float64)
    thetas, ys, xs = np.meshgrid((layer + around) % n_theta, (y + around) % n_y, (x + around) % n_x, indexing="ij")
    flat = ((thetas * n_y + ys) * n_x + xs).ravel().astype(np.int32)
    return flat, np.einsum("t,y,x->tyx", weights, weights, weights).ravel()
