"""Pose cells with one packet or two, their snaps, and what lies below them."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from web.messages import GoalMemoryLayer, OccupancyLayer, OccupancyPicture, Packet, Pose, PoseCellLayer, Snap

from .office import frozen, truth_at

SHAPE = (36, 64, 64)
CELL_M = 0.25
SNAP_EVERY = 400  # ticks


def _cell(truth: Pose, shift: tuple[float, float, float]) -> Packet:
    """Where the packet of this pose is, in cells, `shift` (x, y, heading) away."""
    x = (truth.x / CELL_M + 40 + shift[0]) % SHAPE[2]
    y = (truth.y / CELL_M + 8 + shift[1]) % SHAPE[1]
    return Packet(x, y, math.remainder(truth.heading_rad + shift[2], math.tau), 1.0)


def pose_cell_layer(tick: int, truth: Pose, lost: bool) -> PoseCellLayer:
    share = 1 - 0.42 * (1 - (tick % SNAP_EVERY) / 80) if lost else 1.0
    first, second = _cell(truth, (0, 0, 0)), _cell(truth, (22, 14, 1.4))
    number = 2 * (tick // SNAP_EVERY) + 1
    packets = [Packet(first.x, first.y, first.heading_rad, share, number)]
    if lost:
        packets.append(Packet(second.x, second.y, second.heading_rad, 1 - share, number + 1))
    cells, values = zip(*[_blob(p) for p in packets], strict=True)
    cell, value = np.vstack(cells), np.concatenate(values)
    order = np.argsort(-value, kind="stable")
    keep = order[:500]
    path = [_cell(truth_at(t), (0, 0, 0)) for t in range(max(0, tick - 1200), tick + 1, 12)]
    return PoseCellLayer(
        shape=SHAPE,
        cell_m=CELL_M,
        cells=frozen(cell[keep].astype(np.int32)),
        activity=frozen(value[keep].astype(np.float32)),
        active_cells=len(order),
        packets=tuple(packets),
        path=frozen(np.array([(p.x, p.y, p.heading_rad) for p in path], np.float32)),
        last_snap=_snap(tick // SNAP_EVERY),
    )


def _blob(packet: Packet) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    turn = (packet.heading_rad % math.tau) / math.tau * SHAPE[0]
    t, y, x = (round(v) + np.arange(-4, 5) for v in (turn, packet.y, packet.x))
    grid = np.stack(np.meshgrid(t, y, x, indexing="ij"), -1).reshape(-1, 3)
    gap = ((grid - (turn, packet.y, packet.x)) ** 2).sum(1)
    value = np.exp(-gap / (2 * 1.6**2))
    keep = value > 0.005
    return grid[keep] % SHAPE, value[keep] / value.sum() * packet.mass


@lru_cache(maxsize=4)
def _snap(count: int) -> Snap | None:
    if count == 0:
        return None
    truth = truth_at(count * SNAP_EVERY + 80)
    return Snap(count * SNAP_EVERY * 0.1 + 8, _cell(truth, (22, 14, 1.4)), _cell(truth, (0, 0, 0)))


@lru_cache(maxsize=2)
def occupancy_layer(_version: int) -> OccupancyLayer:
    cells = np.full(SHAPE[1:], 0.5, np.float32)
    cells[8:40, 40:] = 0.2
    cells[8, 40:], cells[39, 40:] = 0.95, 0.95
    picture = np.full((16, 20), 0.2, np.float32)
    picture[[0, -1]], picture[:, [0, -1]] = 0.95, 0.95
    drawn = OccupancyPicture(frozen(picture), (-2.5, -2.0), CELL_M)
    return OccupancyLayer(frozen(cells), lambda: drawn)


@lru_cache(maxsize=2)
def goal_memory_layer(_version: int, goal: bool) -> GoalMemoryLayer:
    if not goal:
        return GoalMemoryLayer(9000, None, None, None)
    y, x = np.mgrid[: SHAPE[1], : SHAPE[2]]
    seconds = np.hypot(x - 50, y - 20) * 0.8
    seconds[seconds > 15] = np.inf
    return GoalMemoryLayer(9000, (50, 20), frozen(seconds.astype(np.float32)), 0.7)
