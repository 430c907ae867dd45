"""The map on its plate: the corners that frame it, and its turn, which follows the office whether anybody looks or not."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.config import Config
from app.evaluation import Evaluation, alignment
from app.views.arrays import CALM_RAD, calm
from app.views.history import History
from app.views.map_layers import map_layer
from app.views.snapshots import Snapshots
from ratslam_core import CellsOnly
from ratslam_core.params.presets import PRESETS
from web.viewer.fits import MapFit, refit

from .sessions import a_session

ANGLES = st.floats(-math.pi, math.pi)
WITHOUT_A_MAP = Config().with_values(PRESETS["paper-2004"])


def test_without_a_map_the_corners_hold_every_place_of_the_robot_and_little_more() -> None:
    """They only ever grow, so the plate that frames them stands still but for a step now and then."""
    session = a_session(1, seed=5, config=WITHOUT_A_MAP)
    map_ = session.brain.experience_map
    been, before, fit, steps = [(map_.robot.x, map_.robot.y)], np.zeros((2, 2)), MapFit(), 0
    assert isinstance(map_, CellsOnly)
    whole = np.array(map_.shape[:0:-1]) * map_.cell_m
    layer = map_layer(map_, Evaluation())
    assert np.ptp(layer.extent_xy, axis=0) == pytest.approx(whole), "nobody has followed it"
    for _ in range(40):
        for _ in range(20):
            session.tick()
            been.append((map_.robot.x, map_.robot.y))
        layer = map_layer(map_, session.evaluation)
        corners = layer.extent_xy.min(0), layer.extent_xy.max(0)
        np.testing.assert_allclose(corners, (np.min([(0, 0), *been], 0), np.max([(0, 0), *been], 0)), atol=0.05)
        assert (corners[0] <= before[0] + 1e-6).all()
        assert (corners[1] >= before[1] - 1e-6).all()
        before = np.array(corners)
        after = refit(fit, layer.extent_xy, 0.3)
        fit, steps = after, steps + (after is not fit)
    assert len(layer.xy) == 1
    assert np.ptp(fit.to_plate(layer.extent_xy), axis=0).max() > 4  # of 10 x 8
    assert steps < 8


@pytest.mark.parametrize("seed", [5, 9])
def test_a_session_that_nobody_watched_is_shown_as_the_office_lies(seed: int) -> None:
    session = a_session(seed=seed)
    history, map_ = History(session), session.brain.experience_map
    turns = [history.series.map_turn_rad]
    for _ in range(410):
        session.tick()
        history.watch()
        turns.append(history.series.map_turn_rad)
    shown = Snapshots(session, history, 1, ()).build(running=True, speed=1.0, real_time_factor=1.0, fault=None)
    true, mapped, _ = session.evaluation.trajectories(map_)
    assert apart(shown.map_turn_rad, alignment(mapped, true).heading_rad) <= CALM_RAD + 0.02
    assert sum(a != b for a, b in pairwise(turns)) <= 6  # it nearly always stands still
    layer = map_layer(map_, session.evaluation)
    np.testing.assert_array_equal(layer.extent_xy, layer.xy, "a map needs no corners")


def apart(a: float, b: float) -> float:
    return abs(math.remainder(a - b, math.tau))


@given(ANGLES, ANGLES)
def test_what_is_shown_is_never_far_from_what_is_wanted(shown: float, wanted: float) -> None:
    assert apart(calm(shown, wanted), wanted) <= CALM_RAD + 1e-9
    assert calm(None, wanted) == pytest.approx(math.remainder(wanted, math.tau))


@given(ANGLES, st.lists(st.floats(-0.49, 0.49), min_size=1, max_size=20))
def test_what_trembles_within_the_limit_turns_once_at_most(middle: float, trembles: list[float]) -> None:
    shown, seen = middle + math.pi / 2, set()
    for tremble in trembles:
        shown = calm(shown, middle + tremble * CALM_RAD)
        seen.add(shown)
    assert len(seen) == 1
