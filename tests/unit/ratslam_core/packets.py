"""Pose cells that hold one packet or two, and how they are driven."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ratslam_core import PoseCellParams, PoseCells

from . import literal

DT = 0.1
DEEP = 0.25  # metres in a cell


def settled(x: int = 32, y: int = 32, theta: int = 0, params: PoseCellParams | None = None) -> PoseCells:
    """A packet in the shape that the attractor gives it."""
    pose_cells = PoseCells(params)
    pose_cells.place(x, y, theta)
    rest(pose_cells, 60)
    return pose_cells


def rest(pose_cells: PoseCells, steps: int) -> None:
    for _ in range(steps):
        pose_cells.step(speed=0.0, yaw_rate=0.0, dt=DT)


def drive(pose_cells: PoseCells, cells_a_step: float, layers_a_step: float, steps: int) -> NDArray[np.float64]:
    """Drive and add up the winner's movement: x, y in cells, heading in layers."""
    n_theta, n_y, n_x = pose_cells.shape
    turn = layers_a_step * 2 * math.pi / n_theta / DT
    size = np.array([n_x, n_y, n_theta])
    way = np.zeros(3)
    before = where(pose_cells)
    for _ in range(steps):
        pose_cells.step(speed=cells_a_step * DEEP / DT, yaw_rate=turn, dt=DT)
        after = where(pose_cells)
        way += (after - before + size / 2) % size - size / 2
        before = after
    return way


def where(pose_cells: PoseCells) -> NDArray[np.float64]:
    winner = pose_cells.winner
    return np.array([winner.x, winner.y, winner.heading_rad * pose_cells.shape[0] / (2 * math.pi)])


def two_packets(apart: int, share: float, turned: int = 0) -> PoseCells:
    """The first has this share of the activity; the second is `apart` cells along x' and `turned` layers on."""
    one = settled().activity.astype(np.float64)
    pose_cells = PoseCells()
    literal.fill(pose_cells, share * one + (1 - share) * np.roll(one, (turned, apart), (0, 2)))
    return pose_cells
