"""Complex cells: oriented energy without phase or brightness."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core.local_view.front_ends.complex_cells import (
    AROUND,
    DARK,
    GAIN,
    REACH,
    ComplexCells,
    gabor_pair,
)

from .scenes import Image


def grating(across_deg: float, phase: float, wavelength: float = 6.0) -> Image:
    """Stripes, (36, 48): 100 grey and 15 to either side; `across_deg` is the direction across them."""
    y, x = np.mgrid[0:36, 0:48]
    a = math.radians(across_deg)
    waves = np.cos(2 * math.pi / wavelength * (x * math.cos(a) + y * math.sin(a)) + phase)
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


@pytest.mark.parametrize("k", range(4))
def test_each_complex_cell_has_its_orientation_and_no_phase(k: int) -> None:
    wavelength = 6.0
    seen = np.array([ComplexCells().look(grating(45 * k, p, wavelength)) for p in np.arange(0, 2 * math.pi, 0.5)])
    energy = seen.reshape(len(seen), 12, 2, 4).astype(float)[:, 2:-2]  # away from the borders
    mine = energy[..., k]
    others = np.delete(energy, k, axis=-1)
    assert mine.min() > 4 * others.max()
    assert mine.std(axis=0).max() < 0.05 * mine.mean()


def test_gabor_pairs_are_blind_to_brightness() -> None:
    for k in range(4):
        even, odd = gabor_pair(math.pi * k / 4)
        assert abs(even.sum()) < 1e-6 > abs(odd.sum())
        assert (even**2).sum() == pytest.approx((odd**2).sum(), rel=1e-5)
    assert ComplexCells().look(np.full((36, 48), 200, np.uint8)).max() == 0


@pytest.mark.parametrize("k", range(4))
def test_a_gabor_filter_is_a_wave_under_a_bell(k: int) -> None:
    """A wave of 6 pixels across the edge under a Gaussian of 2.4 pixels; the even one is freed of its mean in the same shape."""
    bell, wave = np.zeros((11, 11)), np.zeros((11, 11), complex)
    for y in range(-5, 6):
        for x in range(-5, 6):
            across = x * math.cos(math.pi * k / 4) + y * math.sin(math.pi * k / 4)
            bell[y + 5, x + 5] = math.exp(-0.5 * (x * x + y * y) / 2.4**2)
            angle = 2 * math.pi * across / 6
            wave[y + 5, x + 5] = bell[y + 5, x + 5] * complex(math.cos(angle), math.sin(angle))
    even, odd = gabor_pair(math.pi * k / 4)
    assert even.shape == odd.shape == (11, 11)
    assert even.dtype == odd.dtype == np.float32
    expected = wave.real - bell * wave.real.sum() / bell.sum()
    for got, form in ((even, expected), (odd, wave.imag)):
        assert got == pytest.approx(form / math.sqrt((form**2).sum() * bell.sum()), abs=1e-6)


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
    for step in range(-4, 5):
        y, x = 4 + step * along[0], 4 + step * along[1]
        assert place[y, x] == (200 if abs(step) <= reach else 0)
    assert np.array_equal(place, place[::-1, ::-1])
    away = np.abs(np.arange(-4, 5)[:, None] * along[1] - np.arange(-4, 5)[None, :] * along[0]) / math.hypot(*along)
    assert (place[away > 1.2] == 0).all()
    beside = place[4 + along[1], 4 - along[0]]  # 1 away from the middle of the bar, or 1.4
    assert beside == pytest.approx(40 if k % 2 == 0 else 0, abs=1)


def test_the_brightest_of_several_edges_shows() -> None:
    features = np.zeros((12, 2, 4), np.uint8)
    features[0, 0] = 100, 0, 255, 0
    place = ComplexCells().picture(features.ravel())[:9, :9]
    assert place[4].tolist() == [255] * 9
    assert place[[0, 1, 7, 8], 4].tolist() == [100] * 4
