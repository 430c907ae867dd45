"""Complex cells: oriented energy without phase or brightness."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core.local_view.front_ends.papers import AROUND, DARK, GAIN, REACH, ComplexCells, gabor_pair

from .scenes import Image


def grating(across_deg: float, phase: float) -> Image:
    """Stripes, (36, 48): 100 grey and 15 to either side; `across_deg` is the direction across them."""
    y, x = np.mgrid[0:36, 0:48]
    a = math.radians(across_deg)
    waves = np.cos(2 * math.pi / 6 * (x * math.cos(a) + y * math.sin(a)) + phase)
    return np.rint(100 + 15 * waves).astype(np.uint8)


def test_complex_cells_are_the_energy_of_quadrature_pairs_by_loops() -> None:
    """Convolution, energy, division by the brightness around and means of areas, pixel by pixel; borders are mirrored."""
    image = np.random.default_rng(1).integers(0, 256, (36, 48)).astype(np.uint8)
    grey = image.astype(np.float64)
    mirrored = np.pad(grey, REACH, mode="symmetric")
    half = AROUND // 2
    expected = np.zeros((12, 2, 4))
    for k in range(4):
        even, odd = (f.astype(np.float64) for f in gabor_pair(math.pi * k / 4))
        for y in range(36):
            for x in range(48):
                patch = mirrored[y : y + 2 * REACH + 1, x : x + 2 * REACH + 1]
                inner = patch[REACH - half : REACH + half + 1, REACH - half : REACH + half + 1]
                energy = math.hypot((patch * even).sum(), (patch * odd).sum()) / (inner.mean() + DARK)
                expected[x // 4, y // 18, k] += energy / (4 * 18)
    got = ComplexCells().look(image).astype(float)
    assert np.abs(got - np.clip(GAIN * expected.ravel(), 0, 255)).max() <= 0.51


def test_each_complex_cell_has_its_orientation_and_no_phase() -> None:
    for k in range(4):
        seen = np.array([ComplexCells().look(grating(45 * k, phase)) for phase in np.arange(0, 2 * math.pi, 0.5)])
        energy = seen.reshape(len(seen), 12, 2, 4).astype(float)[:, 2:-2]  # away from the borders
        mine, others = energy[..., k], np.delete(energy, k, axis=-1)
        assert mine.min() > 4 * others.max()
        assert mine.std(axis=0).max() < 0.05 * mine.mean()


def test_a_gabor_filter_is_a_wave_under_a_bell() -> None:
    """A wave of 6 pixels across the edge under a Gaussian of 2.4 pixels; the even one is freed of its mean in the same
    shape, so that a bright wall shows nothing."""
    y, x = np.mgrid[-5:6, -5:6]
    bell = np.exp(-0.5 * (x * x + y * y) / 2.4**2)
    for k in range(4):
        across = x * math.cos(math.pi * k / 4) + y * math.sin(math.pi * k / 4)
        wave = bell * np.exp(2j * math.pi * across / 6)
        even, odd = gabor_pair(math.pi * k / 4)
        assert even.dtype == odd.dtype == np.float32
        for got, form in ((even, wave.real - bell * wave.real.sum() / bell.sum()), (odd, wave.imag)):
            assert got == pytest.approx(form / math.sqrt((form**2).sum() * bell.sum()), abs=1e-6)
    assert ComplexCells().look(np.full((36, 48), 200, np.uint8)).max() == 0


@pytest.mark.parametrize(("k", "along"), [(0, (1, 0)), (1, (1, -1)), (2, (0, 1)), (3, (1, 1))])
def test_the_picture_has_a_bar_along_the_edges_of_each_place(k: int, along: tuple[int, int]) -> None:
    """Orientation 0 is across to the right, so its edge goes up and down. Bars end before the corners of their place."""
    features = np.zeros((12, 2, 4), np.uint8)
    features[7, 1, k] = 200
    picture = ComplexCells().picture(features.ravel())
    assert picture.shape == (18, 108)
    place = picture[9:18, 63:72].copy()
    assert place.sum(dtype=int) == picture.sum(dtype=int)
    reach = 4 if k % 2 == 0 else 2
    bar = [place[4 + step * along[0], 4 + step * along[1]] for step in range(-4, 5)]
    assert bar == [200 * (abs(step) <= reach) for step in range(-4, 5)]
    assert np.array_equal(place, place[::-1, ::-1])
    away = np.abs(np.arange(-4, 5)[:, None] * along[1] - np.arange(-4, 5)[None, :] * along[0]) / math.hypot(*along)
    assert (place[away > 1.2] == 0).all()
    beside = place[4 + along[1], 4 - along[0]]  # 1 away from the middle of the bar, or 1.4
    assert beside == pytest.approx(40 if k % 2 == 0 else 0, abs=1)
    features[7, 1] = 100, 0, 255, 0  # the brightest of several edges shows
    place = ComplexCells().picture(features.ravel())[9:18, 63:72]
    assert place[4].tolist() == [255] * 9
    assert place[[0, 1, 7, 8], 4].tolist() == [100] * 4
