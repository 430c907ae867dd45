"""The front ends for recordings: limited levels for real cameras, and a laser's scan."""

from __future__ import annotations

import numpy as np
import pytest

from ratslam_core.local_view.front_ends.image_and_sonars import LimitedLevels
from ratslam_core.local_view.front_ends.laser import LASER_COLUMNS, Laser

from .scenes import view_of


def test_a_lamp_counts_no_more_than_a_wall() -> None:
    """And most of an even light is taken off."""
    small = np.random.default_rng(0).integers(60, 140, (8, 12), np.uint8)
    dark, look = np.repeat(np.repeat(small, 6, axis=0), 5, axis=1), LimitedLevels().look
    lamp, brighter = dark.copy(), dark.copy()
    lamp[0:6, 0:5], brighter[0:6, 0:5] = 255, 200

    def apart(scene: np.ndarray) -> float:
        return float(np.abs(look(dark).astype(float) - look(scene).astype(float)).mean())

    assert apart(lamp) < 1.5 * apart(brighter) + 0.5
    assert np.all(np.abs(look(lamp).astype(int) - 128) <= 40)
    assert apart((dark * 1.4).astype(np.uint8)) < 8
    view = view_of("limited levels")
    assert view.observe(np.full((48, 64), 99, np.uint8)).view == -1  # a bland picture shows nothing
    assert view.observe(dark).recruited


def test_a_turn_shifts_the_view() -> None:
    """A robot that turns left sees the same walls farther to the right, and its facing says by how much."""
    ranges = 2 + np.sin(np.arange(240) / 9.0) + np.random.default_rng(1).uniform(0, 2, 60).repeat(4)
    view = view_of("laser", field_of_view=np.pi, shift=5)
    here, left = ranges[30:210], ranges[39:219]  # beams from right to left; 9 degrees to the left
    assert view.observe(None, None, here).recruited
    seen = view.observe(None, None, left)
    assert seen.view == 0
    assert seen.facing_rad == pytest.approx(np.radians(9), abs=np.radians(1))
    assert len(Laser().look(None, None, here)) == LASER_COLUMNS
    assert view.observe(None, None, np.full(180, np.inf)).view == -1  # an empty hall shows nothing
    with pytest.raises(ValueError, match="ranges_m must be given"):
        Laser().look(None)
