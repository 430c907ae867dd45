from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import LocalView, Recognition
from ratslam_core.local_view.front_ends.template import Template, grey_template

from .scenes import view_of

Image = NDArray[np.uint8]
FOV = math.radians(50)


def templates(**params: Any) -> LocalView:
    """With the papers' front end: what is seen is 12 x 8 grey levels, and nothing else counts."""
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
    """Least mean absolute difference over the columns that overlap, its view and its shift, by loops."""
    best = (math.inf, -1, 0)
    for view, old in enumerate(known):
        for shift in range(-most, most + 1):
            total = count = 0
            for column in range(12):
                if 0 <= column - shift < 12:
                    for row in range(8):
                        total += abs(int(new[row, column]) - int(old[row, column - shift]))
                        count += 1
            best = min(best, (total / count, view, shift), key=lambda b: b[0])
    return best


@pytest.mark.parametrize("most", [0, 1, 2, 5])
@pytest.mark.slow
def test_matching_is_the_least_sum_of_absolute_differences(most: int) -> None:
    rng = np.random.default_rng(most)
    scenes = [panorama(seed) for seed in range(12)]
    local_view = templates(shift=most, match_threshold=0.0)
    known: list[Image] = []
    for _ in range(60):
        new = look(scenes[rng.integers(12)], float(rng.uniform(5, 40)))
        expected, view, _ = literal_match(new, known, most)
        got = local_view.observe(new)
        assert got.difference == pytest.approx(expected, rel=1e-6)
        if known:
            again, _, _ = literal_match(new, [known[got.best_view]], most)
            assert again == pytest.approx(expected, rel=1e-6)
            if expected > 0:
                assert got.best_view == view
        if got.recruited:
            known.append(new)
    assert len(known) == len(local_view) > 50


def test_a_new_scene_recruits_a_cell_and_is_known_from_then_on() -> None:
    local_view = templates()
    first = local_view.observe(image(1))
    assert first == Recognition(view=0, recruited=True, best_view=-1, difference=math.inf)
    second = local_view.observe(image(2))
    assert (second.view, second.recruited, second.best_view) == (1, True, 0)
    assert second.difference > local_view.threshold
    again = local_view.observe(image(1))
    assert again == Recognition(view=0, recruited=False, best_view=0, difference=0.0, facing_rad=0.0)
    assert len(local_view) == 2
    for view in (0, 1):
        assert np.array_equal(local_view.front_end.picture(local_view.stored(view)), image(view + 1))


def test_the_threshold_decides() -> None:
    base = image(4)
    brighter = (base.astype(int) + 6).clip(0, 255).astype(np.uint8)
    for threshold, recruited in ((1.0, False), (0.98, True)):
        local_view = templates(match_threshold=threshold, shift=0)
        local_view.observe(base)
        assert local_view.observe(brighter).recruited is recruited


def test_thousands_of_views_are_all_kept() -> None:
    rng = np.random.default_rng(0)
    local_view = templates(shift=0)
    images = rng.integers(0, 255, (2500, 8, 12)).astype(np.uint8)
    for number, one in enumerate(images):
        assert local_view.observe(one).view == number
    for number in (0, 1023, 1024, 2048, 2499):
        assert local_view.observe(images[number]).view == number
    assert len(local_view) == 2500


@pytest.mark.parametrize("columns", [-2.0, -1.4, -1.0, -0.5, 0.0, 0.3, 1.0, 1.6, 2.0])
def test_the_shift_of_the_image_tells_the_heading(columns: float) -> None:
    """When the robot turns left, everything in the image moves to the right: it looks at columns further left."""
    wrong = []
    for seed in range(20):
        scene = panorama(seed)
        local_view = templates(match_threshold=7.0)
        local_view.observe(look(scene, 20))
        seen = local_view.observe(look(scene, 20 - columns))
        assert seen.view == 0
        wrong.append(seen.facing_rad - columns * FOV / 12)
    column = FOV / 12
    assert abs(float(np.median(wrong))) < 0.15 * column
    assert np.abs(wrong).max() < 0.5 * column


def test_without_shifts_nothing_is_known_of_the_heading() -> None:
    local_view = templates(shift=0, match_threshold=10.0)
    local_view.observe(look(panorama(1), 20))
    seen = local_view.observe(look(panorama(1), 19))
    assert (seen.view, seen.facing_rad) == (0, 0.0)


def test_a_scene_without_an_edge_tells_no_fraction_of_a_shift() -> None:
    """A scene of stripes along the rows fits equally well at all shifts."""
    stripes = np.repeat(np.linspace(0, 250, 8).astype(np.uint8)[:, None], 12, axis=1)
    local_view = templates()
    local_view.observe(stripes)
    seen = local_view.observe(stripes)
    assert (seen.view, seen.difference) == (0, 0.0)
    assert abs(seen.facing_rad) <= 2 * FOV / 12


def test_surprised_by_what_no_turn_explains() -> None:
    scene = panorama(7)
    local_view = templates()
    local_view.observe(look(scene, 20))
    assert local_view.image_change <= 1
    before = 20
    for column in (23, 20, 19, 14):
        local_view.observe(look(scene, column), turned_rad=(before - column) * FOV / 12)
        assert local_view.image_change <= 1
        before = column
    elsewhere = look(panorama(8), 20)
    local_view.observe(elsewhere)
    assert local_view.image_change > 1
    local_view.observe(elsewhere)
    assert local_view.image_change <= 1


@pytest.mark.parametrize("jump", [-7, 6, 9])
def test_surprise_is_a_matter_of_degree(jump: int) -> None:
    scene = panorama(7)
    change, _, _ = literal_match(look(scene, 20 + jump), [look(scene, 20)], 0)
    for limit, surprised in ((change - 0.01, True), (change + 0.01, False)):
        local_view = templates(surprise=limit / Template.surprise)
        local_view.observe(look(scene, 20))
        local_view.observe(look(scene, 20 + jump))
        assert (local_view.image_change > 1) is surprised


def test_with_no_limit_left_every_change_is_a_surprise() -> None:
    scene = panorama(7)
    local_view = templates(surprise=0.0)
    found = []
    for column in (20, 20, 40):
        local_view.observe(look(scene, column))
        found.append(local_view.image_change)
    assert found == [0.0, 0.0, math.inf]


def test_a_camera_image_becomes_the_mean_of_its_areas() -> None:
    rng = np.random.default_rng(0)
    grey = rng.integers(0, 256, (48, 60)).astype(np.uint8)
    means = grey.reshape(8, 6, 12, 5).mean((1, 3))
    assert np.abs(grey_template(grey) - means).max() <= 0.5 + 1e-6
    rgb = rng.integers(0, 256, (48, 60, 3)).astype(np.uint8)
    luminance = (rgb @ np.array([0.299, 0.587, 0.114])).reshape(8, 6, 12, 5).mean((1, 3))
    template = grey_template(rgb)
    assert np.abs(template - luminance).max() < 1.0
    assert (template.shape, template.dtype) == ((8, 12), np.uint8)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (np.zeros((48, 64)), "image must be an array of uint8, got float64"),
        (np.full((48, 64), math.nan, np.float32), "image must be an array of uint8, got float32"),
        ([[1, 2], [3, 4]], "image must be an array of uint8, got list"),
        (None, "image must be an array of uint8, got NoneType"),
        (np.zeros(64, np.uint8), r"image must have shape \(h, w\) or \(h, w, 3\), got \(64,\)"),
        (np.zeros((48, 64, 4), np.uint8), r"image must have shape \(h, w\) or \(h, w, 3\), got \(48, 64, 4\)"),
        (np.zeros((7, 64), np.uint8), r"image must be at least 8 x 12 pixels, got \(7, 64\)"),
        (np.zeros((8, 11), np.uint8), r"image must be at least 8 x 12 pixels, got \(8, 11\)"),
    ],
)
def test_what_is_not_an_image_is_refused(bad: object, message: str) -> None:
    local_view = templates()
    with pytest.raises(ValueError, match=message):
        local_view.observe(bad)  # type: ignore[arg-type]
    assert len(local_view) == 0


@pytest.mark.parametrize("view", [-1, 1])
def test_only_known_views_are_stored(view: int) -> None:
    local_view = templates()
    local_view.observe(image(1))
    with pytest.raises(ValueError, match=f"view must be from 0 to 0, got {view}"):
        local_view.stored(view)


@pytest.mark.parametrize("shift", [0, 2])
def test_the_difference_to_a_view_is_that_of_the_recognition(shift: int) -> None:
    local_view = templates(shift=shift)
    rng = np.random.default_rng(3)
    for _ in range(12):
        seen = local_view.observe(rng.integers(0, 256, (8, 12), np.uint8))
        if seen.best_view >= 0:
            assert local_view.difference_to(seen.best_view) == pytest.approx(seen.difference)
    assert local_view.difference_to(len(local_view) - 1) == 0
    with pytest.raises(ValueError, match="view must be from 0 to"):
        local_view.difference_to(len(local_view))
