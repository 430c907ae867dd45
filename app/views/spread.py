"""[ours] How far off the robot may be, as an ellipse around its estimate: by the pose filter, which weighs looks against
odometry; by the rules of the papers, which have none, from the spread of the winning packet. test_judged_views.py checks both.
"""

from __future__ import annotations

import math

import numpy as np

from app.session import Session
from ratslam_core import CellsOnly
from web.messages import Spread

REACH = 6  # cells from the packet's centre: what is farther away belongs to another packet


def spread_of(session: Session) -> Spread | None:
    """None without a map: nothing would be there to draw it on."""
    map_ = session.brain.experience_map
    if isinstance(map_, CellsOnly):
        return None
    sigma = map_.off_m
    if math.isfinite(sigma):
        return Spread(sigma, sigma, 0.0, "filter")
    return packet_spread(session)


def packet_spread(session: Session) -> Spread:
    """The ellipse of the winner's activity in x', y', turned from the cells' frame into the map's by the robot's two headings."""
    brain = session.brain
    cells, values = brain.pose_cells.active
    packet, (_, n_y, n_x) = brain.pose_cells.winner, brain.pose_cells.shape
    dx = _around(cells[:, 0] - packet.x, n_x)
    dy = _around(cells[:, 1] - packet.y, n_y)
    near = np.hypot(dx, dy) <= REACH
    weights, points = values[near].astype(np.float64), np.stack([dx[near], dy[near]])
    if weights.sum() <= 0:
        return Spread(0.0, 0.0, 0.0, "packet")
    middle = (points * weights).sum(1) / weights.sum()
    off = points - middle[:, None]
    variances, axes = np.linalg.eigh((off * weights) @ off.T / weights.sum())
    across, along = (brain.params.pose_cells.cell_m * math.sqrt(max(v, 0.0)) for v in variances.tolist())
    turn = brain.experience_map.robot.heading_rad - packet.heading_rad
    return Spread(along, across, math.remainder(math.atan2(axes[1, 1], axes[0, 1]) + turn, math.pi), "packet")


def _around(apart: np.ndarray, size: int) -> np.ndarray:
    return apart - size * np.round(apart / size)
