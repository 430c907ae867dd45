"""What a snapshot holds of the map."""

from __future__ import annotations

import numpy as np

from app.config import Config
from app.session import Session
from app.views.map_layers import map_layer
from ratslam_core.params.presets import PRESETS
from sim2d import load_world


def test_without_a_map_the_corners_of_the_cells_hold_every_place_of_the_robot() -> None:
    session = Session(load_world("office"), 5, Config().with_values(PRESETS["paper-2004"]))
    for _ in range(40):
        for _ in range(20):
            session.tick()
        map_ = session.brain.experience_map
        layer, at = map_layer(map_), map_.robot
        low, high = layer.extent_xy.min(0), layer.extent_xy.max(0)
        assert low[0] - 0.01 <= at.x <= high[0] + 0.01
        assert low[1] - 0.01 <= at.y <= high[1] + 0.01
    assert len(layer.xy) == 1


def test_a_map_needs_no_corners() -> None:
    session = Session(load_world("office"), 5)
    for _ in range(50):
        session.tick()
    layer = map_layer(session.brain.experience_map)
    np.testing.assert_array_equal(layer.extent_xy, layer.xy)
