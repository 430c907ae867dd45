"""Scene numbers instead of images: each is a view of its own."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from ratslam_core import LocalViewParams, Odometry, RatSlam, RatSlamParams
from ratslam_core.local_view.front_ends.scene_numbers import SceneNumbers

from .scenes import office, view_of


def test_every_number_is_one_cell() -> None:
    local_view = view_of("scene numbers")
    numbers = [0, 255, 256, 2**63 - 1, 7, np.int64(65536)]
    for view, scene in enumerate(numbers):
        seen = local_view.observe(None, scene)  # type: ignore[arg-type]
        assert (seen.view, seen.recruited) == (view, True)
    for view, scene in reversed(list(enumerate(numbers))):
        seen = local_view.observe(office(view), scene)  # type: ignore[arg-type]
        assert (seen.view, seen.recruited, seen.best_view, seen.facing_rad) == (view, False, view, None)
        assert local_view.image_change <= 1
    assert len(local_view) == len(numbers)
    assert local_view.front_end.words(local_view.stored(3)) == f"scene {2**63 - 1}"


@pytest.mark.parametrize("scene", [None, -1, 2**63, 1.0, True, "3", math.nan])
def test_what_is_no_scene_number_is_refused(scene: Any) -> None:
    brain = RatSlam(RatSlamParams(local_view=LocalViewParams(front_end="scene numbers")))
    before = brain.digest()
    with pytest.raises(ValueError, match=f"scene must be a whole number from 0 to {2**63 - 1} for scene numbers, got"):
        brain.step(None, Odometry(0.1, 0.0, 0.1), scene=scene)
    assert brain.digest() == before


def test_a_view_takes_no_more_than_150_bytes() -> None:
    local_view = view_of("scene numbers")
    for scene in range(4000):
        local_view.observe(None, scene)
        assert local_view.memory_bytes <= max(150 * (scene + 1), 1024 * 96)


@pytest.mark.parametrize("scene", [0, 7, 1234567, 2**63 - 1])
def test_a_scene_number_is_drawn_whole(scene: int) -> None:
    """All around the digits there is paper."""
    end = SceneNumbers()
    picture = end.picture(end.look(None, scene))
    assert picture.max() > 200
    for edge in (picture[0], picture[-1], picture[:, 0], picture[:, -1]):
        assert (edge == picture[0, 0]).all()


@pytest.mark.parametrize("scene", [0, 42, 1234567, 2**63 - 1])
def test_the_digits_stand_in_the_middle_of_a_card(scene: int) -> None:
    """Two thirds as high as it is wide, or as high as the digits need."""
    end = SceneNumbers()
    picture = end.picture(end.look(None, scene))
    high, wide = picture.shape
    assert high == pytest.approx(max(36, 2 * wide / 3), abs=4)
    rows, columns = (np.flatnonzero((picture != picture[0, 0]).any(axis=1 - axis)) for axis in (0, 1))
    assert rows[0] == pytest.approx(high - 1 - rows[-1], abs=6)
    for margin in (columns[0], wide - 1 - columns[-1]):
        assert 3 <= margin <= 7
