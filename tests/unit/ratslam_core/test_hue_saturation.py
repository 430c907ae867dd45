"""Histograms of hue and saturation."""

from __future__ import annotations

import colorsys
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core.local_view.front_ends import papers
from ratslam_core.local_view.front_ends.papers import (
    CERTAIN_SATURATION,
    FULL_SATURATION,
    HueSaturation,
    histogram,
)  # fmt: skip

from .scenes import view_of


def literal_histogram(hue: list[float], saturation: list[float]) -> NDArray[np.float64]:
    shares = np.zeros((12, 8))
    for h, s in zip(hue, saturation, strict=True):
        level = min(s / FULL_SATURATION, 1.0) * 7
        certain = min(s / CERTAIN_SATURATION, 1.0)
        for row in range(8):
            by_level = max(0.0, 1 - abs(level - row))
            for column in range(12):
                away = abs(math.remainder(h / 30 - column, 12))
                shares[column, row] += by_level * (certain * max(0.0, 1 - away) + (1 - certain) / 12)
    return shares / len(hue)


def test_the_histogram_is_that_of_the_loops() -> None:
    rng = np.random.default_rng(2)
    hue = np.concatenate([rng.uniform(0, 360, 200), [0, 30, 359.99, 360 - 1e-3]]).astype(np.float32)
    saturation = np.concatenate([rng.uniform(0, 1, 200), [0, 0.5, 1, 0.07]]).astype(np.float32)
    got = histogram(hue, saturation, FULL_SATURATION, CERTAIN_SATURATION)
    assert got == pytest.approx(literal_histogram(hue.tolist(), saturation.tolist()), abs=1e-5)
    assert got.sum() == pytest.approx(1.0, abs=1e-6)


def test_grey_has_no_hue() -> None:
    """A grey pixel that noise makes slightly red or green counts as the same grey; a red pixel is not a green one."""

    def apart(saturation: float) -> float:
        red, green = (
            histogram(np.float32([hue]), np.float32([saturation]), FULL_SATURATION, CERTAIN_SATURATION)
            for hue in (0, 120)
        )
        return float(np.abs(red - green).sum())

    assert apart(0.0) == 0.0
    assert apart(0.01) < 0.1 * apart(0.6)
    assert apart(0.6) == pytest.approx(2.0)  # nothing in common


def test_hues_need_colour() -> None:
    message = r"image must be in colour, shape \(h, w, 3\), for hue and saturation, got \(48, 64\)"
    with pytest.raises(ValueError, match=message):
        view_of("hue and saturation").observe(np.zeros((48, 64), np.uint8))


@pytest.mark.parametrize(("hue", "saturation"), [(0, 7), (1, 5), (4, 3), (11, 1), (6, 0)])
def test_a_bin_is_shown_in_its_own_colour_and_the_largest_named(hue: int, saturation: int) -> None:
    """Hue to the right, saturation downwards; the share of the bin is the brightness."""
    features, end = np.zeros((12, 8), np.uint8), HueSaturation()
    features[hue, saturation] = 80  # is shown as 200
    assert end.words(features.ravel()) == f"mostly hue {30 * hue}° at saturation {saturation} of 7"
    features[(hue + 3) % 12, 2] = 255  # is as bright as can be
    picture = end.picture(features.ravel())
    assert picture.shape == (8, 12, 3)
    expected = np.array(colorsys.hsv_to_rgb(hue / 12, saturation / 7, 200 / 255)) * 255
    assert np.abs(picture[saturation, hue] - expected).max() <= 3
    assert picture[2, (hue + 3) % 12].max() == 255
    assert np.count_nonzero(picture.max(axis=2)) == 2


def test_features_are_shares_of_the_full_bin(monkeypatch: pytest.MonkeyPatch) -> None:
    """An image that is half red and half green: two bins with half of the pixels each."""
    image = np.zeros((24, 32, 3), np.uint8)
    image[:12, :, 0] = image[12:, :, 1] = 200
    for full, share in ((0.8, 159), (0.4, 255)):  # 255 x 0.5 / 0.8, and no more than there is
        monkeypatch.setattr(papers, "FULL_BIN", full)
        features = HueSaturation().look(image).reshape(12, 8)
        assert features[[0, 4], 7].tolist() == [share] * 2
        assert np.count_nonzero(features) == 2
