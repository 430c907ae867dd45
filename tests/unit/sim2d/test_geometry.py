from __future__ import annotations

import math

import numpy as np
import pytest

from sim2d import geometry, ranges
from sim2d.geometry import free_cells, inside_ring, nearest_segment, ray_length

SQUARE = np.array([[0, 0, 4, 0], [4, 0, 4, 4], [4, 4, 0, 4], [0, 4, 0, 0]], float)
RING = SQUARE[:, :2]


@pytest.fixture(params=["compiled", "python"])
def how(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Everything twice: compiled, and as the Python that coverage can see."""
    if request.param == "python":
        for name in ("nearest_segment", "ray_length", "inside_ring", "_fill_ring", "free_cells"):
            monkeypatch.setattr(geometry, name, getattr(geometry, name).py_func)
            if name in globals():
                monkeypatch.setitem(globals(), name, getattr(geometry, name))
        monkeypatch.setattr(ranges, "ray_length", geometry.ray_length)
        monkeypatch.setattr(ranges, "sonar_ranges", ranges.sonar_ranges.py_func)
    return request.param


@pytest.mark.usefixtures("how")
class TestGeometry:
    def test_nearest(self) -> None:
        assert nearest_segment(SQUARE, 1.0, 2.0) == (3, 1.0)
        assert nearest_segment(SQUARE, 3.0, 3.5) == (2, 0.5)
        assert nearest_segment(SQUARE, 7.0, 8.0) == (1, 5.0)  # beyond an end: to the corner

    def test_ray(self) -> None:
        assert ray_length(SQUARE, 1.0, 1.0, 0.0, 99.0) == pytest.approx(3.0)
        assert ray_length(SQUARE, 1.0, 1.0, math.pi / 4, 99.0) == pytest.approx(3 * math.sqrt(2))
        assert ray_length(SQUARE, 1.0, 1.0, 0.0, 2.0) == 2.0
        assert ray_length(SQUARE, 9.0, 1.0, 0.0, 5.0) == 5.0
        edge_on = np.array([[2.0, 1.0, 3.0, 1.0]])
        assert ray_length(edge_on, 1.0, 1.0, 0.0, 9.0) == 9.0

    def test_inside(self) -> None:
        assert inside_ring(RING, 1.0, 1.0)
        assert not any(inside_ring(RING, x, y) for x, y in [(-1.0, 1.0), (5.0, 1.0), (1.0, 5.0), (1.0, -1.0)])

    def test_free_cells(self) -> None:
        slant = np.array([[1.0, 1.0, 3.0, 2.0]])
        xs, ys = np.arange(-0.9, 5.0, 0.2), np.arange(-0.9, 5.0, 0.2)
        segments = np.concatenate([SQUARE, slant])
        free = free_cells(segments, RING, xs, ys, 0.22)
        slow = [[inside_ring(RING, x, y) and nearest_segment(segments, x, y)[1] >= 0.22 for x in xs] for y in ys]
        assert free.tolist() == slow
        assert free.any()
        assert not free.all()

    def test_sonar(self) -> None:
        angles = np.array(ranges.SONAR_ANGLES_RAD)
        got = ranges.sonar_ranges(SQUARE, 1.0, 2.0, 0.0, angles, 2.5, np.full(8, 0.01))
        assert got.dtype == np.float32
        assert got[[0, 7]] == pytest.approx([2.01, 2.01], abs=1e-6)
        assert got[[3, 4]].tolist() == [2.5, 2.5]  # no echo within reach, no error either
        assert ranges.sonar_ranges(SQUARE, 1.0, 2.0, 0.0, angles, 5.0, np.full(8, -9.0)).tolist() == [0.0] * 8


def test_a_cone_sees_its_nearest_wall() -> None:
    """Towards a wall the middle ray is shortest; past an edge, whichever ray still hits it."""
    post = np.array([[3.0, 0.15, 3.0, 0.3]])
    angles = np.array([0.0, math.radians(-30)])
    assert ranges.sonar_ranges(post, 0.0, 0.0, 0.0, angles, 5.0, np.zeros(2))[0] == pytest.approx(3.0, abs=0.03)
    assert ranges.sonar_ranges(post, 0.0, 0.0, 0.0, angles, 5.0, np.zeros(2))[1] == 5.0
