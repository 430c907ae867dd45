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

PLACES: dict[int, Pose2] = {}


def lap(robot: Robot, bias: float) -> None:
    """A square of 16 views, driven exactly, while the wheels report a biased yaw rate."""
    for side in range(4):
        for part in range(4):
            view = (4 * side + part + 1) % 16
            turn = math.pi / 2 if part == 3 else 0.0
            steps = 5
            for step in range(steps):
                middle = turn / steps / 2
                robot.pose = robot.pose.compose(
                    Pose2(0.75 / steps * math.cos(middle), 0.75 / steps * math.sin(middle), turn / steps)
                )
                odometry = Odometry(0.75 / steps / 0.1, turn / steps / 0.1 + bias, 0.1)
                now = view if step == steps - 1 else (view - 1) % 16
                known = any(robot.map.cell_state(i)[3] == now for i in range(len(robot.map)))
                packet = robot.packet(PLACES[now]) if known else robot.packet()
                if now not in PLACES:
                    PLACES[now] = robot.pose
                robot.map.step(packet, Recognition(now, not known, now, 0.1), odometry)
            robot.map.correct()


def loop(params: ExperienceMapParams, bias: float, laps: int) -> Robot:
    PLACES.clear()
    PLACES[0] = Pose2(0.0, 0.0, 0.0)
    robot = Robot(replace(params, bias_sigma=10.0))  # as good as no doubt of the bias
    robot.see(0, new=True)
    for _ in range(laps):
        lap(robot, bias)
    return robot


def test_a_closed_loop_straightens_the_map_and_finds_the_bias() -> None:
    bias = math.radians(1.0)
    learnt = loop(ExperienceMapParams(solve_every=5), bias, 6)
    assert learnt.map.yaw_bias == pytest.approx(bias, rel=0.15)
    assert len(learnt.map) == 16
    true = [PLACES[learnt.map.cell_state(i)[3]] for i in range(16)]
    for i in range(16):
        d_map = np.hypot(*(learnt.map.poses[i, :2] - learnt.map.poses[(i + 8) % 16, :2]))
        d_true = math.hypot(true[i].x - true[(i + 8) % 16].x, true[i].y - true[(i + 8) % 16].y)
        assert d_map == pytest.approx(d_true, rel=0.1)


def test_the_bias_is_taken_off_the_links_that_told_it() -> None:
    """One lap of a loop: once its bias is known, the turns along its links add up to a full turn."""
    bias = math.radians(1.0)
    params = ExperienceMapParams(solve_every=1, sweeps=0, robust=False, anchor_sigma=0.0, odometry_drift=0.0)
    for calibrate in (False, True):
        robot = loop(replace(params, calibrate=calibrate), bias, 1)
        assert robot.map.links.tolist() == [[i, (i + 1) % 16] for i in range(16)]
        too_far = math.remainder(float(robot.map.moves[:, 2].sum()), 2 * math.pi)
        assert too_far == pytest.approx(0.0 if calibrate else 8.0 * bias, abs=1e-6)
        assert robot.map.yaw_bias == pytest.approx(bias if calibrate else 0.0, abs=1e-6)


def test_a_correction_that_was_hard_is_followed_by_a_long_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop that closes in every step. Corrections are due in every step, but rest after one in proportion to its cost."""
    solve = relaxation.solve
    for a_step, rested in ((1e5, False), (2e2, True)):
        robot, solved = loop(ExperienceMapParams(solve_every=1), 0.0, 1), []
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
    robot = loop(ExperienceMapParams(solve_every=0), 0.0, 1)
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
