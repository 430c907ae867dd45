"""The compiled camera against a ray caster written straight from the geometry, one ray and one wall at a time."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim2d.camera.sight import MAX_HITS, MOST_FLAT_RAD, NEAR_M, column_hits, lens_rays, round_hits, seen_walls
from sim2d.geometry.segments import nearest_segment
from sim2d.geometry.wall_index import build_index, first_wall, nearest_within
from sim2d.sensors import laser_ranges
from tests.unit.sim2d.literal import ray_length

FOCAL = 30.0
WIDTH = 24
coordinate = st.floats(-6, 6).map(lambda v: round(v, 3))
segment = st.tuples(coordinate, coordinate, coordinate, coordinate).filter(lambda s: math.dist(s[:2], s[2:]) > 0.05)
segments = st.lists(segment, min_size=1, max_size=12).map(np.array)
clear_segments = st.lists(
    segment.filter(lambda s: nearest_segment(np.array([s]), 0.0, 0.0)[1] > 2 * NEAR_M), min_size=1, max_size=12
).map(np.array)  # nothing where the camera is
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


@pytest.mark.slow
@given(clear_segments, heading, st.data())
@settings(max_examples=80)
def test_columns_meet_the_walls_that_rays_meet(walls: np.ndarray, angle: float, data: st.DataObject) -> None:
    full = np.array(data.draw(st.lists(st.booleans(), min_size=len(walls), max_size=len(walls))))
    counts, strips = np.zeros(WIDTH, np.int64), np.zeros((WIDTH, MAX_HITS), np.int64)
    hits = np.zeros((WIDTH, MAX_HITS, 3))
    column_hits(walls, full, np.arange(len(walls)), 0.0, 0.0, angle, FOCAL, counts, strips, hits)
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
@settings(max_examples=120)
def test_a_ray_never_passes_a_wall(walls: np.ndarray, x: float, y: float, angle: float, farthest: float) -> None:
    length = ray_length(walls, x, y, angle, farthest)
    assert 0 <= length <= farthest
    crossings = [c for c in literal_crossings(walls, x, y, math.cos(angle), math.sin(angle)) if 1e-6 < c[2] < 1 - 1e-6]
    if crossings:
        assert length <= crossings[0][0] + 1e-6
    if length < farthest:
        assert nearest_segment(walls, x + length * math.cos(angle), y + length * math.sin(angle))[1] < 1e-6


@given(segments, coordinate, coordinate, heading, st.floats(0.1, 20))
@settings(max_examples=150)
def test_the_index_finds_what_looking_at_all_finds(
    walls: np.ndarray, x: float, y: float, angle: float, farthest: float
) -> None:
    index = build_index(walls)
    assert first_wall(index, x, y, math.cos(angle), math.sin(angle), farthest)[1] == ray_length(
        walls, x, y, angle, farthest
    )
    assert nearest_within(index, x, y, farthest) == min(nearest_segment(walls, x, y)[1], farthest)


@given(clear_segments, heading, st.sampled_from([0.8, 6.2]), st.data())
@settings(max_examples=80)
@pytest.mark.slow
def test_the_camera_sees_the_same_through_the_index(
    walls: np.ndarray, angle: float, fov: float, data: st.DataObject
) -> None:
    """All walls that columns meet are among those that the index chooses."""
    full = np.array(data.draw(st.lists(st.booleans(), min_size=len(walls), max_size=len(walls))))
    rays, focal = lens_rays(WIDTH, fov)
    index, seen = build_index(walls), np.zeros(len(walls), np.int64)
    n = seen_walls(index, full, 0.0, 0.0, angle, rays, np.zeros(len(walls), np.int64), 1, seen)
    assert seen[:n].tolist() == sorted(set(seen[:n].tolist()))
    results = []
    for chosen in (np.arange(len(walls)), seen[:n]):
        counts, strips = np.zeros(WIDTH, np.int64), np.zeros((WIDTH, MAX_HITS), np.int64)
        hits = np.zeros((WIDTH, MAX_HITS, 3))
        if fov < MOST_FLAT_RAD:
            column_hits(walls, full, chosen, 0.0, 0.0, angle, focal, counts, strips, hits)
        else:
            round_hits(walls, full, chosen, 0.0, 0.0, angle, rays, counts, strips, hits)
        results.append([(strips[c, :k].tolist(), hits[c, :k].tolist()) for c, k in enumerate(counts)])
    assert results[0] == results[1]


@given(clear_segments, heading)
@settings(max_examples=60)
def test_a_round_lens_sees_what_a_laser_ranges(walls: np.ndarray, angle: float) -> None:
    rays, _ = lens_rays(WIDTH, 2 * math.pi)
    counts, strips = np.zeros(WIDTH, np.int64), np.zeros((WIDTH, MAX_HITS), np.int64)
    hits = np.zeros((WIDTH, MAX_HITS, 3))
    round_hits(walls, np.zeros(len(walls), bool), np.arange(len(walls)), 0.0, 0.0, angle, rays, counts, strips, hits)
    half = math.pi / WIDTH
    nothing = np.zeros((0, 4))
    scan = laser_ranges(build_index(walls), nothing, 0.0, 0.0, angle - half, 2 * math.pi, 50.0, np.zeros(WIDTH))
    for c in range(WIDTH):
        if counts[c]:
            assert 1.0 / hits[c, 0, 0] == pytest.approx(scan[c], rel=1e-5)
            assert 0.0 <= hits[c, 0, 1] <= hits[c, 0, 2] <= 1.0
        else:
            assert scan[c] == 50.0
