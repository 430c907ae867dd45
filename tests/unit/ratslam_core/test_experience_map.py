"""Experiences of the map: where they are active, when one is made, and which is taken."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import ExperienceMap, Pose2
from ratslam_core.types import wrap_angle

from .drives import CELL_M, EXACT, SHAPE, Robot


def test_the_first_experience_is_the_origin_of_the_map() -> None:
    robot = Robot(start=Pose2(3.0, -2.0, 1.0))
    assert robot.see(0, new=True)
    assert (len(robot.map), robot.map.active, robot.map.link_count) == (1, 0, 0)
    assert robot.map.robot == Pose2(0.0, 0.0, 0.0)
    x, y, theta, view = robot.map.cell_state(0)
    assert (x, y, theta, view) == pytest.approx((32 + 12, 32 - 8, 36 / (2 * math.pi), 0))


def test_a_new_experience_outside_the_zone_or_of_another_view() -> None:
    robot = Robot(EXACT)
    robot.see(0, new=True)
    assert not robot.see(0)
    assert robot.see(1, new=True)  # the same place, another view
    assert robot.go(0.75, 0.0, 0)  # three cells on, the same view
    assert not robot.see(0)
    assert robot.map.active == 2
    assert len(robot.map) == 3


def test_a_robot_put_back_where_it_was_goes_on() -> None:
    robot = Robot(replace(EXACT, odometry_drift=0.03))
    robot.see(0, new=True)
    robot.map.declare_kidnapped()
    assert not robot.see(0)
    assert (len(robot.map), robot.map.link_count) == (1, 0)


def test_maps_of_thousands_of_experiences_keep_everything() -> None:
    robot = Robot(replace(EXACT, odometry_drift=0.03))
    robot.see(0, new=True)
    n = 2500
    for view in range(1, n):
        robot.go(0.1, 0.01, view, steps=1, new=True)
    map_ = robot.map
    assert (len(map_), map_.link_count, len(map_.links)) == (n, n - 1, n - 1)
    assert map_.links.tolist() == [[i, i + 1] for i in range(n - 1)]
    assert map_.moves == pytest.approx(np.tile([0.1 * math.cos(0.005), 0.1 * math.sin(0.005), 0.01], (n - 1, 1)))
    last = map_.pose(n - 1)
    assert (last.x, last.y) == pytest.approx((robot.pose.x, robot.pose.y), abs=1e-6)
    before = map_.poses.copy()
    map_.params = replace(map_.params, sweeps=1)
    map_.correct()
    assert np.abs(map_.poses - before).max() < 1e-9


def test_seeing_nothing_closes_no_loop() -> None:
    """After sixteen metres the torus uses the same pose cells again. Only a scene may then close a loop."""
    for view, closes in ((-1, False), (5, True)):
        robot = Robot(EXACT)
        robot.see(7, new=True)
        assert robot.see(view, new=True)
        assert not robot.see(view)  # near in the map
        robot.see(7)
        robot.go(16.0, 0.0, 3, new=True)
        assert robot.see(view) is not closes
        assert (robot.map.active == 1) is closes


# ---------------------------------------------------------------- how a map is read


def test_what_each_experience_stands_for_can_be_read_as_arrays() -> None:
    robot = Robot(start=Pose2(1.0, 0.0, 0.3))
    robot.see(4, new=True)
    robot.go(1.0, 0.2, 9, new=True)
    map_ = robot.map
    assert map_.views.tolist() == [4, 9]
    for i in range(2):
        assert map_.cell_state(i) == (*map_.cell_states[i], map_.views[i])
        assert map_.pose(i) == Pose2(*map_.poses[i])
    for experience in (-1, 2, 100):
        for ask in (map_.pose, map_.cell_state, lambda i: map_.energy(i, robot.packet(), 0)):
            with pytest.raises(ValueError, match=f"experience must be from 0 to 1, got {experience}"):
                ask(experience)
    empty = ExperienceMap(SHAPE, CELL_M)
    assert (len(empty), empty.link_count, empty.active) == (0, 0, -1)
    with pytest.raises(ValueError, match="there is no experience yet"):
        empty.robot  # noqa: B018


def test_the_residual_is_how_far_links_and_map_disagree() -> None:
    robot = Robot(start=Pose2(1.0, 0.0, 0.3))
    robot.see(4, new=True)
    assert robot.map.residual == (0.0, 0.0)
    for view, turn in ((9, 0.2), (11, -0.4), (12, 1.0)):
        robot.go(1.0, turn, view, new=True)
    map_ = robot.map
    assert map_.residual == pytest.approx((0.0, 0.0), abs=1e-9)
    map_.poses[2] += (0.3, -0.4, 0.1)
    t = map_.transitions
    squares = angles = weights = 0.0
    for row in range(t.count):
        if not t.travelled[row]:
            continue
        i, j = t.ends[row].tolist()
        said = map_.pose(i).compose(Pose2(*t.move[row].tolist()))
        has, weight = map_.pose(j), float(t.believed[row])
        squares += weight * ((said.x - has.x) ** 2 + (said.y - has.y) ** 2)
        angles += weight * wrap_angle(said.heading_rad - has.heading_rad) ** 2
        weights += weight
    assert map_.residual == pytest.approx((math.sqrt(squares / weights), math.sqrt(angles / weights)))
    assert map_.residual[0] > 0.1
