"""What a snapshot holds of the map."""

from __future__ import annotations

import numpy as np
import pytest

from app.config import Config
from app.evaluation import Evaluation
from app.session import Session
from app.views.map_layers import map_layer
from ratslam_core import CellsOnly
from ratslam_core.params.presets import PRESETS
from sim2d import load_world
from web.viewer.fits.map_fit import MapFit, refit


def test_without_a_map_the_corners_hold_every_place_of_the_robot_and_little_more() -> None:
    """They only ever grow, so the plate that frames them stands still but for a step now and then."""
    session = Session(load_world("office"), 5, Config().with_values(PRESETS["paper-2004"]))
    map_, been = session.brain.experience_map, []
    before = np.zeros((2, 2))
    fit, steps = MapFit(), 0
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


def test_nobody_has_followed_it_so_there_is_the_whole_network() -> None:
    session = Session(load_world("office"), 5, Config().with_values(PRESETS["paper-2004"]))
    session.tick()
    map_ = session.brain.experience_map
    layer = map_layer(map_, Evaluation())
    assert isinstance(map_, CellsOnly)
    assert np.ptp(layer.extent_xy, axis=0) == pytest.approx(np.array(map_.shape[:0:-1]) * map_.cell_m)


def test_a_map_needs_no_corners() -> None:
    session = Session(load_world("office"), 5)
    for _ in range(50):
        session.tick()
    layer = map_layer(session.brain.experience_map, session.evaluation)
    np.testing.assert_array_equal(layer.extent_xy, layer.xy)
