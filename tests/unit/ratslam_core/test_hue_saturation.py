"""Histograms of hue and saturation."""

from __future__ import annotations

import colorsys
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core.local_view.front_ends.hue_saturation import HueSaturation, histogram

from .scenes import P, view_of


def literal_histogram(hue: list[float], saturation: list[float]) -> NDArray[np.float64]:
    shares = np.zeros((12, 8))
    for h, s in zip(hue, saturation, strict=True):
        level = min(s / P.full_saturation, 1.0) * 7
        certain = min(s / P.certain_saturation, 1.0)
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
    got = histogram(hue, saturation, P.full_saturation, P.certain_saturation)
    assert got == pytest.approx(literal_histogram(hue.tolist(), saturation.tolist()), abs=1e-5)
    assert got.sum() == pytest.approx(1.0, abs=1e-6)


def test_grey_has_no_hue() -> None:
    """A grey pixel that noise makes slightly red or green counts as the same grey; a red pixel is not a green one."""

    def apart(saturation: float) -> float:
        red, green = (
            histogram(np.float32([hue]), np.float32([saturation]), P.full_saturation, P.certain_saturation)
            for hue in (0, 120)
        )
        return float(np.abs(red - green).sum())

    assert apart(0.0) == 0.0
    assert apart(0.01) < 0.1 * apart(0.6)
    assert apart(0.6) == pytest.approx(2.0)  # nothing in common


@pytest.mark.parametrize("hue", [0.0, 0.2, 0.55, 0.99])
def test_the_picture_shows_the_hue_where_it_is(hue: float) -> None:
    rgb = np.rint(255 * np.array(colorsys.hsv_to_rgb(hue, 0.45, 0.8))).astype(np.uint8)
    end = HueSaturation(P)
    picture = end.picture(end.look(np.tile(rgb, (48, 64, 1)))).astype(int)
    row, column = np.unravel_index(int(picture.sum(2).argmax()), picture.shape[:2])
    assert abs(math.remainder(column - 12 * hue, 12)) <= 1
    assert row >= 5


def test_hues_need_colour() -> None:
    with pytest.raises(
        ValueError, match=r"image must be in colour, shape \(h, w, 3\), for hue and saturation, got \(48, 64\)"
    ):
        view_of("hue and saturation").observe(np.zeros((48, 64), np.uint8))
