"""A trace is the same run as the trial, in plain arrays."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from app.trials.code_version import code_version
from app.trials.final_map import placed
from app.trials.steps import Explore, Kidnap, Tag, Visit
from app.trials.trace import EVERY_S, Recorder, trace_of
from app.trials.trial import Trial, run_trial, text_of, watched
from ratslam_core import Pose2
from sim2d.importers import open_world

pytestmark = pytest.mark.slow

PROTOCOL = (
    Tag(do="tag", places=["kitchen"]),
    Explore(do="explore", minutes=0.5),
    Kidnap(do="kidnap", turn_deg=120),
    Explore(do="explore", minutes=0.3),
    Visit(do="visit", places=["kitchen"], timeout_s=2),
)
MADE = Trial(
    "made", "ours", (), 3, "office", text_of(open_world("office")), {"pose_cells.n_x": 8, "pose_cells.n_y": 8}, PROTOCOL,
    ("packets",), code_version(),
)  # fmt: skip


@pytest.fixture(scope="module")
def trace():
    return trace_of(MADE)


def test_a_trace_is_the_run_of_its_trial(trace):
    result, course = run_trial(MADE)
    map_ = course.session.brain.experience_map
    assert len(trace.map.poses) == result.scores["experiences"]
    assert len(trace.map.links) == result.scores["links"]
    assert len(trace.snaps) == result.scores["snaps"]
    np.testing.assert_array_equal(trace.map.poses, placed(map_.poses, trace.map.in_office))
    assert trace.moments == tuple(course.moments)
    assert trace.visits == tuple(course.visits)
    assert [kidnap.after_s for kidnap in trace.kidnaps] == [k.after_s for k in course.session.evaluation.kidnaps]
    off = np.linalg.norm(trace.mapped_path - trace.true_path, axis=1)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(result.scores["error_m"], rel=0.1)


def test_a_trace_goes_from_one_process_to_another(trace):
    again = pickle.loads(pickle.dumps(trace))
    assert again.trial == trace.trial
    for name in ("time_s", "truth", "cells", "mass", "true_path", "mapped_path", "odometry_path", "snaps"):
        np.testing.assert_array_equal(getattr(again, name), getattr(trace, name))
    assert len(pickle.dumps(trace)) < 2_000_000  # a session would be larger, and cannot be sent


def test_rows_are_evenly_spaced_and_belong_together(trace):
    n = len(trace.time_s)
    assert np.diff(trace.time_s) == pytest.approx(np.full(n - 1, EVERY_S))
    for rows in (
        trace.truth,
        trace.cells,
        trace.mass,
        trace.off_m,
        trace.residual,
        trace.views,
        trace.experiences,
        trace.active,
    ):
        assert len(rows) == n
    assert (np.diff(trace.views) >= 0).all()
    assert trace.active.max() < len(trace.map.poses)
    assert (trace.mass[:, 0] >= trace.mass[:, 1]).all()
    assert trace.cells[:, :2].min() >= -0.5
    assert trace.cells[:, :2].max() <= 8
    assert trace.cells_shape[1:] == (8, 8)


def test_paths_begin_where_the_robot_began(trace):
    assert trace.odometry_path[0] == pytest.approx(trace.true_path[0], abs=0.1)
    assert len(trace.odometry_path) == len(trace.true_path) == len(trace.mapped_path)


def test_the_plan_is_the_office_and_the_map_lies_over_it(trace):
    world = open_world("office")
    assert trace.plan.bounds == world.bounds
    assert len(trace.plan.walls) == len(world.obstacles)
    x1, y1, x2, y2 = world.bounds
    assert (trace.map.truth[:, 0] > x1).all()
    assert (trace.map.truth[:, 1] < y2).all()
    assert np.hypot(*(trace.map.poses - trace.map.truth)[:, :2].T).max() < 2.0
    assert trace.map.times_s[trace.map.goal] == 0.0
    assert (x2 - x1, y2 - y1) == (10.0, 8.0)


# ------------------------------------------------------------ the choice among arcs

TO_A_GOAL = replace(
    MADE,
    seed=5,
    protocol=(
        Tag(do="tag", places=["printer"]),
        Explore(do="explore", minutes=4),
        Visit(do="visit", places=["printer"], timeout_s=60),
    ),
)


@pytest.fixture(scope="module")
def watched_run():
    """A course that went to its goals, and its recorder."""
    course = TO_A_GOAL.begin()
    recorder = Recorder(course)
    watched(course, [recorder])
    return course, recorder


def test_recording_changes_nothing(watched_run):
    course, _ = watched_run
    assert course.session.state_hash() == run_trial(TO_A_GOAL)[0].state_hash


def test_the_chosen_arc_is_free_and_no_arc_costs_less(watched_run):
    shown = watched_run[1].movements
    assert shown.free[shown.chosen]
    assert shown.drives[shown.chosen]
    assert shown.cost[shown.chosen] == shown.cost.min()
    assert (shown.drives & ~shown.free).any()


def test_arcs_begin_where_the_robot_truly_was_and_lead_the_way_it_then_went(watched_run):
    course, recorder = watched_run
    shown, session = recorder.movements, course.session
    chose = round(shown.time_s / session.frame.dt) - 1  # the tick at whose end it was when it chose
    here, then = session.evaluation.path[chose], session.evaluation.path[chose + 1]
    began = shown.paths[:, 0]
    assert np.abs(began - (shown.robot.x, shown.robot.y)).max() < 1e-9
    assert np.hypot(*(began - here).T).max() < 0.01
    ahead = shown.paths[shown.chosen, -1] - here
    assert np.dot(ahead, then - here) > 0
    x1, y1, x2, y2 = session.world.bounds
    assert (shown.route > (x1, y1)).all()
    assert (shown.route < (x2, y2)).all()
    assert np.hypot(*(shown.route[0] - here)) < 1.0


def test_who_never_follows_a_route_has_no_movements(trace):
    assert trace.movements is None


def test_what_only_looks_on_is_no_part_of_the_version():
    from app.trials import code_version as module

    assert {"figure_options.py", "final_map.py", "trace.py"} == module._LOOKS_ON


def test_placing_points_turns_and_moves_them():
    poses = placed(np.array([[1.0, 0.0, 0.25]]), Pose2(2.0, 3.0, np.pi / 2))
    assert poses == pytest.approx(np.array([[2.0, 4.0, 0.25 + np.pi / 2]]))
