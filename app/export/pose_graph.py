"""The experience map as a pose graph in the format g2o: VERTEX_SE2 for experiences, EDGE_SE2 for what holds them together."""

from __future__ import annotations

import numpy as np

from app.session import Session


def g2o_text(session: Session) -> bytes:
    """Numbers are exact: read back, they are the map's own.

    An edge is a row of the transitions that map correction uses; its information is `believed` in all three directions, as
    correction weighs it (1 for the odometry of one step). A way that no longer counts in correction is left out.
    """
    map_ = session.brain.experience_map
    rows = map_.transitions
    lines = [f"VERTEX_SE2 {i} {x!r} {y!r} {heading!r}\n" for i, (x, y, heading) in enumerate(map_.poses.tolist())]
    for row in np.flatnonzero(rows.believed[: rows.count] > 0).tolist():
        (i, j), (dx, dy, turn), weight = rows.ends[row].tolist(), rows.move[row].tolist(), float(rows.believed[row])
        lines.append(f"EDGE_SE2 {i} {j} {dx!r} {dy!r} {turn!r} {weight!r} 0 0 {weight!r} 0 {weight!r}\n")
    return "".join(lines).encode()
