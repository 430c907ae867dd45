"""Levels in even light, and echoes."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import LocalView, LocalViewParams, Odometry, RatSlam, RatSlamParams
from ratslam_core.local_view.front_ends.front_end import grey_template
from ratslam_core.local_view.front_ends.image_and_sonars import (
    DARK,
    DEAF_DOUBT,
    ECHO_WEIGHT,
    EVEN,
    LEVELS,
    PLAIN_DOUBT,
    SILENT_DOUBT,
    ImageAndSonars,
    along_rows,
)  # fmt: skip

from .scenes import office, view_of

KIND = "image and sonars"
P = LocalViewParams(front_end=KIND)
NEAR, FAR = np.full(8, 0.7), np.full(8, 9.0)


def features(image: np.ndarray, ranges: np.ndarray | None = None) -> np.ndarray:
    return ImageAndSonars().look(image, None, ranges)


@settings(max_examples=20)
@given(st.integers(0, 999))
def test_levels_are_logarithms_less_a_share_of_their_columns_mean(seed: int) -> None:
    grey = grey_template(office(seed)).astype(float)
    logs = 90 * np.log(grey + DARK)
    expected = 128 + logs - EVEN * logs.mean(axis=0) - (1 - EVEN) * 90 * math.log(128 + DARK)
    got = features(office(seed))[:96].reshape(12, 8).T
    assert np.abs(got - np.clip(expected, 0, 255)).max() <= 0.51


def test_light_is_mostly_taken_off() -> None:
    """It changes the levels by less than half as much as it changes logarithms of which nothing is taken off."""
    for seed, light in product(range(6), (0.6, 0.8, 1.3)):
        taken = np.abs(features(office(seed, light)) - features(office(seed)) * 1.0)[:96].mean()
        left = np.abs(LEVELS[grey_template(office(seed, light))] - LEVELS[grey_template(office(seed))]).mean()
        assert taken < 0.5 * left


def test_sonars_tell_aliased_places_apart() -> None:
    """Without them the picture alone counts. They change no image: the kidnap detector counts them by itself."""
    local_view = view_of(KIND)
    assert local_view.observe(office(1), None, NEAR).view == 0
    assert local_view.observe(office(1), None, NEAR + 0.02).view == 0
    seen = local_view.observe(office(1), None, 3 * NEAR)
    assert (seen.view, seen.recruited, local_view.image_change) == (1, True, 0.0)
    seen = local_view.observe(office(1))
    assert (seen.view, seen.recruited) == (0, False)
    assert local_view.observe(office(2)).recruited
    assert local_view.observe(office(1), None, NEAR).difference == pytest.approx(0.0, abs=PLAIN_DOUBT)


def test_any_number_of_sonars_is_heard() -> None:
    """Of more than eight the nearest of each group counts; of fewer, those that there are."""
    for count in (1, 3, 8, 11, 16, 180):
        heard = features(office(1), np.linspace(0.5, 3.0, count))[96:].astype(int)
        assert np.count_nonzero(heard) == min(count, 8)
        assert (np.diff(heard[: min(count, 8)]) > 0).all()
        assert heard[0] == round(1 + 254 * math.log(0.5 / 0.2) / math.log(4.0 / 0.2))


def test_what_tells_little_is_doubted() -> None:
    """Floor and ceiling alone, and sonars without an echo, look and sound alike everywhere."""
    bands = np.repeat(np.linspace(40, 160, 48), 64).reshape(48, 64).astype(np.uint8)
    end = ImageAndSonars()
    hall, empty = end.look(bands, None, FAR), end.look(bands, None, None)
    assert along_rows(hall) < 1
    assert end.bland(hall)
    assert not end.bland(end.look(office(1), None, FAR))
    assert end.doubt(hall) == pytest.approx(PLAIN_DOUBT + SILENT_DOUBT, abs=0.5)
    assert end.doubt(empty) == pytest.approx(PLAIN_DOUBT + DEAF_DOUBT, abs=0.5)
    assert end.doubt(end.look(office(1), None, NEAR)) < end.doubt(end.look(office(1), None, FAR))
    checks = np.where(np.indices((8, 12)).sum(axis=0) % 2, 20, 220).astype(np.uint8)
    assert end.doubt(end.look(checks, None, NEAR)) == 0.0


def test_doubt_and_echoes_are_parts_of_the_difference() -> None:
    sure, unsure = view_of(KIND), view_of(KIND)
    for local_view, ranges in ((sure, NEAR), (unsure, FAR)):
        local_view.observe(office(1), None, ranges)
        local_view.observe(office(1), None, ranges)
    assert unsure.recognition.difference == pytest.approx(sure.recognition.difference + SILENT_DOUBT)
    assert unsure.difference_to(0) == unsure.recognition.difference
    assert unsure.strength(unsure.recognition) < sure.strength(sure.recognition)
    near, far = features(office(1), NEAR), features(office(1), FAR)
    expected = ECHO_WEIGHT * np.abs(far[96:] * 1.0 - near[96:]).mean() + ImageAndSonars().doubt(far)
    assert sure.observe(office(1), None, FAR).difference == pytest.approx(expected)


def test_the_picture_has_a_strip_of_echoes() -> None:
    end = ImageAndSonars()
    near_left = end.look(office(1), None, np.array([0.3, 4, 4, 4, 4, 4, 4, 4]))
    picture = end.picture(near_left)
    assert picture.shape == (9, 12)
    assert picture[8, 0] > 200
    assert not picture[8, 2:].any()
    assert "and 1 echoes" in end.words(near_left)
    assert not end.picture(end.look(office(1)))[8].any()


def test_the_ranges_of_a_step_reach_the_local_view() -> None:
    brain = RatSlam(RatSlamParams(local_view=P), sonar_angles_rad=np.linspace(-1, 1, 8).tolist())
    for ranges in (NEAR, 4 * NEAR):
        brain.step(office(1), Odometry(0.0, 0.0, 0.1), ranges_m=ranges)
    assert len(brain.local_view) == 2
    deaf = LocalView(P)
    assert [deaf.observe(office(1)).view for _ in range(2)] == [0, 0]
