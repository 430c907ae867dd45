"""Links: how they are read, how they turn, and what they remember."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, Odometry, Packet, Pose2, Recognition

from .drives import EXACT, Robot

HOME = Pose2(0.0, 0.0, 0.0)


def drive_there_and_back(robot: Robot, behaviour: int = 0) -> None:
    """0 -> 1 -> 0, a metre apart."""
    robot.behaviour = behaviour
    robot.go(1.0, 0.0, 1, packet=robot.packet(Pose2(1.0, 0.0, 0.0)))
    robot.pose = HOME
    robot.see(0, odometry=Odometry(-10.0, 0.0, 0.1))


def two_places(params: ExperienceMapParams = EXACT) -> Robot:
    robot = Robot(params)
    robot.see(0, new=True)
    drive_there_and_back(robot)
    assert robot.map.links.tolist() == [[0, 1], [1, 0]]
    return robot


# ---------------------------------------------------------------- reading


@settings(max_examples=50)
@given(st.floats(0.3, 2.0), st.floats(-1.5, 1.5), st.integers(0, 15))
def test_a_link_is_read_as_the_paper_writes_it(forwards: float, turn: float, behaviour: int) -> None:
    """B 4.2: distance, bearing to j relative to the facing of i, facing of j relative to that of i."""
    robot = Robot(EXACT, start=Pose2(1.0, 2.0, 2.5))
    robot.see(0, new=True)
    start, robot.behaviour = robot.pose, behaviour
    robot.go(forwards, turn, 1, new=True)
    link = robot.map.link(0, 1)
    dx, dy = robot.pose.x - start.x, robot.pose.y - start.y
    assert (link.from_experience, link.to_experience, link.passages) == (0, 1, 1)
    assert link.distance_m == pytest.approx(math.hypot(dx, dy), abs=1e-6)
    bearing = math.remainder(math.atan2(dy, dx) - start.heading_rad, 2 * math.pi)
    assert link.bearing_rad == pytest.approx(bearing, abs=1e-6)
    assert link.facing_rad == pytest.approx(turn, abs=1e-6)
    assert link.time_s == pytest.approx(1.0)
    assert (link.behaviour, link.trials, link.confidence, link.weight) == (behaviour, 1, 1.0, 1.0)
    assert robot.map.behaviours.tolist() == [behaviour]
    assert robot.map.confidences.tolist() == [1.0]
    with pytest.raises(FrozenInstanceError):
        link.time_s = 0.0  # type: ignore[misc]


def test_a_link_remembers_the_behaviour_under_which_it_was_learnt() -> None:
    robot = two_places()
    drive_there_and_back(robot, behaviour=3)
    assert robot.map.behaviours.tolist() == [0, 0]
    robot.go(1.0, 0.5, 2, new=True)
    assert robot.map.link(0, 2).behaviour == 3
    assert robot.map.link(0, 1).passages == 2
    with pytest.raises(ValueError, match="there is no link from experience 1 to 7"):
        robot.map.link(1, 7)


def test_a_behaviour_or_a_packet_that_is_none_changes_nothing() -> None:
    robot = two_places()
    seen, ahead = Recognition(0, False, 0, 0.0), Odometry(1.0, 0.0, 0.1)
    for behaviour in (-1, 16, 1.0, True, None):
        with pytest.raises(ValueError, match=r"behaviour must be a whole number from 0 to 15, got"):
            robot.map.step(robot.packet(), seen, ahead, behaviour)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"packet\.x must be a finite number"):
        robot.map.step(Packet(math.nan, 0.0, 0.0, 1.0), seen, ahead)
    assert (len(robot.map), robot.map.active, robot.map.robot) == (2, 0, HOME)


def test_links_turn_with_their_experience() -> None:
    """D8: an experience that turns by dth turns (dx, dy) of its links by dth. Ours are kept in its frame, so they do."""
    robot = Robot(EXACT)
    robot.see(0, new=True)
    robot.go(1.0, 0.7, 1, new=True)
    map_, turn = robot.map, 0.6
    before = map_.moves[0].copy()
    expected = map_.pose(0).compose(Pose2(*map(float, before)))
    map_.poses[0, 2] += turn
    c, s = math.cos(turn), math.sin(turn)  # turns dp of the paper, in the map's axes; experience 0 is at its origin
    turned = map_.pose(0).compose(Pose2(*map(float, map_.moves[0])))
    assert (turned.x, turned.y) == pytest.approx((c * expected.x - s * expected.y, s * expected.x + c * expected.y))
    assert np.array_equal(map_.moves[0], before)
