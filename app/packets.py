"""A packet of activity put among the pose cells by hand, to watch it compete. A demonstration: no sense says it."""

from __future__ import annotations

import math

import numpy as np

from app.session import Session
from ratslam_core.pose_cells import gaussian
from web.messages import InjectPacket

SIGMA, REACH = 1.2, 3  # cells and layers


def inject_packet(session: Session, wish: InjectPacket) -> str:
    """Do it and say so. It acts with the next tick. ValueError outside the pose cells."""
    pose_cells = session.brain.pose_cells
    n_theta, n_y, n_x = pose_cells.shape
    if not (wish.x < n_x and wish.y < n_y):
        raise ValueError(f"a pose cell has x from 0 to {n_x - 1} and y from 0 to {n_y - 1}, got {wish.x} and {wish.y}")
    layer = round(wish.heading_rad / math.tau * n_theta) % n_theta
    around, weights = np.arange(-REACH, REACH + 1), gaussian(SIGMA, REACH).astype(np.float64)
    theta, y, x = np.meshgrid(
        (layer + around) % n_theta, (wish.y + around) % n_y, (wish.x + around) % n_x, indexing="ij"
    )
    flat = ((theta * n_y + y) * n_x + x).ravel().astype(np.int32)
    value = np.einsum("t,y,x->tyx", weights, weights, weights).ravel()
    value *= wish.share / (1 - wish.share) / value.sum()
    pose_cells.inject(flat, value.astype(np.float32))
    return f"a packet of {wish.share:.0%} put at ({wish.x}, {wish.y}) by hand"
