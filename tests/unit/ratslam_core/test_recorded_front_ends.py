"""The front ends for recordings: limited levels for real cameras, and a laser's scan."""

from __future__ import annotations

import numpy as np
import pytest

from ratslam_core.local_view.front_ends.laser import LASER_COLUMNS, Laser
from ratslam_core.local_view.front_ends.limited_levels import LimitedLevels
from ratslam_core.local_view.recogniser import LocalView
from ratslam_core.params import LocalViewParams


def _scene(seed: int = 0) -> np.ndarray:
    small = np.random.default_rng(seed).integers(60, 140, (8, 12), np.uint8)
    return np.repeat(np.repeat(small, 6, axis=0), 5, axis=1)


def _apart(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a.astype(float) - b.astype(float)).mean())


def test_a_lamp_counts_no_more_than_a_wall() -> None:
    end, dark = LimitedLevels(), _scene()
    lamp = dark.copy()
    lamp[0:6, 0:5] = 255
    brighter = dark.copy()
    brighter[0:6, 0:5] = 200
    assert _apart(end.look(dark), end.look(lamp)) < 1.5 * _apart(end.look(dark), end.look(brighter)) + 0.5
    assert np.all(np.abs(end.look(lamp).astype(int) - 128) <= 40)


def test_most_of_the_light_is_taken_off() -> None:
    end, scene = LimitedLevels(), _scene()
    assert _apart(end.look(scene), end.look((scene * 1.4).astype(np.uint8))) < 8


def test_a_bland_picture_shows_nothing() -> None:
    view = LocalView(LocalViewParams(front_end="limited levels"))
    assert view.observe(np.full((48, 64), 99, np.uint8)).view == -1
    assert view.observe(_scene()).recruited


def test_a_turn_shifts_the_view() -> None:
    """A robot that turns left sees the same walls farther to the right, and its facing says by how much."""
    end = Laser()
    ranges = 2 + np.sin(np.arange(240) / 9.0) + np.random.default_rng(1).uniform(0, 2, 60).repeat(4)
    view = LocalView(LocalViewParams(front_end="laser", field_of_view=np.pi, shift=5))
    here, left = ranges[30:210], ranges[39:219]  # beams from right to left; 9 degrees to the left
    assert view.observe(None, None, here).recruited
    seen = view.observe(None, None, left)
    assert seen.view == 0
    assert seen.facing_rad == pytest.approx(np.radians(9), abs=np.radians(1))
    assert len(end.look(None, None, here)) == LASER_COLUMNS


def test_a_laser_needs_ranges() -> None:
    with pytest.raises(ValueError, match="ranges_m must be given"):
        Laser().look(None)


def test_an_empty_hall_shows_nothing() -> None:
    view = LocalView(LocalViewParams(front_end="laser"))
    assert view.observe(None, None, np.full(180, np.inf)).view == -1
