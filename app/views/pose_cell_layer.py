"""The strongest pose cells and the competing packets."""

from __future__ import annotations

import numpy as np

from app.session import Session
from app.views.arrays import frozen
from app.views.history import History
from web.messages import Packet, PoseCellLayer

STRONGEST = 500


def pose_cell_layer(session: Session, history: History) -> PoseCellLayer:
    pose_cells = session.brain.pose_cells
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
        path=history.trails.packet,
        last_snap=history.events.last_snap,
        total=float(activity.sum(dtype=np.float64)),
        least=float(activity.min()),
    )
