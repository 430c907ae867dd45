"""What all front ends have in common."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from ratslam_core import LocalViewParams, RatSlam, RatSlamParams
from ratslam_core.local_view.front_ends import FRONT_ENDS

from .scenes import office, view_of

KINDS = ("template", "complex cells", "hue and saturation", "image and sonars", "scene numbers")
SEEING = KINDS[:4]
each_that_sees = pytest.mark.parametrize("kind", SEEING)


@each_that_sees
def test_scenes_are_recruited_and_known_again(kind: str) -> None:
    local_view = view_of(kind)
    assert all(local_view.observe(office(seed)).recruited for seed in range(6))
    for seed in range(6):
        seen = local_view.observe(office(seed))
        doubt = local_view.front_end.doubt(local_view.features)
        assert (seen.view, seen.recruited, seen.difference) == (seed, False, doubt)
        assert (seen.facing_rad is None) == (kind == "hue and saturation")


@pytest.mark.parametrize("kind", SEEING[:3])
def test_light_changes_templates_and_nothing_else(kind: str) -> None:
    for seed in range(6):
        local_view = view_of(kind)
        local_view.observe(office(seed))
        for light in (0.6, 0.8, 1.3):
            assert (local_view.observe(office(seed, light)).view == 0) == (kind != "template")


@pytest.mark.parametrize("kind", ["template", "complex cells"])
def test_the_shift_tells_the_heading(kind: str) -> None:
    column = LocalViewParams().field_of_view / 12
    for columns in (-2, 1):
        read = []
        for seed in range(12):
            local_view = view_of(kind, match_threshold=10.0)
            local_view.observe(office(seed))
            read.append(local_view.observe(office(seed, turned=round(columns * 64 / 12))).facing_rad)
        assert float(np.median(read)) == pytest.approx(columns * column, abs=0.2 * column)


@each_that_sees
def test_surprise_is_a_jump_that_no_turn_explains(kind: str) -> None:
    local_view = view_of(kind, surprise=0.5)
    before = 0
    for turned in (0, 4, 8, 4):
        local_view.observe(office(3, turned=turned), turned_rad=(turned - before) * math.radians(50) / 64)
        before = turned
        assert local_view.image_change <= 1
    for seed in range(10, 20):
        for surprised_now in (True, False):
            local_view.observe(office(seed))
            assert (local_view.image_change > 1) is surprised_now


@each_that_sees
def test_a_bare_wall_shows_nothing_to_the_front_end_that_is_ours(kind: str) -> None:
    wall = np.clip(np.random.default_rng(0).normal(128, 1, (48, 64, 3)), 0, 255).astype(np.uint8)
    local_view = view_of(kind)
    nothing = kind == "image and sonars"
    assert local_view.observe(wall).view == (-1 if nothing else 0)
    assert local_view.observe(office(0)).view == (0 if nothing else 1)


@pytest.mark.parametrize("kind", KINDS)
def test_features_are_bytes_with_a_picture_and_words(kind: str) -> None:
    end = FRONT_ENDS[kind]()
    features = end.look(office(1), 4711, None)
    assert (features.shape, features.dtype) == ((end.columns * end.rows + end.echoes,), np.uint8)
    assert len(features) == (104 if kind == "image and sonars" else 96)
    picture = end.picture(features)
    assert picture.dtype == np.uint8
    assert picture.shape[2:] == ((3,) if kind == "hue and saturation" else ())
    assert picture.max() > picture.min()
    assert len(end.words(features)) > 5


TYPE, SHAPE = "image must be an array of uint8, got ", r"image must have shape \(h, w\) or \(h, w, 3\), got "
LEAST = "image must be at least 8 x 12 pixels, got "
NO_IMAGES: list[tuple[Any, str]] = [
    (np.zeros((48, 64, 3)), TYPE + "float64"),
    (np.full((48, 64), math.nan, np.float32), TYPE + "float32"),
    ([[1, 2], [3, 4]], TYPE + "list"),
    (None, TYPE + "NoneType"),
    (np.zeros(64, np.uint8), SHAPE + r"\(64,\)"),
    (np.zeros((48, 64, 4), np.uint8), SHAPE + r"\(48, 64, 4\)"),
    (np.zeros((7, 64, 3), np.uint8), LEAST + r"\(7, 64\)"),
    (np.zeros((8, 11, 3), np.uint8), LEAST + r"\(8, 11\)"),
]


@each_that_sees
def test_what_is_no_image_is_refused(kind: str, subtests: pytest.Subtests) -> None:
    local_view = view_of(kind)
    for bad, message in NO_IMAGES:
        with subtests.test(message), pytest.raises(ValueError, match=message):
            local_view.observe(bad)
    assert len(local_view) == 0


def test_the_front_end_is_fixed_until_a_reset() -> None:
    brain = RatSlam()
    changed = RatSlamParams(local_view=LocalViewParams(front_end="complex cells"))
    with pytest.raises(ValueError, match="front_end is fixed at 'image and sonars' until a reset, got 'complex cells'"):
        brain.set_params(changed)
    with pytest.raises(ValueError, match="front_end must be one of 'template', 'complex cells'"):
        LocalViewParams(front_end="eyes")
