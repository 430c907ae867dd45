"""What the experience map learns of the ways between experiences: links, averages, the best observation, none after a kidnap."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, Odometry, Pose2

from .drives import EXACT, Robot

SQUARE = [(1.0, 0.0), (1.0, math.pi / 2)] * 4


def test_links_of_a_square_are_what_odometry_says() -> None:
    robot = Robot(EXACT)
    robot.see(0, new=True)
    corners = [robot.pose]
    for view, (forwards, turn) in enumerate(SQUARE[:-1], start=1):
        assert robot.go(forwards, turn, view, new=True)
        corners.append(robot.pose)
    assert not robot.go(*SQUARE[-1], 0)
    assert robot.map.active == 0
    assert robot.map.closures == 1
    map_ = robot.map
    assert map_.links.tolist() == [[i, (i + 1) % 8] for i in range(8)]
    assert map_.link_times == pytest.approx([1.0] * 8)
    for (i, j), move in zip(map_.links, map_.moves, strict=True):
        expected = corners[i].inverse().compose(corners[j] if j else robot.pose)
        assert move[:2] == pytest.approx([expected.x, expected.y], abs=1e-6)
        assert math.cos(move[2] - expected.heading_rad) == pytest.approx(1.0, abs=1e-9)
    for pose, corner in zip(map_.poses, corners, strict=True):
        assert pose[:2] == pytest.approx([corner.x, corner.y], abs=1e-9)


def test_where_the_robot_enters_a_zone_is_taken_off_its_link() -> None:
    """The robot need not drive through the middle of the zone: its packet tells how far beside the middle it is."""
    robot = Robot(EXACT, start=Pose2(0.0, 0.0, 0.4))
    robot.see(0, new=True)
    middle = robot.pose
    robot.go(1.0, 0.3, 1, new=True)
    start = robot.pose
    robot.pose = middle.compose(Pose2(0.3, -0.15, 0.0))
    moved = start.inverse().compose(robot.pose)
    odometry = Odometry(math.hypot(moved.x, moved.y) / 0.1, 0.0, 0.1)
    robot.see(0, odometry=odometry, facing=0.05)
    assert robot.map.active == 0
    assert (robot.map.local_pose.x, robot.map.local_pose.y) == pytest.approx((0.3, -0.15), abs=1e-6)
    assert robot.map.local_pose.heading_rad == pytest.approx(0.05)  # the image tells the heading better than the packet
    came = Pose2(math.hypot(moved.x, moved.y), 0.0, 0.0)
    expected = came.compose(Pose2(0.3, -0.15, 0.05).inverse())
    assert robot.map.links[-1].tolist() == [1, 0]
    assert robot.map.moves[-1] == pytest.approx([expected.x, expected.y, expected.heading_rad], abs=1e-6)


def test_a_view_that_shows_nothing_tells_no_heading() -> None:
    robot = Robot(EXACT)
    robot.see(-1)
    robot.go(0.5, 0.0, 1, new=True)
    robot.see(-1, facing=0.3, packet=replace(robot.packet(Pose2(0, 0, 0)), heading_rad=0.1))
    assert robot.map.active == 0
    assert robot.map.moves[-1, 2] == pytest.approx(-0.1)


@settings(max_examples=100)
@given(st.lists(st.tuples(st.floats(0.3, 1.5), st.floats(-1.5, 1.5)), min_size=2, max_size=6))
def test_repeats_of_a_transition_are_averaged(passages: list[tuple[float, float]]) -> None:
    robot = Robot(replace(EXACT, odometry_edges=False))
    robot.see(0, new=True)
    here = robot.packet()
    ends, durations = [], []
    for number, (forwards, turn) in enumerate(passages):
        robot.pose = Pose2(0.0, 0.0, 0.0)
        robot.see(0, packet=here)
        steps = 3 + number
        robot.go(forwards, turn, 1, steps=steps, new=number == 0, packet=replace(here, x=here.x + 10))
        ends.append(robot.pose)
        durations.append(steps * 0.1 + (0.1 if number == 0 else 0.0))  # it stood a tick before the first
    row = robot.map.links.tolist().index([0, 1])
    turns = [e.heading_rad for e in ends]
    assert robot.map.moves[row] == pytest.approx(
        [np.mean([e.x for e in ends]), np.mean([e.y for e in ends]), np.mean(turns)], abs=1e-6
    )
    assert robot.map.transitions.time_s[row] == pytest.approx(np.mean(durations), abs=1e-6)
    turning = [(3 + number) * 0.1 for number in range(len(passages))]
    assert robot.map.transitions.turning_s[row] == pytest.approx(np.mean(turning), abs=1e-6)


def test_a_passage_counts_by_how_well_it_is_known() -> None:
    """The weight is 1 / (1 + variance / variance of a step), with the variances of both ends and of the way."""
    params = ExperienceMapParams(anchor_sigma=0.05, odometry_drift=0.03, sweeps=0, solve_every=0)
    robot = Robot(replace(params, odometry_edges=False))
    robot.see(0, new=True)
    here = robot.packet()
    expected_sum = weights = 0.0
    for number, (way, difference, before) in enumerate([(1.0, 0.0, 0.0), (1.3, 2.0, 0.5), (0.8, 4.0, 1.0)]):
        if number:
            robot.see(0, packet=here, difference=before)
        robot.pose = Pose2(0.0, 0.0, 0.0)
        robot.go(way, 0.0, 1, new=number == 0, difference=difference, packet=replace(here, x=here.x + 10))
        at_end = 0.0 if number == 0 else 0.05 * difference
        variance = at_end**2 + (0.05 * before) ** 2 + (0.03 * way) ** 2
        weight = robot.map.step_sigma_m**2 / (robot.map.step_sigma_m**2 + variance)
        expected_sum, weights = expected_sum + weight * way, weights + weight
        row = robot.map.links.tolist().index([0, 1])
        assert robot.map.moves[row, 0] == pytest.approx(expected_sum / weights, rel=1e-6)
        assert robot.map.transitions.weight[row] == pytest.approx(weights, rel=1e-6)


def test_the_best_observation_decides_the_transition() -> None:
    """A zone is entered at its rim, but the image matches best where the experience was made, so it is measured there."""
    params = ExperienceMapParams(anchor_sigma=0.05, odometry_drift=0.0, sweeps=0, solve_every=0, odometry_edges=False)
    robot = Robot(params)
    robot.see(0, new=True)
    goal = Pose2(2.0, 0.0, 0.0)
    robot.go(2.0, 0.0, 1, new=True)
    robot.go(2.0, 0.0, 2, new=True)
    back = robot.packet(Pose2(0.0, 0.0, 0.0))
    robot.see(0, packet=back)
    robot.pose = Pose2(0.0, 0.0, 0.0)
    rows = robot.map.links.tolist()
    row = rows.index([0, 1])
    alone = robot.map.moves[row].copy()
    assert alone[0] == pytest.approx(2.0)
    # again, with odometry that reads 10 % too much; the packet is off, so that the first observation is wrong by 0.2 m
    robot.go(1.76, 0.0, 1, difference=5.0, packet=robot.packet(Pose2(goal.x - 0.2, 0.0, 0.0)))
    rim = robot.map.moves[row].copy()
    weight = robot.map.transitions.weight[row]
    robot.see(1, odometry=Odometry(2.2, 0.0, 0.1), difference=6.0, packet=robot.packet(goal))
    assert np.array_equal(robot.map.moves[row], rim)  # a worse look changes nothing
    robot.see(1, odometry=Odometry(0.22, 0.0, 0.1), difference=1.0, packet=robot.packet(goal))
    better = robot.map.moves[row]
    assert robot.map.transitions.weight[row] > weight
    share = (1e-4 / (1e-4 + 0.05**2)) / (1 + 1e-4 / (1e-4 + 0.05**2))
    came = 1.76 + 0.22 + 0.022
    assert better[0] == pytest.approx(2.0 + share * (came - 2.0), abs=1e-6)
    assert len(robot.map.links) == len(rows)


def test_odometry_past_known_places_keeps_the_chain_rigid() -> None:
    """Two new experiences with a known one between them. The odometry edge between the new ones is no link."""
    robot = Robot(ExperienceMapParams(odometry_drift=0.03, sweeps=0, solve_every=0))
    robot.see(0, new=True)
    robot.go(1.0, 0.2, 1, new=True)
    first_new = robot.pose
    robot.see(0, difference=5.0, packet=robot.packet(Pose2(0.0, 0.0, 0.0)))  # perceptual aliasing
    robot.go(0.8, -0.1, 2, new=True)
    assert robot.map.links.tolist() == [[0, 1], [1, 0], [0, 2]]
    assert robot.map.link_count == len(robot.map.moves) == len(robot.map.link_times) == 3
    rows = robot.map.transitions.ends[: robot.map.transitions.count].tolist()
    assert rows == [[0, 1], [1, 0], [0, 2], [1, 2]]
    spine = first_new.inverse().compose(robot.pose)
    assert robot.map.transitions.move[3] == pytest.approx([spine.x, spine.y, spine.heading_rad], abs=1e-9)
    assert robot.map.transitions.weight[3] == pytest.approx(1e-4 / (1e-4 + (0.03 * 0.8) ** 2))


def test_no_observation_is_averaged_into_the_backbone() -> None:
    """The way to a place that was made straight after another is odometry, and stays so. Later passages count for its
    time alone, and a way that begins with an observation ties nothing rigidly."""
    robot = Robot(ExperienceMapParams(odometry_drift=0.03, sweeps=0, solve_every=0))
    robot.see(0, new=True)
    start = robot.packet()
    robot.go(1.0, 0.2, 1, new=True)
    t = robot.map.transitions
    backbone, weight = t.move[0].copy(), float(t.weight[0])
    robot.see(0, difference=5.0, packet=start)
    robot.pose = Pose2(0.0, 0.0, 0.0)
    robot.go(1.4, 0.0, 1, packet=robot.packet(Pose2(1.0, 0.0, 0.2)), difference=5.0)
    assert t.row_of[0, 1] == 0
    assert t.passages[0] == 2
    assert t.move[0].tolist() == backbone.tolist()
    assert t.weight[0] == weight
    robot.go(0.5, 0.0, 2, new=True)  # from an observation of 1, which was made last
    ends = t.ends[: t.count].tolist()
    assert ends == [[0, 1], [1, 0], [1, 2], [1, 2]]
    assert t.chain[: t.count].tolist() == [True, False, False, True]
    assert t.move[3] == pytest.approx([1.9, 0.0, 0.0], abs=1e-9)  # all that was driven since 1 was made


def test_a_kidnap_makes_no_way() -> None:
    """From the place before a kidnap to the one after it there is no transition, neither now nor later."""
    robot = Robot(replace(EXACT, odometry_drift=0.03))
    robot.see(0, new=True)
    robot.go(1.0, 0.0, 1, new=True)
    ways = [[0, 1]]
    robot.map.declare_kidnapped()
    robot.pose = Pose2(5.0, 3.0, 0.0)
    assert robot.see(2, new=True)  # carried to where it has never been
    assert robot.map.links.tolist() == ways
    robot.go(0.5, 0.0, 3, new=True)
    ways += [[2, 3]]
    assert robot.map.links.tolist() == ways
    robot.map.declare_kidnapped()
    robot.pose = Pose2(0.0, 0.0, 0.0)
    robot.see(0)  # carried to a known place
    assert robot.map.active == 0
    assert robot.map.links.tolist() == ways
    assert robot.map.link_count == len(ways)
    assert robot.map.transitions.weight[: robot.map.transitions.count].min() < 1e-6  # and it has next to no weight
    assert robot.map.local_pose.x == pytest.approx(0.0)


def test_a_way_driven_after_a_kidnap_along_it_is_a_way() -> None:
    robot = Robot(replace(EXACT, odometry_drift=0.03))
    robot.see(0, new=True)
    robot.go(1.0, 0.0, 1, new=True)
    robot.map.declare_kidnapped()
    robot.pose = Pose2(0.0, 0.0, 0.0)
    robot.see(0)  # carried from 1 to 0
    assert robot.map.links.tolist() == [[0, 1]]
    robot.go(1.0, 0.0, 1)
    robot.go(-1.0, 0.0, 0)  # and now driven
    assert robot.map.links.tolist() == [[0, 1], [1, 0]]
    assert robot.map.moves[1] == pytest.approx([-1.0, 0.0, 0.0], abs=0.01)
    assert robot.map.link_times[1] == pytest.approx(1.0)
    assert robot.map.link_count == 2


def test_wheels_that_stand_have_no_time_of_turning() -> None:
    robot = Robot(EXACT)
    robot.see(0, new=True)
    for _ in range(7):
        robot.see(0)  # standing
    robot.go(0.5, 0.3, 1, new=True, steps=5)
    assert robot.map.link_times[0] == pytest.approx(1.2)
    assert robot.map.transitions.turning_s[0] == pytest.approx(0.5)


def test_no_link_is_quicker_than_the_robot() -> None:
    """From the edge of one zone into the next is only a step, but a link takes as long as its length in the map."""
    robot = Robot(EXACT)
    robot.see(0, new=True)
    robot.go(1.0, 0.0, 1, new=True)  # a metre in a second
    slow = robot.map.link_times.copy()
    assert slow == pytest.approx([1.1], abs=0.11)
    robot.see(0, packet=robot.packet(Pose2(0.0, 0.0, 0.0)), difference=5.0)  # only a step by the clock
    assert robot.map.transitions.time_s[1] == pytest.approx(0.1)
    assert robot.map.link_times[1] == pytest.approx(np.hypot(*(robot.map.poses[1, :2] - robot.map.poses[0, :2])))
    robot.map.poses[1, :2] *= 2  # when the map stretches, so does the time
    assert robot.map.link_times[1] == pytest.approx(2.0)


def test_what_is_deleted_elsewhere_does_not_keep_a_better_observation_from_measuring() -> None:
    robot = Robot(replace(EXACT, anchor_sigma=0.05, odometry_edges=False))
    robot.see(0, new=True)
    here = robot.packet()
    for view in (1, 2, 1):
        robot.pose = Pose2(0.0, 0.0, 0.0)
        robot.see(0, packet=here)
        robot.go(1.0, 0.0, view, difference=5.0, packet=replace(here, x=here.x + 10))
    row = robot.map.transitions.row_of[0, 1]
    before = robot.map.transitions.weight[row]
    while (0, 2) in robot.map.transitions.row_of:
        robot.map.tried(0, 2, False)
    robot.see(1, difference=1.0, odometry=Odometry(0.3, 0.0, 0.1), packet=replace(here, x=here.x + 10))
    assert robot.map.transitions.weight[row] > before
