"""A look that would move the robot farther than it can be off is held back, and wins only when many agree."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, Pose2, PoseFilterParams
from ratslam_core.extensions.gate import Gate

from .drives import Robot

PLAIN = ExperienceMapParams(odometry_drift=0.03, sweeps=0, solve_every=0, join_views=1)
P = PoseFilterParams()
HERE, THERE = Pose2(1.0, 1.0, 0.5), Pose2(4.0, -1.0, 2.0)
poses = st.builds(Pose2, st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 3))


def beside(pose: Pose2, dx: float = 0.0, turn: float = 0.0) -> Pose2:
    return Pose2(pose.x + dx, pose.y, pose.heading_rad + turn)


@given(st.floats(0.0, 100.0))
def test_a_look_reaches_as_far_as_the_robot_may_be_off(sigma_m: float) -> None:
    assert Gate(P).reach_m(sigma_m) == max(P.snap_m, P.gate_sigma * sigma_m)
    assert math.isinf(Gate(replace(P, gate=False)).reach_m(sigma_m))


@given(st.integers(1, 20))
def test_it_wins_at_the_sight_that_was_asked_for(needed: int) -> None:
    gate = Gate(P)
    answers = [gate.believes(HERE, THERE, needed, 7) for _ in range(2 * needed)]
    assert answers == ([False] * (needed - 1) + [True]) * 2


@given(poses, poses, st.lists(poses, min_size=1, max_size=5))
def test_the_hypothesis_moves_by_the_robots_odometry(robot: Pose2, other: Pose2, moves: list[Pose2]) -> None:
    """Where the robot is and where it may be keep their distance along the whole way."""
    gate = Gate(P)
    gate.believes(robot, other, 99, 1)
    for move in moves:
        robot, other = robot.compose(move), other.compose(move)
        found = gate.hypothesis(robot)
        assert found is not None
        assert (found.x, found.y) == pytest.approx((other.x, other.y), abs=1e-6)
        assert math.cos(found.heading_rad - other.heading_rad) == pytest.approx(1.0)
        assert not gate.believes(robot, other, 99, 1)
    assert gate.sights == 1 + len(moves)


@pytest.mark.parametrize("step", [(P.agrees_m, 0.0), (0.0, P.agrees_rad)])
def test_sights_agree_up_to_the_limit(step: tuple[float, float]) -> None:
    start = Pose2(0.0, 0.0, 0.0)
    for share, agrees in ((1.0, True), (1.0001, False)):
        gate = Gate(P)
        gate.believes(start, start, 9, 0)
        gate.believes(start, beside(start, share * step[0], share * step[1]), 9, 0)
        assert gate.sights == (2 if agrees else 1)


def test_a_sight_against_it_takes_one_away_and_the_last_gives_way() -> None:
    gate, other = Gate(P), beside(THERE, 3.0)
    for known in (5, 6, 7):
        gate.believes(HERE, THERE, 9, known)
    assert (gate.sights, gate.known) == (3, 5)
    for left in (2, 1):
        assert not gate.believes(HERE, other, 9, 8)
        assert gate.sights == left
        assert gate.hypothesis(HERE) == THERE
    assert not gate.believes(HERE, other, 9, 9)
    assert (gate.sights, gate.known) == (1, 9)
    assert gate.hypothesis(HERE) == other
    gate.doubt()
    gate.doubt()
    assert gate.sights == 0
    assert gate.hypothesis(HERE) is None


def test_who_misses_what_it_expects_gives_way_sooner() -> None:
    gate = Gate(P)
    taken = 1
    while not gate.believes(HERE, THERE, P.gate_sights, 7, surprised=True):
        taken += 1
    assert taken == -(-P.gate_sights // P.gate_surprise)


# ---------------------------------------------------------------- in the map


def a_walk(**gate: float | bool) -> Robot:
    """A walk of sixteen metres, after which the torus of 64 cells uses the cells of the start again."""
    robot = Robot(PLAIN, filter_params=replace(P, **gate))  # type: ignore[arg-type]
    robot.see(0, new=True)
    for view in range(1, 17):
        robot.go(1.0, 0.0, view, new=True)
    assert len(robot.map) == 17
    return robot


@pytest.mark.parametrize("gate", [True, False])
def test_one_look_alike_closes_no_loop(gate: bool) -> None:
    robot = a_walk(gate=gate)
    assert robot.see(0) is gate  # held back, it is taken for a new place
    assert (robot.map.active == 0) is not gate
    assert robot.map.closures == (not gate)
    assert robot.map.robot.x == pytest.approx(16.0 if gate else 0.0)


def test_a_robot_that_may_be_anywhere_within_reach_believes_it() -> None:
    robot = a_walk(gate_sigma=16 / (0.03 * 16) + 0.1)
    assert not robot.see(0)
    assert robot.map.active == 0


@pytest.mark.parametrize(("gate_rad", "held"), [(3.2, False), (0.8, True)])
def test_a_look_that_turns_the_robot_is_held_back(gate_rad: float, held: bool) -> None:
    """As near as it puts the robot: one whose heading is sure is not turned by a look-alike. 3.2 is the plain twin."""
    robot = Robot(PLAIN, filter_params=replace(P, gate_rad=gate_rad))
    robot.see(0, new=True)
    robot.go(0.5, 0.0, 1, new=True)
    assert robot.see(0, facing=1.5, packet=robot.packet(Pose2(0.0, 0.0, 0.0))) is held
    assert (robot.map.active == 0) is not held
    assert robot.map.robot.heading_rad == pytest.approx(0.0 if held else 1.5)


def test_a_look_that_turns_it_less_is_not() -> None:
    robot = Robot(PLAIN, filter_params=replace(P, gate_rad=0.8))
    robot.see(0, new=True)
    robot.go(0.5, 0.0, 1, new=True)
    assert not robot.see(0, facing=0.7, packet=robot.packet(Pose2(0.0, 0.0, 0.0)))
    assert robot.map.active == 0


@settings(max_examples=20)
@given(st.integers(1, 8))
def test_sights_that_agree_win(needed: int) -> None:
    robot = a_walk(gate_sights=needed)
    for sight in range(1, needed + 1):
        robot.see(0)
        assert (robot.map.active == 0) is (sight == needed)
        assert robot.map.corrected == (sight == needed)
    assert robot.map.robot.x == pytest.approx(0.0)
    assert robot.map.closures == 1


@pytest.mark.parametrize(("drift", "needed"), [(1.01, 8), (0.99, 900), (0.0, 900)])
def test_a_long_loop_closes_soon(drift: float, needed: int) -> None:
    """Sixteen metres of odometry that no loop has bridged may be off by as much as the drift says; then few sights win."""
    robot = a_walk(gate_drift=drift)
    assert robot.map.params.join_sights == 8
    for _ in range(7):
        assert robot.see(0) is (robot.map.gate.sights == 1)  # the first is taken for a new place
    robot.see(0)
    assert (robot.map.active == 0) is (needed == 8)
    assert robot.map.corrected == 0  # odometry was as good as could be expected
    assert (robot.map.transitions.weight[: robot.map.transitions.count] > 1e-3).all()


def test_what_was_made_in_doubt_is_no_witness() -> None:
    """A place that was new only because a look was held back does not speak against that look."""
    robot = a_walk(gate_sights=5)
    robot.see(0)
    assert len(robot.map) == 18  # made in doubt, and seen from now on
    for sights in (2, 3, 4):
        robot.see(0)
        assert robot.map.active == 17
        assert robot.map.gate.sights == sights
    robot.see(16, packet=robot.packet(Pose2(16.0, 0.0, 0.0)))  # a place that was made without doubt
    assert robot.map.active == 16
    assert robot.map.gate.sights == 3


@given(st.lists(st.integers(0, 4), min_size=1, max_size=20), st.integers(1, 5), st.integers(1, 8))
def test_so_many_different_views_must_agree(seen: list[int], views: int, needed: int) -> None:
    """Who stands before one view and sees it for ever has seen one thing."""
    gate = Gate(P)
    believed = [gate.believes(HERE, THERE, needed, 7, view=view, views=views) for view in seen]
    ready = [k + 1 >= needed and len(set(seen[: k + 1])) >= views for k in range(len(seen))]
    first = ready.index(True) if True in ready else len(seen)
    assert believed[: first + 1] == ready[: first + 1]


def test_a_sight_that_lasts_counts_for_several() -> None:
    gate = Gate(P)
    assert [gate.believes(HERE, THERE, 12, 7, beats=5) for _ in range(3)] == [False, False, True]
    gate.believes(HERE, THERE, 12, 7, beats=5)
    gate.doubt(5)
    assert gate.sights == 0
