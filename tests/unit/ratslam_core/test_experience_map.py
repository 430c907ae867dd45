"""Experiences of the map: where they are active, when one is made, and which is taken."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import Packet, Pose2

from .drives import EXACT, Robot


def test_energy_is_two_at_the_middle_and_nothing_beyond_the_zone() -> None:
    robot = Robot()
    robot.see(0, new=True)
    assert robot.map.energy(0, robot.packet(), 0) == pytest.approx(2.0)
    at = robot.packet()
    assert robot.map.energy(0, replace(at, x=at.x + 2.01), 0) == 0.0
    assert robot.map.energy(0, replace(at, heading_rad=math.radians(20.1)), 0) == 0.0
    assert robot.map.energy(0, replace(at, x=at.x + 1.0, heading_rad=math.radians(10)), 0) == pytest.approx(1.0)
    assert robot.map.energy(0, at, 1) == 0.0


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


def test_the_most_energetic_of_several_experiences_is_taken() -> None:
    robot = Robot(EXACT)
    robot.see(0, new=True)
    robot.see(1, new=True)
    robot.go(0.6, 0.0, 0)
    assert len(robot.map) == 3
    first, third = (Packet(*robot.map.cell_state(i)[:2], 0.0, 1.0) for i in (0, 2))
    for share, expected in ((0.3, 0), (0.45, 0), (0.55, 2), (0.9, 2)):
        between = Packet(first.x + share * (third.x - first.x), first.y, 0.0, 1.0)
        robot.see(1, packet=first)  # elsewhere first
        robot.see(0, packet=between)
        assert robot.map.active == expected


def test_a_threshold_makes_more_experiences() -> None:
    for threshold, created in ((0.0, False), (1.5, True)):
        robot = Robot(replace(EXACT, threshold=threshold))
        robot.see(0, new=True)
        robot.go(0.25, 0.0, 1, new=True)
        assert robot.see(0) is created  # one cell beside the first: energy 1.5


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


@pytest.mark.parametrize(("view", "closes"), [(-1, False), (5, True)])
def test_seeing_nothing_closes_no_loop(view: int, closes: bool) -> None:
    """After sixteen metres the torus uses the same pose cells again. Only a scene may then close a loop."""
    robot = Robot(EXACT)
    robot.see(7, new=True)
    assert robot.see(view, new=True)
    assert not robot.see(view)  # near in the map
    robot.see(7)
    robot.go(16.0, 0.0, 3, new=True)
    assert robot.see(view) is not closes
    assert (robot.map.active == 1) is closes
