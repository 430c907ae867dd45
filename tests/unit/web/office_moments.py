"""What moves in a made-up office, and what the robot tries there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from web.messages import LivingLayer, Movements


def living(**changes: Any) -> LivingLayer:
    layer = LivingLayer(
        door_names=("lab", "hall"),
        doors=np.array([(2.0, 4.0, 3.0, 4.0), (8.0, 4.0, 8.0, 5.0)], np.float32),
        door_wanted=np.array([False, True]),
        door_opening=np.array([0.0, 1.0], np.float32),
        box_names=("crate",),
        boxes=np.array([(5.0, 7.0, 0.5, 0.4, 0.6, 0.3)], np.float32),
        box_rgb=np.array([(176, 137, 86)], np.uint8),
        person_names=("ann", "bob"),
        people=np.array([(1.0, 1.0, 0.0, 0.22, 1.7), (6.0, 1.0, 1.0, 0.22, 1.8)], np.float32),
        people_rgb=np.array([(86, 110, 150), (150, 60, 50)], np.uint8),
        lamp_names=("sun",),
        lamps=np.array([(5.0, 4.0, 3.0, 1.0)], np.float32),
        lamp_on=np.array([True]),
        daylight=1.0,
    )
    return replace(layer, **changes)


def tried(chosen: int = 1) -> Movements:
    """Four arcs from (5, 4): two at full speed, of which one is blocked, a slow one, and a turn on the spot."""
    ends = np.array([(0.4, 0.1), (0.4, 0.0), (0.1, 0.0), (0.0, 0.0)])
    paths = np.linspace(0, 1, 9)[None, :, None] * ends[:, None] + (5.0, 4.0)
    return Movements(
        paths.astype(np.float32),
        np.array([0.4, 0.4, 0.1, 0.0], np.float32),
        np.array([0.5, 0.0, 0.0, 0.6], np.float32),
        0.0,
        np.array([True, True, True, False]),
        np.array([False, True, True, True]),
        chosen,
    )
