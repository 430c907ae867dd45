"""A jump in the map is believed at once, or only after several sights that agree."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, Pose2, PoseFilterParams
from ratslam_core.extensions.loop_verifier import LoopVerifier

from .drives import Robot

PLAIN = ExperienceMapParams(odometry_drift=0.03, sweeps=0, solve_every=0)
P = PoseFilterParams()
HERE = Pose2(1.0, 1.0, 0.5)


def far(dx: float = 3.0, dy: float = 0.0, turn: float = 0.0) -> Pose2:
    return Pose2(HERE.x + dx, HERE.y + dy, HERE.heading_rad + turn)


@given(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7), st.floats(-0.79, 0.79), st.integers(0, 10))
def test_what_fits_the_map_needs_no_confirmation(dx: float, dy: float, turn: float, needed: int) -> None:
    assert LoopVerifier(P).believes(HERE, far(dx, dy, turn), needed)


@pytest.mark.parametrize(
    ("at", "believed"),
    [
        (Pose2(P.snap_m, 0.0, 0.0), True),
        (Pose2(0.0, -P.snap_m, 0.0), True),
        (Pose2(0.0, 0.0, P.snap_rad), True),
        (Pose2(math.nextafter(P.snap_m, 9.0), 0.0, 0.0), False),
        (Pose2(0.0, 0.0, math.nextafter(P.snap_rad, 9.0)), False),
    ],
)
def test_what_is_just_as_far_as_the_limit_is_no_jump(at: Pose2, believed: bool) -> None:
    assert LoopVerifier(P).believes(Pose2(0.0, 0.0, 0.0), at, 2) is believed


@pytest.mark.parametrize("step", [(P.agrees_m, 0.0), (0.0, P.agrees_rad)])
def test_sights_that_are_just_as_far_apart_as_the_limit_agree(step: tuple[float, float]) -> None:
    verifier, origin = LoopVerifier(replace(P, snap_m=1.0)), Pose2(0.0, 0.0, 0.0)
    assert not verifier.believes(origin, Pose2(0.0, 2.0, 0.0), 2)
    assert verifier.believes(origin, Pose2(step[0], 2.0, step[1]), 2)


@given(st.integers(1, 20), st.sampled_from([(3.0, 0.0, 0.0), (0.0, -1.1, 0.0), (0.0, 0.0, 0.9), (0.0, 0.0, math.pi)]))
def test_a_jump_is_believed_at_the_sight_that_was_asked_for(needed: int, jump: tuple[float, float, float]) -> None:
    verifier = LoopVerifier(P)
    answers = [verifier.believes(HERE, far(*jump), needed) for _ in range(2 * needed)]
    assert answers == ([False] * (needed - 1) + [True]) * 2


def test_none_asked_for_is_believed_at_once() -> None:
    assert LoopVerifier(P).believes(HERE, far(), 0)


@pytest.mark.parametrize(
    "other", [far(3.0 + P.agrees_m + 0.01), far(3.0, P.agrees_m + 0.01), far(3.0, 0.0, P.agrees_rad + 0.01)]
)
def test_a_sight_that_disagrees_begins_anew(other: Pose2) -> None:
    verifier = LoopVerifier(P)
    assert not verifier.believes(HERE, far(), 3)
    assert not verifier.believes(HERE, far(), 3)
    assert not verifier.believes(HERE, other, 3)
    assert not verifier.believes(HERE, other, 3)
    assert verifier.believes(HERE, other, 3)


def test_a_sight_that_fits_the_map_ends_the_doubt() -> None:
    verifier = LoopVerifier(P)
    assert not verifier.believes(HERE, far(), 2)
    assert verifier.believes(HERE, HERE, 2)
    assert not verifier.believes(HERE, far(), 2)


# ---------------------------------------------------------------- in the map


def a_walk(needed: int) -> Robot:
    """A walk of sixteen metres, after which the torus of 64 cells uses the cells of the start again."""
    robot = Robot(replace(PLAIN, confirm_jumps=needed))
    robot.see(0, new=True)
    for view in range(1, 17):
        robot.go(1.0, 0.0, view, new=True)
    assert len(robot.map) == 17
    return robot


def test_one_look_alike_closes_no_loop() -> None:
    for needed, closes in ((0, True), (1, True), (2, False), (5, False)):
        robot = a_walk(needed)
        assert not robot.see(0)  # known, so nothing new is made
        assert (robot.map.active == 0) is closes
        assert (robot.map.closures == 1) is closes
        assert (len(robot.map.links) == 17) is closes
        assert robot.map.robot.x == pytest.approx(0.0 if closes else 16.0)


@settings(max_examples=20)
@given(st.integers(1, 8))
def test_sights_in_a_row_close_it(needed: int) -> None:
    robot = a_walk(needed)
    for sight in range(1, needed + 1):
        robot.see(0)
        assert (robot.map.active == 0) is (sight == needed)
    assert robot.map.links[-1].tolist() == [16, 0]
    assert robot.map.link(16, 0).time_s == pytest.approx(0.1 * needed)


def test_a_robot_that_was_carried_away_asks_for_no_confirmation() -> None:
    robot = a_walk(5)
    robot.map.declare_kidnapped()
    robot.see(0)
    assert robot.map.active == 0
