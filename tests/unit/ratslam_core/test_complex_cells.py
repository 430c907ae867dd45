"""Complex cells: oriented energy without phase or brightness."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core.local_view.front_ends.complex_cells import REACH, ComplexCells, gabor_pair

from .scenes import Image, P


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
    half = P.edge_neighbourhood // 2
    expected = np.zeros((12, 2, 4))
    for k in range(4):
        even, odd = (f.astype(np.float64) for f in gabor_pair(math.pi * k / 4))
        for y in range(36):
            for x in range(48):
                patch = mirrored[y : y + 2 * REACH + 1, x : x + 2 * REACH + 1]
                inner = patch[REACH - half : REACH + half + 1, REACH - half : REACH + half + 1]
                energy = math.hypot((patch * even).sum(), (patch * odd).sum()) / (inner.mean() + P.edge_dark)
                expected[x // 4, y // 18, k] += energy / (4 * 18)
    got = ComplexCells(P).look(image).astype(float)
    assert np.abs(got - np.clip(P.edge_gain * expected.ravel(), 0, 255)).max() <= 0.51


@pytest.mark.parametrize("k", range(4))
def test_each_complex_cell_has_its_orientation_and_no_phase(k: int) -> None:
    wavelength = 6.0
    seen = np.array([ComplexCells(P).look(grating(45 * k, p, wavelength)) for p in np.arange(0, 2 * math.pi, 0.5)])
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
    assert ComplexCells(P).look(np.full((36, 48), 200, np.uint8)).max() == 0
