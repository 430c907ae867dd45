"""How the recogniser counts what a front end says, with a front end whose features are the image itself."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from ratslam_core import LocalView, LocalViewParams, Recognition
from ratslam_core.local_view.front_ends import FrontEnd
from ratslam_core.local_view.recogniser import MOST_SHIFT

FOV = math.radians(50)
COLUMN = FOV / 12
RAMP = 50 + 10 * np.arange(12)
SCENE = np.random.default_rng(1).integers(60, 200, 50).astype(np.uint8)
Bytes = NDArray[np.uint8]


class AsItIs(FrontEnd):
    """Two levels for each byte, at least 3 levels, recognised up to 11, surprising above 4."""

    columns, rows = 12, 1
    shifts, scale, vague = True, 2.0, 3.0

    def __init__(self, limit: float = 11.0, jump: float = 4.0) -> None:
        self.threshold, self.surprise = limit, jump

    def look(self, image: Bytes | None, _scene: int | None = None, _ranges_m: object = None, /) -> Bytes:
        assert image is not None
        return image

    def bland(self, features: Bytes, /) -> bool:
        return not features.any()

    def picture(self, features: Bytes, /) -> Bytes:
        return features

    def words(self, _features: Bytes, /) -> str:
        return ""


def even(level: float) -> Bytes:
    return np.full(12, level, np.uint8)


def seeing(params: LocalViewParams | None = None, rng: np.random.Generator | None = None, **end: float) -> LocalView:
    return LocalView(params, rng, AsItIs(**end))


def test_strength_falls_from_the_vague_to_the_threshold() -> None:
    for level, difference, strength in (
        (100, 3, 1.0),
        (101, 3, 1.0),
        (102, 4, 7 / 8),
        (97, 6, 5 / 8),
        (105.5, 10, 1 / 8),
    ):
        local_view = seeing()
        assert local_view.strength(local_view.observe(even(100))) == 1.0
        seen = local_view.observe(even(level))
        assert (seen.view, seen.recruited, seen.difference) == (0, False, difference)
        assert local_view.difference_to(0) == difference
        assert local_view.strength(seen) == pytest.approx(strength)
    assert local_view.observe(even(0)) == Recognition(-1, False, 0, 200.0)  # bland, but with a nearest view
    assert len(local_view) == 1
    only_the_same = seeing(limit=3.0)  # who only knows same or other is always sure
    only_the_same.observe(even(100))
    seen = only_the_same.observe(even(100))
    assert (seen.difference, only_the_same.strength(seen)) == (3.0, 1.0)


def test_a_view_at_the_threshold_is_recognised_and_hardly_sure() -> None:
    one = even(100)
    one[:6] = 111  # a mean difference of 5.5
    local_view = seeing(LocalViewParams(shift=0))
    local_view.observe(even(100))
    seen = local_view.observe(one)
    assert (seen.view, seen.difference, local_view.strength(seen)) == (0, 11.0, 0.0)
    one[0] += 1
    seen = local_view.observe(one)
    assert (seen.view, seen.recruited, local_view.strength(seen)) == (1, True, 1.0)


def test_a_ramp_tells_the_fraction_of_a_shift_exactly() -> None:
    for columns in (-2.4, -2.0, -1.3, -0.4, 0.0, 0.3, 1.0, 1.2, 2.3):
        local_view = seeing(LocalViewParams(shift=2), limit=99.0)
        local_view.observe(RAMP.astype(np.uint8))
        seen = local_view.observe(np.rint(RAMP - 10 * columns).astype(np.uint8))
        assert seen.facing_rad == pytest.approx(columns * COLUMN, abs=1e-9)
    blind = seeing(LocalViewParams(shift=2, facing=False), limit=99.0)
    blind.observe(RAMP.astype(np.uint8))
    seen = blind.observe(RAMP.astype(np.uint8))
    assert (seen.view, seen.recruited, seen.facing_rad) == (0, False, None)


def test_a_turn_that_the_wheels_tell_of_is_no_jump() -> None:
    """turn: by so many columns to the right; the wheels tell of none, of it, or of the opposite. They may be wrong by a
    share of it: the right turn is tried, what they tell, and what they tell give or take a share."""
    for turn, told in product((0, 1, 2, 11, -2, -3), (0, 1, -1)):
        local_view = seeing()
        local_view.observe(SCENE[20:32])
        assert local_view.image_change == 0.0
        local_view.observe(SCENE[20 + turn : 32 + turn] + np.uint8(3), turned_rad=-told * turn * COLUMN)
        if told == 1 or turn == 0:
            assert local_view.image_change == pytest.approx(2 * 3 / 4)
        else:
            assert local_view.image_change > 4
    for error, explained in ((-0.3, True), (-0.15, False), (0.3, True), (0.6, False)):
        local_view = seeing()
        local_view.observe(SCENE[20:32])
        local_view.observe(SCENE[22:34], turned_rad=-2 * COLUMN / (1 + error))
        assert (local_view.image_change < 0.1) is explained


@given(st.floats(-1.0, 1.0))
def test_a_turn_of_a_part_of_a_column_is_no_jump(columns: float) -> None:
    local_view = seeing()
    local_view.observe(RAMP.astype(np.uint8))
    local_view.observe(np.rint(RAMP - 10 * columns).astype(np.uint8), turned_rad=columns * COLUMN)
    assert local_view.image_change <= 2 * 0.5 / 4 + 1e-9  # the rounding


def test_where_nothing_can_be_compared_there_is_no_jump() -> None:
    """Wheels that slip, a turn that leaves nothing in common, no limit, and no vision."""
    slipping, turning = seeing(), seeing()
    for _ in range(3):
        slipping.observe(SCENE[:12], turned_rad=2 * COLUMN)
        assert slipping.image_change == 0.0
    turning.observe(SCENE[:12])
    turning.observe(SCENE[12:24], turned_rad=-FOV)
    assert turning.image_change == 0.0
    for jump, enabled in ((math.inf, True), (4.0, False)):
        local_view = seeing(LocalViewParams(enabled=enabled), jump=jump)
        for level in (100, 10):
            assert local_view.observe(even(level)).recruited is enabled
            assert local_view.image_change == 0.0


def test_false_positives_come_from_the_generator_handed_in_or_the_same_one_always() -> None:
    def seen(rng: np.random.Generator | None, share: float = 0.5) -> list[int]:
        local_view = seeing(LocalViewParams(false_positives=share), rng)
        return [local_view.observe(even(20 * (1 + k % 8))).view for k in range(60)]

    assert seen(None) == seen(None)
    assert seen(np.random.default_rng(1)) == seen(np.random.default_rng(1)) != seen(np.random.default_rng(2))
    undrawn = np.random.default_rng(1)
    seen(undrawn, 0.0)
    assert undrawn.bit_generator.state == np.random.default_rng(1).bit_generator.state


@given(st.integers(-9, 9), st.integers(0, 2), st.integers(0, 2**32 - 1))
def test_a_view_is_compared_under_the_turn_that_is_asked_for(shift: int, slack: int, seed: int) -> None:
    """As the sum of absolute differences over the columns that overlap says, byte by byte, echoes beside them."""
    local_view = LocalView(LocalViewParams(match_threshold=0.0, surprise=100.0))
    rng = np.random.default_rng(seed)
    for view in range(3):  # the first is seen without sonars
        local_view.observe(rng.integers(0, 256, (48, 64), np.uint8), None, rng.uniform(0.2, 4.0, 8) if view else None)
    local_view.features = rng.integers(0, 256, local_view.features.size, np.uint8)
    local_view.features[97] = 0  # and one of them hears nothing now
    apart, by = local_view.apart_at(np.array([2, 0]), np.array([shift, shift]), slack)
    asked = int(np.clip(shift, -MOST_SHIFT, MOST_SHIFT))
    tried = [s for s in range(asked - slack, asked + slack + 1) if abs(s) <= MOST_SHIFT]
    for k, view in enumerate((2, 0)):
        new, stored = (f.astype(int) for f in (local_view.features, local_view.stored(view)))
        heard = np.abs(new[96:] - stored[96:])[(new[96:] > 0) & (stored[96:] > 0)].sum() / 8
        means = [
            np.abs(new[8 * max(s, 0) : 96 - 8 * max(-s, 0)] - stored[8 * max(-s, 0) : 96 - 8 * max(s, 0)]).mean()
            for s in tried
        ]
        assert by[k] == tried[int(np.argmin(means))]
        assert apart[k] == pytest.approx(min(means) + local_view.front_end.echo_weight * heard)
