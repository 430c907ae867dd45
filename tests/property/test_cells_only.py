"""A law of 2004's robot without a map: it is where its packet has gone since it woke up."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, Odometry, Pose2, Recognition, wrap_angle
from ratslam_core.experience_map.cells_only import CellsOnly
from ratslam_core.types import Packet

SHAPE, CELL_M = (36, 40, 50), 0.25  # layers, cells along y' and x'
STILL, NOTHING = Odometry(0.0, 0.0, 0.1), Recognition(-1, False, -1, math.inf)
headings = st.floats(-3.14, 3.14)
places = st.tuples(st.floats(0, 49.9), st.floats(0, 39.9), headings)
ways = st.tuples(st.floats(-19, 19), st.floats(-19, 19), headings)


@given(places, ways)
def test_the_robot_is_where_its_packet_has_gone(woke: tuple[float, ...], way: tuple[float, ...]) -> None:
    """Also across the border of the network, and seen from the way it faced when it woke up."""
    map_ = CellsOnly(SHAPE, CELL_M, ExperienceMapParams(enabled=False))
    x, y, heading = woke
    assert map_.step(Packet(x, y, heading, 1.0), NOTHING, STILL)
    now = Packet((x + way[0]) % 50, (y + way[1]) % 40, wrap_angle(heading + way[2]), 1.0)
    assert not map_.step(now, NOTHING, STILL)
    expected = Pose2(0.0, 0.0, heading).inverse().compose(Pose2(way[0] * CELL_M, way[1] * CELL_M, heading + way[2]))
    robot = map_.robot
    assert (robot.x, robot.y) == pytest.approx((expected.x, expected.y), abs=1e-6)
    assert math.remainder(robot.heading_rad - expected.heading_rad, math.tau) == pytest.approx(0.0, abs=1e-6)
    assert len(map_) == 1
    assert np.isfinite(map_.poses).all()
