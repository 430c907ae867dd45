"""Links: how sure they are after trials, when they are deleted, and what is a trial."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, Odometry, Packet, Pose2
from ratslam_core.laws.experience_map import transitions as transitions_law
from ratslam_core.pose_graph.transitions import Transitions

from .drives import EXACT, Robot
from .test_transitions import HOME, drive_there_and_back, two_places

outcomes = st.lists(st.booleans(), max_size=60)


@settings(max_examples=200)
@given(outcomes, st.integers(1, 8), st.floats(0.0, 0.9))
def test_a_link_is_as_sure_as_its_trials_and_goes_below_the_bar(tried: list[bool], least: int, bar: float) -> None:
    """D9: c_ij = n_ij / n. The passage by which it was learnt is the first trial."""
    robot = two_places(replace(EXACT, link_confidence=bar, link_trials=least))
    arrived, n = 1, 1
    for reached in tried:
        arrived, n = arrived + reached, n + 1
        gone = n >= least and arrived < bar * n
        assert robot.map.tried(0, 1, reached) is gone
        if gone:
            assert (0, 1) in robot.map.dropped_links
            return
        assert robot.map.dropped_links == ()
        link = robot.map.link(0, 1)
        assert (link.trials, link.confidence) == (n, pytest.approx(arrived / n))


def fail(robot: Robot, i: int, j: int) -> None:
    for _ in range(100):
        robot.map.tried(i, j, False)
        if (i, j) not in robot.map.transitions.row_of:
            return
    raise AssertionError("never deleted")


def test_a_trial_counts_for_both_ways_round() -> None:
    robot = two_places(EXACT)
    fail(robot, 0, 1)
    assert sorted(robot.map.dropped_links) == [(0, 1), (1, 0)]
    assert robot.map.link_count == len(robot.map.links) == len(robot.map.link_times) == 0
    assert not robot.map.tried(0, 1, True)  # nothing there to be judged


def test_a_deleted_link_comes_back_when_driven_again() -> None:
    robot = two_places(EXACT)
    robot.see(0)
    fail(robot, 0, 1)
    drive_there_and_back(robot, behaviour=4)
    assert robot.map.links.tolist() == [[0, 1], [1, 0]]
    link = robot.map.link(0, 1)
    assert (link.trials, link.confidence, link.behaviour, link.passages) == (1, 1.0, 4, 1)
    assert link.distance_m == pytest.approx(1.0)
    assert len(robot.map.dropped_links) == 2


def test_a_deleted_observation_leaves_its_row_to_the_next() -> None:
    robot = two_places(EXACT)
    robot.see(0)
    t, rows = robot.map.transitions, robot.map.transitions.count
    t.reuses = True
    fail(robot, 1, 0)
    for again in range(3):
        drive_there_and_back(robot, behaviour=again)
        assert sorted(robot.map.links.tolist()) == [[0, 1], [1, 0]]
        assert robot.map.link(1, 0).passages == robot.map.link(1, 0).trials == 1
        assert robot.map.link(1, 0).behaviour == again
        fail(robot, 1, 0)
        assert t.count <= rows + 1
        transitions_law(t, len(robot.map))


def test_what_was_deleted_is_measured_no_more() -> None:
    """It may be the link by which the robot has just arrived, and which a better look would measure again."""
    robot = two_places(replace(EXACT, anchor_sigma=0.05))
    robot.go(1.0, 0.0, 1, packet=robot.packet(Pose2(1.0, 0.0, 0.0)), difference=5.0)
    fail(robot, 0, 1)
    t = robot.map.transitions
    before = t.move[: t.count].copy(), t.weight[: t.count].copy()
    robot.see(1, difference=1.0, odometry=Odometry(0.3, 0.0, 0.1))
    assert np.array_equal(t.move[: t.count], before[0])
    assert np.array_equal(t.weight[: t.count], before[1])


@settings(max_examples=30)
@given(st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=20))
def test_whatever_is_deleted_the_map_stays_in_one_piece(doubted: list[tuple[int, int]]) -> None:
    """Odometry between successive experiences still holds them together; only observations of known places lose their weight."""
    params = ExperienceMapParams(solve_every=1)
    robot = Robot(params)
    robot.see(0, new=True)
    for view in range(1, 12):
        robot.go(0.7, 0.4, view, new=True)
    for view in (0, 3, 7, 2):
        robot.see(view, difference=3.0, packet=Packet(*robot.map.cell_state(view)[:2], 0.4 * view, 1.0))
    for i, j in doubted:
        if (i, j) in robot.map.transitions.row_of:
            fail(robot, i, j)
    t = robot.map.transitions
    pulls = t.ends[: t.count][t.weight[: t.count] > 0]
    reached, grown = {0}, True
    while grown:
        more = {int(j) for i, j in pulls if int(i) in reached} | {int(i) for i, j in pulls if int(j) in reached}
        grown = not more <= reached
        reached |= more
    assert reached == set(range(12))
    for i, j in robot.map.dropped_links:
        chained = j == i + 1  # as they were made
        row = next(r for r in range(t.count) if tuple(t.ends[r]) == (i, j) and not t.travelled[r])
        assert bool(t.weight[row] > 0) is chained
    robot.map.correct()
    assert np.isfinite(robot.map.poses).all()


# ---------------------------------------------------------------- what is a trial


def test_no_way_of_a_crossroads_is_sure() -> None:
    """D9 to the letter: each of eight links that are driven in turn by one behaviour has a confidence of 1/8, and is deleted."""
    robot = Robot(EXACT)
    robot.see(0, new=True)
    for lap in range(5):
        for way in range(8):
            robot.pose = Pose2(0.0, 0.0, way * math.pi / 4)
            robot.go(1.5, 0.0, 1 + way, new=lap == 0)
            robot.pose = HOME
            robot.see(0)
    gone = robot.map.dropped_links
    assert len(gone) > 8
    assert {i for i, _ in gone} == {0}  # the ways back are the only ones from where they begin
    assert all(robot.map.link(way, 0).confidence == 1.0 for way in range(1, 9))


def test_departures_under_another_behaviour_are_no_trials() -> None:
    robot = two_places(EXACT)
    robot.behaviour = 2
    robot.go(1.5, 0.0, 2, new=True)
    assert robot.map.link(0, 1).trials == 1
    robot.pose = HOME
    robot.see(0)
    drive_there_and_back(robot, behaviour=2)  # by another behaviour than it was learnt: no trial of it, but of 0 -> 2
    assert robot.map.link(0, 1).trials == 1
    assert robot.map.link(0, 1).passages == 2
    assert (robot.map.link(0, 2).trials, robot.map.link(0, 2).confidence) == (2, 0.5)
    drive_there_and_back(robot, behaviour=0)
    assert robot.map.link(0, 1).trials == 2
    assert robot.map.link(0, 2).trials == 2


def test_thousands_of_rows_keep_what_they_are() -> None:
    t = Transitions()
    p = ExperienceMapParams()
    for _node in range(1501):
        t.graph.add_node()
    for k in range(1500):
        row = t.add(k, k + 1, travelled=True, behaviour=k % 16)
        t.judge(row, True, p)
    assert t.behaviour[:1500].tolist() == [k % 16 for k in range(1500)]
    assert t.trials[:1500].tolist() == [1] * 1500
    assert [int(r) for r in t.departures(20, 4)] == [20]
