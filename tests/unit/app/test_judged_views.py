"""What people alone are shown: the wheels' ghost is the integrated odometry, the outline lies by the fit of the map error, and
the ellipse of doubt is the filter's or the packet's."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.config import Config
from app.evaluation import alignment, rmse
from app.views.belief import packet_spread, spread_of
from app.views.history import History
from app.views.office import ghost_of
from ratslam_core import Pose2
from web.messages import Pose
from web.viewer.fits import compose, into_map, placed

from .sessions import a_session

TICKS = 150


def shown(pose: Pose2) -> Pose:
    return Pose(pose.x, pose.y, pose.heading_rad)


def left_after(frame: Pose, mapped: np.ndarray, truth: np.ndarray) -> float:
    """The error that remains when this frame lays the map into the office, m."""
    return math.sqrt(np.mean(np.square(placed(mapped, frame) - truth).sum(1)))


def test_the_ghost_is_the_integrated_odometry_from_the_start_pose() -> None:
    session = a_session()
    truth = session.truth
    assert truth is not None
    start = ghost = Pose2(truth.x, truth.y, truth.heading_rad)
    way = []
    for tick in range(TICKS):
        if tick == 100:
            session.kidnap(8.0, 1.0, 0.0)  # the wheels do not notice
        session.tick()
        step, turn = session.odometry.speed * session.odometry.dt, session.odometry.yaw_rate * session.odometry.dt
        ghost = ghost.compose(Pose2(step * math.cos(turn / 2), step * math.sin(turn / 2), turn))
        way.append((ghost.x, ghost.y))
    seen = ghost_of(session)
    assert seen is not None
    assert (seen.office_start.x, seen.office_start.y) == (start.x, start.y)
    office = compose(seen.office_start, seen.pose)
    assert (office.x, office.y) == pytest.approx((ghost.x, ghost.y), abs=1e-9)
    assert math.remainder(office.heading_rad - ghost.heading_rad, math.tau) == pytest.approx(0.0, abs=1e-9)
    path = placed(np.asarray(seen.path, np.float64), seen.office_start)
    away = np.hypot(*(path[:, None] - np.array([(start.x, start.y), *way])[None]).transpose(2, 0, 1)).min(1)
    assert away.max() < 1e-5
    assert path[-1] == pytest.approx(way[-1], abs=1e-5)


def test_the_outline_is_laid_by_the_fit_of_the_map_error_and_the_snapshot_shows_it() -> None:
    session = a_session(seed=5)
    history, evaluation, map_ = History(session), session.evaluation, session.brain.experience_map
    for _ in range(300):
        session.tick()
        history.watch()
        if session.tick_count % 10 == 0:  # a sample was taken in this tick
            truth, mapped, _ = evaluation.trajectories(map_)
            fit = history.series.map_in_office
            assert fit is not None
            if math.sqrt(np.var(truth, axis=0).sum()) >= 0.5:
                assert left_after(shown(fit), mapped, truth) == pytest.approx(history.series.error_map_m, rel=1e-9)
    for every in (1, 3):
        truth, mapped, _ = evaluation.trajectories(map_, every)
        left = left_after(shown(evaluation.map_in_office(map_, every)), mapped, truth)
        assert left == pytest.approx(evaluation.errors(map_, every)[0], rel=1e-12)


seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=60)
@given(seeds, st.integers(3, 80), st.floats(-9, 9), st.floats(-9, 9), st.floats(-3.1, 3.1))
def test_after_the_fit_what_remains_is_the_error(seed: int, n: int, x: float, y: float, turn: float) -> None:
    """For any two paths, the frame that lays one over the other leaves exactly the error that is told; and the way from the
    office into the map is its inverse."""
    rng = np.random.default_rng(seed)
    truth = np.cumsum(rng.uniform(-1, 1, (n, 2)), axis=0)
    estimate = placed(truth + rng.normal(0, 0.2, truth.shape), Pose(x, y, turn))
    frame = shown(alignment(estimate, truth))
    assert left_after(frame, estimate, truth) == pytest.approx(rmse(estimate, truth), rel=1e-9, abs=1e-12)
    assert into_map(placed(estimate, frame), frame) == pytest.approx(estimate, abs=1e-8)


def test_doubt_is_the_filters_sigma_and_by_the_papers_rules_the_packets_spread() -> None:
    """The packet's beside a literal sum over the cells of its activity, over the edge of the torus or not."""
    session = a_session(TICKS)
    seen, sigma = spread_of(session), session.brain.experience_map.pose_filter.sigma_m
    assert seen is not None
    assert (seen.along_m, seen.across_m, seen.by) == (sigma, sigma, "filter")
    first, ghost = session.brain.experience_map.poses[0], ghost_of(session)
    assert ghost is not None
    assert (ghost.map_start.x, ghost.map_start.y) == pytest.approx(first[:2].tolist(), abs=0.2), "where it began"

    session = a_session(TICKS, config=Config().with_value("experience_map.anchor_sigma", 0.0))
    seen, cell_m = packet_spread(session), session.config.pose_cells.cell_m
    assert spread_of(session) == seen
    assert seen.by == "packet"
    assert 0 < seen.across_m <= seen.along_m < 6 * cell_m
    cells, values = session.brain.pose_cells.active
    packet, (_, n_y, n_x) = session.brain.pose_cells.winner, session.brain.pose_cells.shape
    rows = [
        (math.remainder(x - packet.x, n_x), math.remainder(y - packet.y, n_y), float(v))
        for (x, y), v in zip(cells[:, :2].tolist(), values.tolist(), strict=True)
    ]
    rows = [row for row in rows if math.hypot(*row[:2]) <= 6]
    mass = sum(v for *_, v in rows)
    mean = [sum(row[k] * row[2] for row in rows) / mass for k in (0, 1)]
    trace = sum(((x - mean[0]) ** 2 + (y - mean[1]) ** 2) * v for x, y, v in rows) / mass
    assert seen.along_m**2 + seen.across_m**2 == pytest.approx(trace * cell_m**2, rel=1e-6)
