"""Laws of the pose cells on random activity: agreement with a slow literal twin, mass, sign, symmetry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import PoseCellParams, PoseCells
from tests.unit.ratslam_core import literal

sizes = st.tuples(st.integers(8, 21), st.integers(8, 21), st.integers(8, 21))
EXAMPLES = settings(max_examples=40)


@st.composite
def activities(draw: st.DrawFn) -> np.ndarray:
    """Sparse activity that sums to 1: a few clusters of cells anywhere, across faces too."""
    shape = draw(sizes)
    dense = np.zeros(shape)
    for _ in range(draw(st.integers(1, 4))):
        middle = [draw(st.integers(0, n - 1)) for n in shape]
        cells = st.tuples(st.integers(-2, 2), st.integers(-2, 2), st.integers(-2, 2), st.floats(0.01, 1))
        for dt, dy, dx, value in draw(st.lists(cells, min_size=1, max_size=6)):
            at = tuple((m + d) % n for m, d, n in zip(middle, (dt, dy, dx), shape, strict=True))
            dense[at] += value
    return dense / dense.sum()


def network(dense: np.ndarray, **params: float) -> PoseCells:
    n_theta, n_y, n_x = dense.shape
    pose_cells = PoseCells(PoseCellParams(n_x=n_x, n_y=n_y, n_theta=n_theta, **params))  # type: ignore[arg-type]
    literal.fill(pose_cells, dense)
    return pose_cells


@EXAMPLES
@given(activities(), st.floats(-4, 4), st.floats(-4, 4))
def test_path_integration_is_that_of_the_papers(dense: np.ndarray, cells: float, layers: float) -> None:
    pose_cells = network(dense)
    pose_cells.integrate(cells * 0.25, layers * 2 * math.pi / dense.shape[0])
    assert np.abs(pose_cells.activity - literal.shift(dense, cells, layers)).max() < 1e-6
    assert pose_cells.activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)


@EXAMPLES
@given(activities(), st.floats(0.3, 1.5), st.sampled_from([0.0, 1e-4, 1e-3]))
def test_the_attractor_is_that_of_the_papers(dense: np.ndarray, sigma: float, phi: float) -> None:
    pose_cells = network(dense, excite_sigma=sigma, inhibit=phi)
    pose_cells.attract()
    radius = max(2, math.ceil(3 * sigma))
    expected = literal.inhibit(literal.convolve(dense, literal.gaussian(sigma, radius)), phi)
    assert np.abs(pose_cells.activity - expected).max() < 2e-6


@EXAMPLES
@given(activities(), st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=8))
def test_activity_is_a_distribution_whatever_happens(dense: np.ndarray, drives: list[tuple[float, float]]) -> None:
    pose_cells = network(dense)
    for speed, yaw_rate in drives:
        pose_cells.step(speed=speed, yaw_rate=yaw_rate, dt=0.1)
        activity = pose_cells.activity
        assert activity.min() >= 0
        assert activity.sum(dtype=np.float64) == pytest.approx(1.0, abs=1e-6)
        winner = pose_cells.winner
        assert 0 <= winner.x < dense.shape[2]
        assert 0 <= winner.y < dense.shape[1]
        assert -math.pi < winner.heading_rad <= math.pi
        assert sum(p.mass for p in pose_cells.packets) <= 1 + 1e-5
