"""To which packet each active pose cell belongs."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from web.messages import PoseCellLayer

FLAT = (0.5, 1.0, 1.0)  # theta', y', x': one layer counts as half a cell


def owners(layer: PoseCellLayer) -> NDArray[np.int64]:
    """(k,) rows of `layer.packets`: the packet nearest to each cell, around the torus; 0 when there are no packets."""
    if not layer.packets:
        return np.zeros(len(layer.cells), np.int64)
    turn = layer.shape[0] / math.tau
    centres = np.array([[p.heading_rad % math.tau * turn, p.y, p.x] for p in layer.packets])
    gaps = np.abs(layer.cells[:, None] - centres[None])
    size = np.array(layer.shape)
    gaps = np.minimum(gaps % size, -gaps % size)
    return ((gaps * FLAT) ** 2).sum(2).argmin(1)
