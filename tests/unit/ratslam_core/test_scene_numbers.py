"""Scene numbers instead of images: each is a view of its own, and may be taken for another on purpose."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import LocalView, LocalViewParams, Odometry, RatSlam, RatSlamParams
from ratslam_core.local_view.front_ends.papers import SceneNumbers

from .scenes import office, view_of

LARGEST = 2**63 - 1


def test_every_number_is_one_cell() -> None:
    local_view = view_of("scene numbers")
    numbers = [0, 255, 256, LARGEST, 7, np.int64(65536)]
    for view, scene in enumerate(numbers):
        seen = local_view.observe(None, scene)  # type: ignore[arg-type]
        assert (seen.view, seen.recruited) == (view, True)
    for view, scene in reversed(list(enumerate(numbers))):
        seen = local_view.observe(office(view), scene)  # type: ignore[arg-type]
        assert (seen.view, seen.recruited, seen.best_view, seen.facing_rad) == (view, False, view, None)
        assert local_view.image_change <= 1
    assert len(local_view) == len(numbers)
    assert local_view.front_end.words(local_view.stored(3)) == f"scene {LARGEST}"


def test_what_is_no_scene_number_is_refused() -> None:
    brain = RatSlam(RatSlamParams(local_view=LocalViewParams(front_end="scene numbers")))
    before = brain.digest()
    for scene in (None, -1, 2**63, 1.0, True, "3", math.nan):
        with pytest.raises(
            ValueError, match=f"scene must be a whole number from 0 to {LARGEST} for scene numbers, got"
        ):
            brain.step(None, Odometry(0.1, 0.0, 0.1), scene=scene)  # type: ignore[arg-type]
        assert brain.digest() == before


def test_thousands_of_views_are_all_kept_and_take_no_more_than_150_bytes_each() -> None:
    local_view = view_of("scene numbers")
    for scene in range(4000):
        local_view.observe(None, scene)
        assert local_view.memory_bytes <= max(150 * (scene + 1), 1024 * 96)
    for scene in (0, 1023, 1024, 2048, 3999):
        assert local_view.observe(None, scene).view == scene
    assert len(local_view) == 4000


@pytest.mark.parametrize("scene", [0, 42, 1234567, LARGEST])
def test_the_digits_stand_in_the_middle_of_a_card(scene: int) -> None:
    """Two thirds as high as it is wide, or as high as the digits need; all around them there is paper."""
    end = SceneNumbers()
    picture = end.picture(end.look(None, scene))
    assert picture.max() > 200
    high, wide = picture.shape
    assert high == pytest.approx(max(36, 2 * wide / 3), abs=4)
    rows, columns = (np.flatnonzero((picture != picture[0, 0]).any(axis=1 - axis)) for axis in (0, 1))
    assert 0 < rows[0] == pytest.approx(high - 1 - rows[-1], abs=6)
    assert rows[-1] < high - 1
    for margin in (columns[0], wide - 1 - columns[-1]):
        assert 3 <= margin <= 7


# ---------------------------------------------------------------- false positives


def numbers_seen(share: float, ticks: int, known: int = 20) -> tuple[LocalView, list[tuple[int, int, bool]]]:
    local_view = LocalView(LocalViewParams(front_end="scene numbers", false_positives=share), np.random.default_rng(3))
    seen = []
    for tick in range(ticks):
        one = local_view.observe(None, tick % known)
        seen.append((tick % known, one.view, one.false_positive))
        assert not (one.false_positive and (one.view == one.best_view or one.recruited or one.facing_rad is not None))
        assert one.recruited or one.best_view == tick % known
    return local_view, seen


def test_so_many_recognised_views_are_taken_for_another() -> None:
    for share in (0.0, 0.02, 0.1, 1.0):
        local_view, seen = numbers_seen(share, 8020)
        wrong = [(right, view) for right, view, false in seen if false]
        assert all(false == (right != view) for right, view, false in seen)
        expected = share * 8000
        assert (
            local_view.false_positives
            == len(wrong)
            == pytest.approx(expected, abs=4 * math.sqrt(expected * (1 - share)))
        )
    others = np.bincount([view for right, view in wrong if right == 4], minlength=20)  # where all are taken for another
    assert others[4] == 0
    assert np.delete(others, 4).min() > 5  # any other one
    local_view, seen = numbers_seen(1.0, 5, known=1)  # a single known view cannot be taken for another
    assert local_view.false_positives == 0
    assert {view for _, view, _ in seen} == {0}


def test_false_positives_draw_from_a_generator_of_their_own() -> None:
    """Another share does not change the run's own generator; the digest covers the draws."""
    brains = []
    for share in (0.0, 0.5):
        params = RatSlamParams(local_view=LocalViewParams(front_end="scene numbers", false_positives=share))
        brains.append(RatSlam(params, np.random.default_rng(9)))
        for tick in range(50):
            brains[-1].step(None, Odometry(0.1, 0.0, 0.1), scene=tick % 5)
    without, often = brains
    assert without.rng.bit_generator.state == often.rng.bit_generator.state
    assert often.local_view.false_positives > 5
    before = often.digest()
    often.local_view.rng.random()
    assert often.digest() != before
    assert replace(often.params, local_view=without.params.local_view) == without.params
