"""With the papers' front end: what is seen is 12 x 8 grey levels, and nothing else counts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import LocalView, Recognition
from ratslam_core.local_view.front_ends.front_end import grey_template
from ratslam_core.local_view.front_ends.papers import Template

from .scenes import Image, view_of

FOV = math.radians(50)
COLUMN = FOV / 12


def templates(**params: Any) -> LocalView:
    return view_of("template", **params)


def panorama(seed: int, columns: int = 60) -> NDArray[np.float64]:
    """A smooth, varied scene much wider than one view, shape (8, columns)."""
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(20, 235, (8, columns // 3 + 2))
    at = np.arange(columns) / 3
    left = at.astype(int)
    return coarse[:, left] * (1 - at + left) + coarse[:, left + 1] * (at - left)


def look(scene: NDArray[np.float64], column: float) -> Image:
    """The 12 columns from this one on; columns count to the right."""
    left = math.floor(column)
    part = column - left
    seen = scene[:, left : left + 12] * (1 - part) + scene[:, left + 1 : left + 13] * part
    return np.round(seen).astype(np.uint8)


def image(seed: int) -> Image:
    return look(panorama(seed), 20)


def literal_match(new: Image, known: list[Image], most: int) -> tuple[float, int, int]:
    """Least mean absolute difference over the columns that overlap, its view and its shift."""
    best = (math.inf, -1, 0)
    for view, old in enumerate(known):
        for shift in range(-most, most + 1):
            both = [column for column in range(12) if 0 <= column - shift < 12]
            mean = float(np.mean([np.abs(new[:, c].astype(int) - old[:, c - shift]) for c in both]))
            best = min(best, (mean, view, shift), key=lambda b: b[0])
    return best


@pytest.mark.slow
def test_matching_is_the_least_sum_of_absolute_differences(subtests: pytest.Subtests) -> None:
    for most in (0, 1, 5):
        with subtests.test(most=most):
            rng = np.random.default_rng(most)
            scenes = [panorama(seed) for seed in range(12)]
            local_view, known = templates(shift=most, match_threshold=0.0), list[Image]()
            for _ in range(40):
                new = look(scenes[rng.integers(12)], float(rng.uniform(5, 40)))
                expected, view, _ = literal_match(new, known, most)
                got = local_view.observe(new)
                assert got.difference == pytest.approx(expected, rel=1e-6)
                if known:
                    assert literal_match(new, [known[got.best_view]], most)[0] == pytest.approx(expected, rel=1e-6)
                    assert got.best_view == view or expected == 0
                    assert local_view.difference_to(got.best_view) == pytest.approx(got.difference)
                if got.recruited:
                    known.append(new)
                    assert local_view.difference_to(len(known) - 1) == 0
            assert len(known) == len(local_view) > 30


def test_a_new_scene_recruits_a_cell_and_is_known_from_then_on() -> None:
    local_view = templates()
    assert local_view.observe(image(1)) == Recognition(view=0, recruited=True, best_view=-1, difference=math.inf)
    second = local_view.observe(image(2))
    assert (second.view, second.recruited, second.best_view) == (1, True, 0)
    assert second.difference > local_view.threshold
    again = local_view.observe(image(1))
    assert again == Recognition(view=0, recruited=False, best_view=0, difference=0.0, facing_rad=0.0)
    assert len(local_view) == 2
    for view in (0, 1):
        assert np.array_equal(local_view.front_end.picture(local_view.stored(view)), image(view + 1))
    for view in (-1, 2):
        for ask in (local_view.stored, local_view.difference_to):
            with pytest.raises(ValueError, match=f"view must be from 0 to 1, got {view}"):
                ask(view)


def test_the_threshold_decides() -> None:
    base = image(4)
    brighter = (base.astype(int) + 6).clip(0, 255).astype(np.uint8)
    for threshold, recruited in ((1.0, False), (0.98, True)):
        local_view = templates(match_threshold=threshold, shift=0)
        local_view.observe(base)
        assert local_view.observe(brighter).recruited is recruited


def test_the_shift_of_the_image_tells_the_heading(subtests: pytest.Subtests) -> None:
    """When the robot turns left, everything in the image moves to the right: it looks at columns further left."""
    for columns in (-2.0, -1.4, -0.5, 0.0, 0.3, 1.0, 1.6, 2.0):
        with subtests.test(columns=columns):
            wrong = []
            for seed in range(20):
                local_view = templates(match_threshold=7.0)
                local_view.observe(look(panorama(seed), 20))
                seen = local_view.observe(look(panorama(seed), 20 - columns))
                assert seen.view == 0
                wrong.append(seen.facing_rad - columns * COLUMN)
            assert abs(float(np.median(wrong))) < 0.15 * COLUMN
            assert np.abs(wrong).max() < 0.5 * COLUMN


def test_without_shifts_or_edges_nothing_is_known_of_the_heading() -> None:
    """A scene of stripes along the rows fits equally well at all shifts."""
    local_view = templates(shift=0, match_threshold=10.0)
    local_view.observe(look(panorama(1), 20))
    seen = local_view.observe(look(panorama(1), 19))
    assert (seen.view, seen.facing_rad) == (0, 0.0)
    stripes = np.repeat(np.linspace(0, 250, 8).astype(np.uint8)[:, None], 12, axis=1)
    local_view = templates()
    local_view.observe(stripes)
    seen = local_view.observe(stripes)
    assert (seen.view, seen.difference) == (0, 0.0)
    assert abs(seen.facing_rad) <= 2 * COLUMN


def test_surprise_is_a_matter_of_degree() -> None:
    """With no limit left every change is a surprise."""
    scene = panorama(7)
    for jump in (-7, 6, 9):
        change, _, _ = literal_match(look(scene, 20 + jump), [look(scene, 20)], 0)
        for limit, surprised in ((change - 0.01, True), (change + 0.01, False)):
            local_view = templates(surprise=limit / Template.surprise)
            local_view.observe(look(scene, 20))
            local_view.observe(look(scene, 20 + jump))
            assert (local_view.image_change > 1) is surprised
    local_view, found = templates(surprise=0.0), []
    for column in (20, 20, 40):
        local_view.observe(look(scene, column))
        found.append(local_view.image_change)
    assert found == [0.0, 0.0, math.inf]


def test_a_camera_image_becomes_the_mean_of_its_areas() -> None:
    rgb = np.random.default_rng(0).integers(0, 256, (48, 60, 3)).astype(np.uint8)
    for picture, light, least in ((rgb[..., 0], rgb[..., 0], 0.5), (rgb, rgb @ np.array([0.299, 0.587, 0.114]), 1.0)):
        template = grey_template(picture)
        assert np.abs(template - light.reshape(8, 6, 12, 5).mean((1, 3))).max() <= least + 1e-6
        assert (template.shape, template.dtype) == ((8, 12), np.uint8)
