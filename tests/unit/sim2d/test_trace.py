"""Rings around floors, traced and simplified, on random plans."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sim2d import World
from sim2d.importers.trace import ring_area, simplify, trace

from .plans import corners, from_picture


@st.composite
def rectilinear(draw: st.DrawFn) -> NDArray[np.bool_]:
    """Floor on a coarse grid with fields 14 pixels wide, surrounded by wall."""
    fields = draw(st.lists(st.lists(st.booleans(), min_size=6, max_size=6), min_size=5, max_size=5))
    fields[2] = [True] * 6
    return np.pad(np.kron(np.array(fields), np.ones((14, 14), bool)), 3)


@settings(max_examples=40)
@given(rectilinear())
def test_rectilinear_plans_come_back(plan: NDArray[np.bool_]) -> None:
    rings = trace(plan)
    assert sum(map(ring_area, rings)) == plan.sum()
    assert [simplify(ring).tolist() for ring in rings] == [_from_its_lowest(ring) for ring in rings]
    world = from_picture(np.where(plan, 255, 0).astype(np.uint8)[::-1], 0.1)
    ends = {(round(x * 10), round(y * 10)) for x, y in corners(world)}
    assert ends <= {tuple(point) for ring in rings for point in ring.tolist()}
    floor = _inside(world, plan.shape)
    assert not (floor & ~plan).any()
    assert floor.sum() >= plan[31:45].sum() - 28 * 6  # the middle row of fields is always there


def _from_its_lowest(ring: NDArray[np.int32]) -> list[list[int]]:
    k = min(range(len(ring)), key=lambda i: (ring[i, 1], ring[i, 0]))
    return np.roll(ring, -k, axis=0).tolist()


def _inside(world: World, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """The world's floor as pixels of 0.1 m, by the number of walls to the right of each centre."""
    y, x = np.mgrid[: shape[0], : shape[1]] + 0.5
    crossings = np.zeros(shape, int)
    for x1, y1, _, y2 in world.segments() * 10:
        if abs(y1 - y2) > 1e-9:
            crossings += (y > min(y1, y2)) & (y < max(y1, y2)) & (x < x1)
    return crossings % 2 == 1


@pytest.mark.slow
@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.floats(0.3, 0.7))
def test_simplified_walls_keep_the_tolerance(seed: int, share: float) -> None:
    """For any set of pixels, no wall is more than a pixel inside the floor, and no border more than 1.5 from its wall."""
    rng = np.random.default_rng(seed)
    mess = rng.random((18, 24)) < share
    for ring in trace(mess):
        short = simplify(ring)
        assert {tuple(p) for p in short.tolist()} <= {tuple(p) for p in ring.tolist()}
        assert _farthest(ring, short) <= 1.5 + 1e-9
        assert _farthest(short, ring) <= 1.5 + 1e-9


def _farthest(ring: NDArray[np.int32], other: NDArray[np.int32]) -> float:
    """The largest distance of points along the first ring from the second."""
    a, b = other.astype(float), np.roll(other, -1, axis=0).astype(float)
    starts, ends = ring.astype(float), np.roll(ring, -1, axis=0).astype(float)
    points = np.concatenate([starts + t * (ends - starts) for t in np.linspace(0, 1, 9)])
    along = b - a
    t = np.einsum("pkd,kd->pk", points[:, None] - a, along) / np.maximum((along**2).sum(axis=1), 1e-12)
    nearest = a + np.clip(t, 0, 1)[:, :, None] * along
    return float(np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1).max())
