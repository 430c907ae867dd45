from __future__ import annotations

import math

import numpy as np
import pytest

from sim2d.geometry import segments as geometry
from sim2d.geometry import wall_index
from sim2d.geometry.segments import free_cells, inside_ring, nearest_segment
from sim2d.geometry.wall_index import build_index
from sim2d.sensors import ranges
from tests.unit.sim2d.literal import ray_length

SQUARE = np.array([[0, 0, 4, 0], [4, 0, 4, 4], [4, 4, 0, 4], [0, 4, 0, 0]], float)
RING = SQUARE[:, :2]
NONE = np.zeros((0, 4))


@pytest.fixture(params=["compiled", "python"])
def how(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Everything is tested twice: compiled, and as Python that coverage can see."""
    if request.param == "python":
        for name in ("nearest_segment", "inside_ring", "_fill_ring", "free_cells"):
            monkeypatch.setattr(geometry, name, getattr(geometry, name).py_func)
            if name in globals():
                monkeypatch.setitem(globals(), name, getattr(geometry, name))
        for name in ("_sort_in", "crossing", "enter", "first_wall", "nearest_within", "squared_distance"):
            plain = getattr(wall_index, name).py_func
            for module in (wall_index, ranges):
                if hasattr(module, name):
                    monkeypatch.setattr(module, name, plain)
        for name in ("sonar_ranges", "laser_ranges", "_range", "within"):
            monkeypatch.setattr(ranges, name, getattr(ranges, name).py_func)
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
        got, touches = sonar(SQUARE, 1.0, 2.0, angles, 2.5, np.full(8, 0.01))
        assert got.dtype == np.float32
        assert got[[0, 7]] == pytest.approx([2.01, 2.01], abs=1e-6)
        assert got[[3, 4]].tolist() == [2.5, 2.5]  # no echo within reach, no error either
        assert not touches
        assert sonar(SQUARE, 1.0, 2.0, angles, 5.0, np.full(8, -9.0))[0].tolist() == [0.0] * 8

    def test_things_echo_and_touch_as_walls_do(self) -> None:
        thing = np.array([[1.5, 1.5, 1.5, 2.5], [3.5, 1.5, 3.5, 2.5]])
        got, touches = sonar(SQUARE, 1.0, 2.0, np.array([0.0]), 5.0, np.zeros(1), thing, touch=0.51)
        assert got[0] == pytest.approx(0.5)
        assert touches
        assert not sonar(SQUARE, 1.0, 2.0, np.array([0.0]), 5.0, np.zeros(1), thing, touch=0.49)[1]

    def test_laser(self) -> None:
        index = build_index(SQUARE)
        scan = ranges.laser_ranges(index, NONE, 1.0, 2.0, 0.0, math.pi, 2.5, np.full(5, 0.01))
        assert scan == pytest.approx([2.01, 2.5, 2.5, 2.5, 2.01], abs=1e-6)
        around = ranges.laser_ranges(index, NONE, 1.0, 2.0, 0.0, 2 * math.pi, 9.0, np.zeros(4))
        assert around == pytest.approx([1.0, 2.0, 3.0, 2.0])  # from behind, left first; no direction twice


def sonar(
    walls: np.ndarray, x: float, y: float, angles: np.ndarray, farthest: float, errors: np.ndarray,
    things: np.ndarray = NONE, touch: float = 0.1,
) -> tuple[np.ndarray, bool]:  # fmt: skip
    cone = math.radians(15)
    return ranges.sonar_ranges(build_index(walls), things, x, y, 0.0, angles, cone, 5, farthest, errors, touch)


def test_a_cone_sees_its_nearest_wall() -> None:
    """Towards a wall the middle ray is the shortest; past an edge, the nearest ray that still hits it counts."""
    post = np.array([[3.0, 0.15, 3.0, 0.3]])
    got, _ = sonar(post, 0.0, 0.0, np.array([0.0, math.radians(-30)]), 5.0, np.zeros(2))
    assert got == pytest.approx([3.0, 5.0], abs=0.03)
