from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core import Pose2
from ratslam_core.extensions.pose_filter import LEAST_SIGMA, SNAP, SNAP_RAD, SNAP_SIGMA, PoseFilter
from ratslam_core.types import wrap_angle

CELL_M = 0.25


def believing(local: Pose2, sigma_m: float) -> PoseFilter:
    belief = PoseFilter(CELL_M)
    belief.local, belief.sigma_m = local, sigma_m
    return belief


near = st.builds(Pose2, st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(-0.7, 0.7))
sigmas = st.floats(0.001, 0.9)


@given(near, sigmas, sigmas)
def test_an_observation_and_odometry_are_weighed_by_their_variances(
    observation: Pose2, own: float, sigma: float
) -> None:
    belief = believing(Pose2(0.0, 0.0, 0.0), own)
    belief.see(observation, sigma)
    own = max(own, LEAST_SIGMA * CELL_M)
    share = (1 / sigma**2) / (1 / sigma**2 + 1 / own**2)
    seen = belief.local.x, belief.local.y, belief.local.heading_rad
    assert seen == pytest.approx(
        (share * observation.x, share * observation.y, share * observation.heading_rad), abs=1e-9
    )
    assert 1 / belief.sigma_m**2 == pytest.approx(1 / sigma**2 + 1 / own**2, rel=1e-6)


def test_an_uncertain_observation_moves_the_estimate_little() -> None:
    moved = []
    for sigma in (0.02, 0.1, 0.3, 1.0):
        belief = believing(Pose2(0.0, 0.0, 0.0), 0.1)
        belief.see(Pose2(0.5, 0.0, 0.4), sigma)
        moved.append(belief.local.x)
        assert belief.sigma_m < 0.1
    assert moved == sorted(moved, reverse=True)
    assert moved[0] > 0.45
    assert moved[-1] < 0.01


def test_an_observation_that_may_be_off_by_metres_is_weighed_however_far_off() -> None:
    """Else a robot would jump through a hall in which views are alike for metres."""
    for off_m, snaps in ((SNAP_SIGMA - 0.1, False), (SNAP_SIGMA + 0.1, True)):
        belief = believing(Pose2(0.0, 0.0, 0.0), 0.3)
        assert belief.see(Pose2(off_m, 0.0, 0.0), 1.0) is not snaps
        assert (belief.local.x == off_m) is snaps


def test_an_observation_that_disagrees_altogether_is_believed_at_once() -> None:
    """Farther or more turned than the limits; as far and as turned is weighed. So is one that is perfect."""
    for observation, snaps in (
        (Pose2(SNAP * CELL_M + 0.01, 0.0, 0.0), True),
        (Pose2(0.0, -1.5, 0.0), True),
        (Pose2(0.0, 0.0, -SNAP_RAD - 0.01), True),
        (Pose2(SNAP * CELL_M, 0.0, 0.0), False),
        (Pose2(0.0, 0.0, SNAP_RAD), False),
    ):
        belief = believing(Pose2(0.0, 0.0, 0.0), 0.05)
        assert belief.see(observation, 0.2) is not snaps
        assert (belief.local == observation) is (belief.sigma_m == 0.2) is snaps
    belief = believing(Pose2(0.1, 0.2, 0.3), 0.2)
    belief.see(Pose2(0.0, 0.0, 0.0), 0.0)
    assert (belief.local, belief.sigma_m) == (Pose2(0.0, 0.0, 0.0), 0.0)


def test_doubt_grows_with_the_way() -> None:
    belief = believing(Pose2(0.0, 0.0, math.pi / 2), 0.1)
    belief.move(Pose2(1.0, 0.0, 0.2), 0.03)
    assert (belief.local.x, belief.local.y) == pytest.approx((0.0, 1.0))
    assert belief.local.heading_rad == pytest.approx(math.pi / 2 + 0.2)
    assert belief.sigma_m == pytest.approx(0.13)


def test_headings_are_weighed_the_shorter_way_round() -> None:
    belief = believing(Pose2(0.0, 0.0, math.pi - 0.1), 0.1)
    belief.see(Pose2(0.0, 0.0, -math.pi + 0.1), 0.1)
    assert abs(belief.local.heading_rad) == pytest.approx(math.pi)


def test_who_was_carried_may_be_anywhere_until_it_sees_something_or_begins_a_map() -> None:
    belief = PoseFilter(CELL_M)
    belief.forget(100.0)
    belief.move(Pose2(0.5, 0.0, 0.0), 0.1)
    belief.make(sure=False)
    assert belief.sigma_m == pytest.approx(100.1)
    assert belief.local == Pose2(0.0, 0.0, 0.0)
    belief.see(Pose2(0.1, 0.0, 0.0), 0.2)
    assert belief.sigma_m < 0.21
    belief.forget(100.0)
    belief.make(sure=True)
    assert belief.sigma_m == 0.0


@given(near, near)
def test_an_observation_without_a_sigma_is_where_the_robot_is(before: Pose2, observation: Pose2) -> None:
    """As in the papers: where it was seen last, and where the wheels brought it since."""
    belief = PoseFilter(CELL_M)
    belief.move(before, 0.0)
    belief.see(observation, 0.0)
    at = belief.local
    assert (at.x, at.y) == pytest.approx((observation.x, observation.y), abs=1e-9)
    assert wrap_angle(at.heading_rad - observation.heading_rad) == pytest.approx(0.0, abs=1e-9)
    belief.move(Pose2(0.2, 0.0, 0.1), 0.0)
    assert belief.local == at.compose(Pose2(0.2, 0.0, 0.1))
    assert belief.sigma_m == 0.0
