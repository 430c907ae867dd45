"""An odometry constraint may be broken where no loop closure bridges it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core import Pose2
from ratslam_core.extensions.odometry_edges import broken, inflate_covariance, open_way_m
from ratslam_core.pose_graph.transitions import Transitions


def a_backbone(experiences: int, closures: list[tuple[int, int]]) -> Transitions:
    t = Transitions()
    for _ in range(experiences):
        t.graph.add_node()
    for i in range(experiences - 1):
        row = t.add(i, i + 1, travelled=True)
        t.measure(row, Pose2(1.0, 0.0, 0.0), 1.0, t.move[row].copy(), 0.0)
    for i, j in closures:
        row = t.add(i, j, travelled=True)
        t.measure(row, Pose2(0.0, 0.0, 0.0), 0.5, t.move[row].copy(), 0.0)
    return t


def test_an_unnoticed_kidnap_is_found_in_the_backbone(subtests: pytest.Subtests) -> None:
    """The way is open where no closure bridges it."""
    for closures, first, last, found in (
        ([], 0, 9, [*range(9)]),
        ([], 3, 6, [3, 4, 5]),
        ([(5, 0)], 0, 9, [5, 6, 7, 8]),
        ([(5, 0), (9, 6)], 0, 9, [5]),  # between two loops
        ([(0, 5), (4, 9)], 0, 9, []),  # each is bridged
        ([(4, 2), (8, 6)], 0, 9, [8]),  # the last stretch alone
        ([(9, 0)], 0, 9, []),
    ):
        with subtests.test(closures=closures, first=first):
            assert broken(a_backbone(10, closures), first, last).tolist() == found
    for closures, first, last, way_m in (
        ([], 0, 9, 9.0), ([], 3, 6, 3.0), ([(5, 0)], 0, 9, 4.0), ([(4, 2), (8, 6)], 0, 9, 5.0), ([(9, 0)], 0, 9, 0.0)
    ):  # fmt: skip
        assert open_way_m(a_backbone(10, closures), first, last) == pytest.approx(way_m)
    t = a_backbone(10, [(9, 0)])
    t.believed[9] = 0.0  # a closure that is not believed bridges nothing
    assert broken(t, 0, 9).tolist() == [*range(9)]


def test_the_broken_rows_are_together_as_uncertain_as_they_were_wrong() -> None:
    t, sigma, off_m = a_backbone(10, [(5, 0)]), 0.01, 3.0
    rows = inflate_covariance(t, 0, 9, off_m, sigma)
    added = sum(sigma**2 / t.weight[row] - sigma**2 for row in rows)
    assert math.sqrt(added) == pytest.approx(off_m)
    assert (t.believed[rows] == t.weight[rows]).all()
    others = np.setdiff1d(np.arange(t.count), rows)
    assert (t.weight[others] == a_backbone(10, [(5, 0)]).weight[others]).all()
