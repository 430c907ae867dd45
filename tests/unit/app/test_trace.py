"""A trace is the same run as the trial, in plain arrays."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from app.code_version import code_version
from app.protocol.course import Course, run_ticks
from app.protocol.steps import Explore, Kidnap, Tag, Visit
from app.protocol.trace import EVERY_S, Recorder, Trace, placed, trace_of
from app.protocol.trial import Trial, run_trial, text_of
from ratslam_core import Pose2
from sim2d.importers import open_world

pytestmark = pytest.mark.slow

WORLD = open_world("office")
PROTOCOL = (
    Tag(do="tag", places=["kitchen"]),
    Explore(do="explore", minutes=0.5),
    Kidnap(do="kidnap", turn_deg=120),
    Explore(do="explore", minutes=0.3),
    Visit(do="visit", places=["kitchen"], timeout_s=2),
)
MADE = Trial(
    "made", "ours", (), 3, "office", text_of(WORLD), {"pose_cells.n_x": 8, "pose_cells.n_y": 8, "pilot.seek": False},
    PROTOCOL, ("Packets",), code_version(),
)  # fmt: skip
TO_A_GOAL = replace(
    MADE,
    seed=9,
    protocol=(
        Tag(do="tag", places=["printer"]),
        Explore(do="explore", minutes=4),
        Visit(do="visit", places=["printer"], timeout_s=60),
    ),
)


@pytest.fixture(scope="module")
def trace() -> Trace:
    return trace_of(MADE)


@pytest.fixture(scope="module")
def watched_run() -> tuple[Course, Recorder]:
    """A course that went to its goals, and its recorder."""
    course = TO_A_GOAL.begin()
    recorder = Recorder(course)
    run_ticks(course, course.ticks(), [recorder.note])
    return course, recorder


def test_a_trace_is_the_run_of_its_trial(trace: Trace) -> None:
    result, course = run_trial(MADE)
    assert (len(trace.map.poses), len(trace.map.links), len(trace.snaps)) == tuple(
        result.scores[name] for name in ("experiences", "links", "snaps")
    )
    poses = course.session.brain.experience_map.poses
    np.testing.assert_array_equal(trace.map.poses, placed(poses, trace.map.in_office))
    assert (trace.moments, trace.visits) == (tuple(course.moments), tuple(course.visits))
    assert [kidnap.after_s for kidnap in trace.kidnaps] == [k.after_s for k in course.session.evaluation.kidnaps]
    off = np.linalg.norm(trace.mapped_path - trace.true_path, axis=1)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(result.scores["error_m"], rel=0.1)
    assert trace.movements is None, "it never followed a route"


def test_a_trace_goes_from_one_process_to_another(trace: Trace) -> None:
    again = pickle.loads(pickle.dumps(trace))
    assert again.trial == trace.trial
    for name in ("time_s", "truth", "cells", "mass", "true_path", "mapped_path", "odometry_path", "snaps"):
        np.testing.assert_array_equal(getattr(again, name), getattr(trace, name))
    assert len(pickle.dumps(trace)) < 2_000_000  # a session would be larger, and cannot be sent


def test_rows_are_evenly_spaced_and_belong_together(trace: Trace) -> None:
    n = len(trace.time_s)
    assert np.diff(trace.time_s) == pytest.approx(np.full(n - 1, EVERY_S))
    for rows in ("truth", "cells", "mass", "off_m", "residual", "views", "experiences", "active"):
        assert len(getattr(trace, rows)) == n, rows
    assert (np.diff(trace.views) >= 0).all()
    assert trace.active.max() < len(trace.map.poses)
    assert (trace.mass[:, 0] >= trace.mass[:, 1]).all()
    assert trace.cells[:, :2].min() >= -0.5
    assert trace.cells[:, :2].max() <= 8
    assert trace.cells_shape[1:] == (8, 8)
    assert trace.odometry_path[0] == pytest.approx(trace.true_path[0], abs=0.1)
    assert len(trace.odometry_path) == len(trace.true_path) == len(trace.mapped_path)


def test_the_plan_is_the_office_and_the_map_lies_over_it(trace: Trace) -> None:
    assert (trace.plan.bounds, len(trace.plan.walls)) == (WORLD.bounds, len(WORLD.obstacles))
    x1, _, _, y2 = WORLD.bounds
    assert (trace.map.truth[:, 0] > x1).all()
    assert (trace.map.truth[:, 1] < y2).all()
    assert np.hypot(*(trace.map.poses - trace.map.truth)[:, :2].T).max() < 2.0
    assert trace.map.times_s[trace.map.goal] == 0.0


def test_recording_changes_nothing(watched_run: tuple[Course, Recorder]) -> None:
    assert watched_run[0].session.state_hash() == run_trial(TO_A_GOAL)[0].state_hash


def test_the_chosen_arc_is_free_costs_least_and_leads_the_way_it_then_went(
    watched_run: tuple[Course, Recorder],
) -> None:
    session, shown = watched_run[0].session, watched_run[1].movements
    assert shown is not None
    assert shown.free[shown.chosen]
    assert shown.drives[shown.chosen]
    assert shown.cost[shown.chosen] == shown.cost.min()
    assert (shown.drives & ~shown.free).any()
    chose = round(shown.time_s / session.frame.dt) - 1  # the tick at whose end it was when it chose
    here, then = session.evaluation.path[chose], session.evaluation.path[chose + 1]
    began = shown.paths[:, 0]
    assert np.abs(began - (shown.robot.x, shown.robot.y)).max() < 1e-9
    assert np.hypot(*(began - here).T).max() < 0.01
    assert np.dot(shown.paths[shown.chosen, -1] - here, then - here) > 0
    x1, y1, x2, y2 = session.world.bounds
    assert (shown.route > (x1, y1)).all()
    assert (shown.route < (x2, y2)).all()
    assert np.hypot(*(shown.route[0] - here)) < 1.0


def test_placing_points_turns_and_moves_them() -> None:
    poses = placed(np.array([[1.0, 0.0, 0.25]]), Pose2(2.0, 3.0, np.pi / 2))
    assert poses == pytest.approx(np.array([[2.0, 4.0, 0.25 + np.pi / 2]]))
