"""How the experience map is corrected: a closed loop, the bias that it tells, and when a solution is asked for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import ExperienceMapParams, Odometry, Pose2, Recognition
from ratslam_core.extensions import exact_solver
from ratslam_core.pose_graph import relaxation

from .drives import Robot


def loop(params: ExperienceMapParams, bias: float, laps: int) -> tuple[Robot, dict[int, Pose2]]:
    """A square of 16 views, driven exactly, while the wheels report a biased yaw rate; and where each view was first seen."""
    robot = Robot(replace(params, bias_sigma=10.0))  # as good as no doubt of the bias
    places = {0: robot.pose}
    robot.see(0, new=True)
    for side in range(16 * laps):
        length, turn = 0.75 / 5, math.pi / 2 / 5 if side % 4 == 3 else 0.0
        for step in range(5):
            move = Pose2(length * math.cos(turn / 2), length * math.sin(turn / 2), turn)
            robot.pose, view = robot.pose.compose(move), (side + (step == 4)) % 16
            new, odometry = view not in places, Odometry(length / 0.1, turn / 0.1 + bias, 0.1)
            at = places.setdefault(view, robot.pose)
            robot.map.step(robot.packet(at), Recognition(view, new, view, 0.1), odometry)
        robot.map.correct()
    return robot, places


def test_a_closed_loop_straightens_the_map_and_finds_the_bias() -> None:
    bias = math.radians(1.0)
    robot, places = loop(ExperienceMapParams(solve_every=5), bias, 6)
    assert robot.map.yaw_bias == pytest.approx(bias, rel=0.15)
    true = np.array([[places[view].x, places[view].y] for view in robot.map.views.tolist()])
    across = [np.hypot(*(at - np.roll(at, 8, axis=0)).T) for at in (robot.map.poses[:, :2], true)]
    assert len(robot.map) == 16
    assert across[0] == pytest.approx(across[1], rel=0.1)


def test_the_bias_is_taken_off_the_links_that_told_it() -> None:
    """One lap of a loop: once its bias is known, the turns along its links add up to a full turn."""
    bias = math.radians(1.0)
    params = ExperienceMapParams(solve_every=1, sweeps=0, robust=False, anchor_sigma=0.0, odometry_drift=0.0)
    for calibrate in (False, True):
        robot, _ = loop(replace(params, calibrate=calibrate), bias, 1)
        assert robot.map.links.tolist() == [[i, (i + 1) % 16] for i in range(16)]
        too_far = math.remainder(float(robot.map.moves[:, 2].sum()), 2 * math.pi)
        assert too_far == pytest.approx(0.0 if calibrate else 8.0 * bias, abs=1e-6)
        assert robot.map.yaw_bias == pytest.approx(bias if calibrate else 0.0, abs=1e-6)


def test_a_correction_that_was_hard_is_followed_by_a_long_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop that closes in every step. Corrections are due in every step, but rest after one in proportion to its cost."""
    solve = relaxation.solve
    for a_step, rested in ((1e5, False), (2e2, True)):
        (robot, _), solved = loop(ExperienceMapParams(solve_every=1), 0.0, 1), []
        monkeypatch.setattr(exact_solver, "WORK_A_STEP", a_step)
        monkeypatch.setattr(
            relaxation, "solve", lambda *given, solved=solved: solved.append(solve(*given)) or solved[-1]
        )
        for _ in range(60):
            robot.map.closures += 1
            robot.map.correct()
        rests = max(1, math.ceil(solved[0].work / a_step))
        assert (rests > 4) is rested
        assert len(solved) == pytest.approx(60 / rests, abs=1)


def test_a_very_large_map_is_swept_in_some_beats_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a beat costs no more than one with a map of `most` experiences, on average."""
    robot, _ = loop(ExperienceMapParams(solve_every=0), 0.0, 1)
    assert len(robot.map) == 16
    for most, every in ((1000, 1), (16, 2), (5, 4)):
        monkeypatch.setattr(exact_solver, "MOST_SWEPT", most)
        swept = []
        monkeypatch.setattr(relaxation, "sweep", lambda *_, swept=swept: swept.append(robot.map.steps))
        robot.map.correct(beats=12)
        assert len(swept) == 12 // every


def test_the_exact_solution_is_asked_for_only_after_closures() -> None:
    for solve_every in (1, 0):
        robot = Robot(ExperienceMapParams(solve_every=solve_every, sweeps=0))
        robot.see(0, new=True)
        robot.go(1.0, 0.5, 1, new=True)
        robot.map.poses[1, 0] += 0.5  # bent by hand
        bent = robot.map.poses.copy()
        robot.map.correct()
        assert np.array_equal(robot.map.poses, bent)
        robot.see(0, packet=robot.packet(Pose2(0.0, 0.0, 0.0)))
        robot.map.correct()
        assert np.array_equal(robot.map.poses, bent) is (solve_every == 0)
