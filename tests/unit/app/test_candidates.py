"""The candidate movements that people may look at are those among which the robot chose."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot import PilotParams
from app.pilot.local_movement import ARC_S, LocalMovement, candidates
from app.views.office import movements_of
from ratslam_core import Odometry

from .pilots import ANGLES, STILL, USUAL
from .sessions import a_session


@pytest.mark.parametrize("seed", range(4))
def test_the_cheapest_candidate_is_the_one_that_was_chosen(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(30):
        p = PilotParams(clearance=float(rng.uniform(0.2, 0.4)), turn_rate=float(rng.uniform(0.3, 1.5)))
        local = LocalMovement(ANGLES, p.echo_s)
        for _ in range(5):
            local.sense(rng.uniform(0.2, 2.5, 8).astype(np.float32), Odometry(0.3, 0.2, 0.1))
        speed, yaw_rate = local.towards(float(rng.uniform(-1, 2)), float(rng.uniform(-1, 1)), p)
        asked = local.asked
        assert asked is not None
        found = candidates(*asked)
        assert (found.speed[found.chosen], found.yaw_rate[found.chosen]) == (speed, yaw_rate)
        assert found.cost[found.chosen] == found.cost.min() < math.inf
        assert np.array_equal(np.isfinite(found.cost[found.speed == 0]), np.ones(np.sum(found.speed == 0)))


def test_a_candidate_is_an_arc_at_its_speed_and_yaw_rate_and_blocked_where_an_echo_is_too_close() -> None:
    local = LocalMovement(np.array([0.5]), USUAL.echo_s)  # an obstacle ahead on the left
    local.sense(np.array([0.5], np.float32), STILL)
    local.towards(1.0, 0.0, USUAL)
    asked = local.asked
    assert asked is not None
    found = candidates(*asked)
    obstacle = 0.5 * np.array([math.cos(0.5), math.sin(0.5)])
    for k, path in enumerate(found.paths):
        assert path[0].tolist() == [0.0, 0.0]
        assert np.hypot(*np.diff(path, axis=0).T).sum() == pytest.approx(found.length_m[k])
        if found.speed[k] > 0:
            turned = found.turned_rad[k]
            assert turned == pytest.approx(found.yaw_rate[k] * ARC_S)
            chord = found.length_m[k] * np.sinc(turned / math.tau)
            end = chord * np.array([math.cos(turned / 2), math.sin(turned / 2)])
            assert path[-1] == pytest.approx(end, abs=2e-3)
            away = np.hypot(*(path[1:] - obstacle).T).min()
            assert np.isfinite(found.cost[k]) == (away >= USUAL.clearance)
    assert 0 < np.isinf(found.cost).sum() < len(found.cost)


def test_who_chose_no_arc_in_this_tick_shows_none() -> None:
    local = LocalMovement(ANGLES, 3)
    assert local.asked is None
    local.towards(1.0, 0.0, USUAL)
    assert local.asked is not None
    local.sense(np.full(8, 2.0, np.float32), STILL)
    assert local.asked is None
    driven = a_session(5)
    driven.pilot.drive(0.2, 0.0)
    driven.tick()
    assert movements_of(driven) is None


def test_what_was_looked_at_tells_the_same_later() -> None:
    session, kept = a_session(), []
    for _ in range(60):
        session.tick()
        if (draw := movements_of(session)) is not None:
            kept.append((draw, draw()))
    assert len(kept) > 20
    for draw, then in kept:
        now = draw()
        assert np.array_equal(now.paths, then.paths)
        assert now.chosen == then.chosen


def test_the_movements_lie_where_the_robot_is() -> None:
    session = a_session(40)
    while (draw := movements_of(session)) is None:
        session.tick()
    truth, shown = session.simulator.truth, draw()
    speed = session.odometry.speed
    assert np.hypot(*(shown.paths[:, 0] - (truth.x, truth.y)).T).max() == pytest.approx(abs(speed) * 0.1, abs=0.02)
    straight = shown.paths[int(np.flatnonzero((shown.turned_rad == 0) & shown.drives)[0])]
    ahead = straight[-1] - straight[0]
    off = math.remainder(math.atan2(ahead[1], ahead[0]) - shown.heading_rad, math.tau)
    assert abs(off) < 1e-5
    assert abs(math.remainder(shown.heading_rad - truth.heading_rad, math.tau)) < 0.15
