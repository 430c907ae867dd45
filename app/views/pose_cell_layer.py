"""The strongest pose cells and the competing packets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from app.views.arrays import frozen
from app.views.history import History
from ratslam_core.pose_cells.network import PoseCells
from web.messages import Packet, PoseCellLayer, Snap

STRONGEST = 500


def pose_cell_layer(session: Session, history: History) -> PoseCellLayer:
    return layer_of(session.brain.pose_cells, history.trails.packet, history.events.last_snap)


def layer_of(pose_cells: PoseCells, path: NDArray[np.float32], last_snap: Snap | None) -> PoseCellLayer:
    """path: of the winner, (p, 3): x', y' in cells, heading in rad."""
    cells, activity = pose_cells.active
    strongest = np.argsort(-activity, kind="stable")[:STRONGEST]
    packets = tuple(Packet(p.x, p.y, p.heading_rad, p.mass, p.id) for p in pose_cells.packets)
    return PoseCellLayer(
        shape=pose_cells.shape,
        cell_m=pose_cells.params.cell_m,
        cells=frozen(np.ascontiguousarray(cells[strongest][:, [2, 1, 0]], np.int32)),
        activity=frozen(activity[strongest]),
        active_cells=len(activity),
        packets=packets,
        path=path,
        last_snap=last_snap,
        total=float(activity.sum(dtype=np.float64)),
        least=float(activity.min()),
    )
