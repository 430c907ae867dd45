"""[ours] Where odometry was wrong, when looks have proved that the robot is not where it led.

The robot was carried and did not notice, or its wheels slipped. It cannot have happened between places that a closure
ties together past the gap; so it was in the last stretch of the backbone that no closure bridges. There, the rows of
odometry are taken as uncertain by as much as they proved wrong together, and the closures that follow put both sides
where they belong. test_torn.py::test_an_unnoticed_kidnap_is_found_in_the_backbone. With `experience_map.islands` off
nothing is proved wrong.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ratslam_core.pose_graph.transitions import Transitions


def soften(t: Transitions, first: int, last: int, off_m: float, sigma: float) -> NDArray[np.intp]:
    """Take the backbone as uncertain where it may be torn after experience `first`, up to `last`; returns these rows.

    off_m: by how much it was wrong; sigma: of odometry over one step, m.
    """
    rows = torn(t, first, last)
    if len(rows):
        t.weight[rows] = 1 / (1 / t.weight[rows] + (off_m / sigma) ** 2 / len(rows))
        t.believed[rows] = np.minimum(t.believed[rows], t.weight[rows])
    return rows


def open_way_m(t: Transitions, first: int, last: int) -> float:
    """How long the backbone is, between these experiences, where no closure bridges it: there its drift is unbounded."""
    rows = _unbridged(t, first, last)
    return float(np.hypot(t.move[rows, 0], t.move[rows, 1]).sum())


def torn(t: Transitions, first: int, last: int) -> NDArray[np.intp]:
    """The rows of the last stretch of the backbone, between these experiences, that no closure bridges."""
    rows = _unbridged(t, first, last)
    newer = t.ends[rows].max(axis=1)
    apart = np.flatnonzero(np.diff(newer) > 1)  # rows are in the order in which they were made
    return rows[apart[-1] + 1 :] if len(apart) else rows


def _unbridged(t: Transitions, first: int, last: int) -> NDArray[np.intp]:
    ends, chain = t.ends[: t.count], t.chain[: t.count]
    looks = ~chain & (t.believed[: t.count] > 0)
    bridges = np.zeros(int(ends.max(initial=0)) + 2, np.int64)
    np.add.at(bridges, ends[looks].min(axis=1) + 1, 1)
    np.add.at(bridges, ends[looks].max(axis=1) + 1, -1)
    bridged = np.cumsum(bridges) > 0
    newer = ends.max(axis=1)
    return np.flatnonzero(chain & (newer > first) & (newer <= last) & ~bridged[newer])
