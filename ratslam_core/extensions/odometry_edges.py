"""[ours] Between each experience and the one made before it stands odometry alone: the backbone of map correction.

Observations and odometry never share a row. An observation can be wrong by decimetres, or false; odometry is right to a
few per cent unless the robot is carried or its wheels slip, which is found out later (`inflate_covariance`).
test_experience_map_transitions.py::test_no_observation_is_averaged_into_the_backbone. `NoOdometryEdges` is the plain twin: in
the papers only transitions tie experiences.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numba import njit

from disk import kind
from ratslam_core.pose_graph.transitions import PreintegratedOdometry, Transitions
from ratslam_core.types import Flags, Floats, Ints, Odometry, Pose2


@kind("odometry edges/2")
class OdometryEdges:
    """Remembers the newest experience: where it was made is known exactly.

    If the robot came straight from there, the way is the backbone, and no later passage, which begins and ends with
    observations, is averaged into it. If it passed known ones in between, an edge of its own, which no route takes, ties
    the two; the way from the known one rests on an observation and can be doubted.
    test_experience_map_transitions.py::test_odometry_past_known_places_keeps_the_chain_rigid.
    """

    def __init__(self) -> None:
        self.latest = -1
        self.observed = False  # since then
        self.since = PreintegratedOdometry()

    def move(self, moved: Pose2, odometry: Odometry) -> None:
        self.since.add(moved, odometry)

    def observe(self) -> None:
        """A known experience was recognised: what is learnt next begins with an observation."""
        self.observed = True

    def forget(self) -> None:
        """The robot was carried away: odometry no longer ties it to the newest experience."""
        self.latest = -1

    def made(self, active: int, driven: int, transitions: Transitions, weight_of: Callable[[float], float]) -> None:
        """`active` was just made; `driven` is the row of the way to it. weight_of: the weight after a distance (m)."""
        if self.latest >= 0 and self.observed:
            row = transitions.add(self.latest, active, travelled=False)
            transitions.measure(row, self.since.moved, weight_of(self.since.way_m), transitions.move[row], 0.0)
            transitions.take_time(row, 0.0, self.since.turning_s)
            transitions.chain[driven] = False
        self.latest, self.observed, self.since = active, False, PreintegratedOdometry()


@kind("no odometry edges/1")
class NoOdometryEdges:
    """As in the papers: a transition is learnt, and nothing else remembered."""

    def move(self, _moved: Pose2, _odometry: Odometry) -> None: ...
    def observe(self) -> None: ...
    def forget(self) -> None: ...
    def made(self, _active: int, _driven: int, _t: Transitions, _weight_of: Callable[[float], float]) -> None: ...


def inflate_covariance(t: Transitions, first: int, last: int, off_m: float, sigma: float) -> Ints:
    """Inflate the covariance of the odometry constraints that may be broken after experience `first`, up to `last`; returns
    their rows.

    [ours] Observations proved that the robot is not where odometry led: unnoticed, it was carried, or its wheels slipped.
    The loop closures that follow put both sides of these rows where they belong. With `experience_map.submaps` off
    nothing is proved wrong. test_broken_odometry.py::test_an_unnoticed_kidnap_is_found_in_the_backbone.

    off_m: by how much they were wrong together; sigma: of odometry over one step, m.
    """
    rows = broken(t, first, last)
    if len(rows):
        t.weight[rows] = 1 / (1 / t.weight[rows] + (off_m / sigma) ** 2 / len(rows))
        t.believed[rows] = np.minimum(t.believed[rows], t.weight[rows])
    return rows


def open_way_m(t: Transitions, first: int, last: int) -> float:
    """How long the backbone is, between these experiences, where no loop closure bridges it: there its drift is unbounded."""
    rows = _unbridged(t, first, last)
    return float(np.hypot(t.move[rows, 0], t.move[rows, 1]).sum())


def broken(t: Transitions, first: int, last: int) -> Ints:
    """The broken odometry constraints: the last stretch, between these experiences, that no loop closure bridges. What went wrong
    did not happen between places that one ties together past the gap."""
    rows = _unbridged(t, first, last)
    newer = t.ends[rows].max(axis=1)
    apart = np.flatnonzero(np.diff(newer) > 1)  # rows are in the order in which they were made
    return rows[apart[-1] + 1 :] if len(apart) else rows


def _unbridged(t: Transitions, first: int, last: int) -> Ints:
    return _rows_unbridged(t.ends[: t.count], t.chain[: t.count], t.believed[: t.count], first, last)


@njit(cache=True, nogil=True)
def _rows_unbridged(ends: Ints, chain: Flags, believed: Floats, first: int, last: int) -> Ints:
    """Rows of odometry to an experience after the first, up to the last, past which no observation leads."""
    bridges = np.zeros(np.max(ends) + 2 if len(ends) else 1, np.int64)
    for row in range(len(ends)):
        if not chain[row] and believed[row] > 0:
            bridges[min(ends[row, 0], ends[row, 1]) + 1] += 1
            bridges[max(ends[row, 0], ends[row, 1]) + 1] -= 1
    bridges = np.cumsum(bridges)
    rows = np.empty(len(ends), np.int64)
    found = 0
    for row in range(len(ends)):
        newer = max(ends[row, 0], ends[row, 1])
        if chain[row] and first < newer <= last and bridges[newer] == 0:
            rows[found] = row
            found += 1
    return rows[:found]
