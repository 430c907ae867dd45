"""The compiled camera against a ray caster written straight from the picture, one ray and one wall at a time."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sim2d.column_hits import MAX_HITS, NEAR_M, column_hits
from sim2d.geometry import nearest_segment, ray_length

FOCAL = 30.0
WIDTH = 24
coordinate = st.floats(-6, 6).map(lambda v: round(v, 3))
segment = st.tuples(coordinate, coordinate, coordinate, coordinate).filter(lambda s: math.dist(s[:2], s[2:]) > 0.05)
segments = st.lists(segment, min_size=1, max_size=12).map(np.array)
heading = st.floats(-math.pi, math.pi).map(lambda v: round(v, 9))  # none so small that dividing by it overflows


def literal_crossings(walls: np.ndarray, x: float, y: float, dx: float, dy: float) -> list[tuple[float, int, float]]:
    """(distance in units of (dx, dy), wall, fraction of its length) of every wall on the ray, near to far."""
    found = []
    for i, (x1, y1, x2, y2) in enumerate(walls):
        matrix = np.array([[dx, x1 - x2], [dy, y1 - y2]])
        if abs(np.linalg.det(matrix)) < 1e-12:
            continue
        t, u = np.linalg.solve(matrix, [x1 - x, y1 - y])
        if t > 0 and 0 <= u <= 1:
            found.append((float(t), i, float(u)))
    return sorted(found)


@given(segments, heading, st.data())
@settings(max_examples=80, deadline=None)
def test_columns_meet_the_walls_that_rays_meet(walls: np.ndarray, angle: float, data: st.DataObject) -> None:
    assume(nearest_segment(walls, 0.0, 0.0)[1] > 2 * NEAR_M)
    full = np.array(data.draw(st.lists(st.booleans(), min_size=len(walls), max_size=len(walls))))
    counts, strips = np.zeros(WIDTH, np.int64), np.zeros((WIDTH, MAX_HITS), np.int64)
    hits = np.zeros((WIDTH, MAX_HITS, 3))
    column_hits(walls, full, 0.0, 0.0, angle, FOCAL, counts, strips, hits)
    for c in range(WIDTH):
        left = (0.5 * WIDTH - c - 0.5) / FOCAL
        dx, dy = math.cos(angle) - left * math.sin(angle), math.sin(angle) + left * math.cos(angle)
        expected = [hit for hit in literal_crossings(walls, 0.0, 0.0, dx, dy) if hit[0] > NEAR_M]
        # Rays through a wall's end, or where two walls cross, may be decided either way.
        if any(min(u, 1 - u) < 1e-6 for _, _, u in expected):
            continue
        if any(b[0] - a[0] < 1e-6 for a, b in pairwise(expected)):
            continue
        stop = next((k + 1 for k, (_, i, _) in enumerate(expected) if full[i]), len(expected))
        expected = expected[: min(stop, MAX_HITS)]
        assert (strips[c, : counts[c]] >> 1).tolist() == [i for _, i, _ in expected]
        for k, (t, i, u) in enumerate(expected):
            inverse, u0, u1 = hits[c, k]
            assert math.isclose(1.0 / inverse, t, rel_tol=1e-6)
            assert -1e-9 <= u0 <= u + 1e-9
            assert u - 1e-9 <= u1 <= 1 + 1e-9
            x1, y1, x2, y2 = walls[i]
            assert strips[c, k] % 2 == (0 if (x2 - x1) * -y1 + (y2 - y1) * x1 > 0 else 1)


@given(segments, coordinate, coordinate, heading, st.floats(0.1, 20))
@settings(max_examples=120, deadline=None)
def test_a_ray_never_passes_a_wall(walls: np.ndarray, x: float, y: float, angle: float, farthest: float) -> None:
    length = ray_length(walls, x, y, angle, farthest)
    assert 0 <= length <= farthest
    crossings = [c for c in literal_crossings(walls, x, y, math.cos(angle), math.sin(angle)) if 1e-6 < c[2] < 1 - 1e-6]
    if crossings:
        assert length <= crossings[0][0] + 1e-6
    if length < farthest:
        assert nearest_segment(walls, x + length * math.cos(angle), y + length * math.sin(angle))[1] < 1e-6


@given(segments, coordinate, coordinate, heading, st.floats(0.1, 20))
@settings(max_examples=100, deadline=None)
def test_python_and_compiled_agree(walls: np.ndarray, x: float, y: float, angle: float, farthest: float) -> None:
    assert ray_length(walls, x, y, angle, farthest) == ray_length.py_func(walls, x, y, angle, farthest)
    assert nearest_segment(walls, x, y) == nearest_segment.py_func(walls, x, y)
