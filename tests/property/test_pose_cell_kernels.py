"""Laws of the compiled functions of the pose cells, each by itself on sets of active cells anywhere."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ratslam_core.pose_cells import activity_kernels as kernels
from ratslam_core.pose_cells import attractor_kernels as attractor
from ratslam_core.pose_cells.packet_kernels import COS, MASS, ROW, SIN, join_flanks, packet_rows
from tests.unit.ratslam_core import literal

from .active_cells import Active, Shape, active, scattered, shorter

EXAMPLES = settings(max_examples=60)
seeds = st.integers(0, 2**32)
small = st.tuples(st.integers(8, 15), st.integers(8, 15), st.integers(8, 15))
odd = st.tuples(*(st.sampled_from([9, 11, 13, 21]) for _ in range(3)))  # no two ways round are equally short


def clusters_of(cells: Active, window: int, radius: int) -> tuple[int, int, list[np.ndarray]]:
    owner, peaks = np.zeros(cells.n, np.int32), np.zeros(cells.n, np.int32)
    bounds = np.zeros((cells.n, 6), np.int8)
    arrays = [owner, peaks, bounds]
    return *kernels.cluster(cells.cells, cells.values, cells.n, cells.shape, window, radius, *arrays), arrays


@settings(max_examples=40)
@given(seeds, st.tuples(st.integers(8, 10), st.integers(8, 75), st.integers(8, 75)), st.booleans(), st.booleans())
def test_each_cell_is_divided_over_a_cube(seed: int, shape: Shape, whole: bool, sorted_: bool) -> None:
    """Cells may lie anywhere in a layer, also too far apart to be summed up together."""
    rng = np.random.default_rng(seed)
    flats = scattered(rng, shape, 3, 40, 30)
    flats = flats if sorted_ else rng.permutation(flats)
    before = active(flats, rng.uniform(0.1, 1, len(flats)), shape)
    distance, yaw = (0.0, float(rng.integers(-9, 9))) if whole else (rng.normal(0, 9), rng.normal(0, 6))
    turns = np.arange(shape[0]) * 2 * math.pi / shape[0]
    expected = np.zeros(shape)
    for (x, y, t, _), value in zip(before.cells[: before.n], before.values, strict=False):
        to = t + yaw, y + distance * math.sin(turns[t]), x + distance * math.cos(turns[t])
        for corner in itertools.product((0, 1), repeat=3):
            shares = [part if c else 1 - part for c, part in zip(corner, (v - math.floor(v) for v in to), strict=True)]
            at = tuple((math.floor(v) + c) % n for v, c, n in zip(to, corner, shape, strict=True))
            expected[at] += math.prod(shares) * value
    after = before.empty()
    headings, patch = np.column_stack([np.cos(turns), np.sin(turns)]), np.zeros((kernels.PATCH,) * 2, np.float32)
    after.n = kernels.shift(
        before.cells, before.values, before.n, distance, yaw, headings,
        after.cells, after.values, after.slot, shape, patch,
    )  # fmt: skip
    assert np.abs(after.dense() - expected).max() < 2e-6
    assert (after.values[: after.n] > 0).all()
    assert not patch.any()
    if whole:
        assert after.n <= before.n


@EXAMPLES
@given(seeds, small, st.integers(1, 4), st.integers(1, 9), st.integers(0, 3), st.booleans())
def test_a_cluster_is_the_strongest_free_cell_and_all_free_ones_around(
    seed: int, shape: Shape, middles: int, window: int, radius: int, with_zero: bool
) -> None:
    rng = np.random.default_rng(seed)
    flats = rng.permutation(scattered(rng, shape, middles, 40, 4))
    values = rng.uniform(0.1, 1, len(flats))
    values[0] *= not with_zero
    cells = active(flats, values, shape)
    found, room, (owner, peaks, bounds) = clusters_of(cells, window, radius)
    free, boxes = set(range(cells.n)), 0
    for c in range(found):
        peak = max(free, key=lambda i: cells.values[i])
        assert peaks[c] == peak
        apart = [shorter(cells.cells[: cells.n, a] - cells.cells[peak, a], shape[2 - a]) for a in range(3)]
        near = np.all([abs(d) <= min(window, (shape[2 - a] - 1) // 2) for a, d in enumerate(apart)], axis=0)
        mine = free & set(np.flatnonzero(near).tolist())
        assert set(np.flatnonzero(owner == c).tolist()) == mine
        reach = [apart[a][sorted(mine)] for a in range(3)]
        assert bounds[c].tolist() == [r.min() for r in reach] + [r.max() for r in reach]
        boxes += math.prod(int(np.ptp(r)) + 1 + 2 * radius for r in reach)
        free -= mine
    assert not free
    assert room == boxes


@EXAMPLES
@given(seeds, odd, st.integers(1, 4), st.integers(1, 4))
def test_a_packet_is_all_clusters_from_which_one_climbs_to_its_peak(
    seed: int, shape: Shape, middles: int, window: int
) -> None:
    rng = np.random.default_rng(seed)
    flats = rng.permutation(scattered(rng, shape, middles, 60, 3))
    cells = active(flats, rng.uniform(0.1, 1, len(flats)), shape)
    found, _, (owner, peaks, _) = clusters_of(cells, window, 0)
    at, values = cells.cells[: cells.n, :3].astype(int), cells.values[: cells.n].astype(float)
    apart = np.stack([shorter(at[:, None, a] - at[None, :, a], shape[2 - a]) for a in range(3)], axis=-1)
    top = peaks[:found].tolist()
    for c in range(1, found):  # a stronger neighbour is of a cluster that was found before
        beside = np.flatnonzero((np.abs(apart[:, top[c]]) <= 1).all(axis=1))
        best = int(beside[values[beside].argmax()])
        top[c] = top[c] if best == top[c] else top[owner[best]]
    tops = np.array([top[c] for c in owner])
    turns = np.arange(shape[0]) * 2 * math.pi / shape[0]
    headings = np.column_stack([np.cos(turns), np.sin(turns)])
    rows = np.full((found, ROW), 7.0)
    join_flanks(cells.cells, cells.values, cells.slot, shape, owner, peaks, found)
    packets = packet_rows(cells.cells, cells.values, cells.n, shape, owner, peaks, found, headings, rows)
    assert packets == len(set(top))
    assert (np.diff(rows[:packets, MASS]) <= 0).all()
    for rank in range(packets):
        mine = owner == rank
        (peak,) = set(tops[mine].tolist())
        assert (tops[~mine] != peak).all()
        share = values[mine] / values[mine].sum()
        place = (at[peak] + share @ apart[mine, peak]) % shape[::-1]
        assert rows[rank, :3] == pytest.approx(place, abs=1e-5)
        assert rows[rank, MASS] == pytest.approx(values[mine].sum(), abs=1e-6)
        assert rows[rank, COS : SIN + 1] == pytest.approx(share @ headings[at[mine, 2]], abs=1e-6)


@EXAMPLES
@given(seeds, small, st.integers(1, 4), st.integers(1, 5), st.integers(1, 3), st.floats(0.3, 2), st.booleans())
def test_excitation_leaves_out_what_inhibition_would_remove_and_nothing_else(
    seed: int, shape: Shape, middles: int, window: int, radius: int, sigma: float, just: bool
) -> None:
    """Only where a cluster's box shares no cell with another box or itself is weak activity left out."""
    rng = np.random.default_rng(seed)
    floor, weights = np.float32(0.01), attractor.gaussian(sigma, radius)
    flats = scattered(rng, shape, middles, 4 * middles, 1)
    if just:
        two = rng.integers(0, shape, (2, 3))
        two[1] = two[0]
        two[1, rng.integers(3)] += 2 * radius + rng.integers(0, 2)  # their boxes just share a layer, or just do not
        flats = np.ravel_multi_index(tuple((two % shape).T), shape)
    cells = active(flats, rng.uniform(0.1, 1, len(flats)), shape)
    clusters, room, (owner, peaks, bounds) = clusters_of(cells, window, radius)
    boxes = np.zeros((clusters, *shape), int)
    excited = np.zeros((clusters, *shape))
    for c in range(clusters):
        reach = [
            (cells.cells[peaks[c], a] + np.arange(bounds[c, a] - radius, bounds[c, 3 + a] + radius + 1)) % shape[2 - a]
            for a in range(3)
        ]
        np.add.at(boxes[c], np.ix_(*reach[::-1]), 1)
        only = active(flats[owner == c], cells.values[: cells.n][owner == c], shape)
        excited[c] = literal.convolve(only.dense(), weights.astype(float).tolist())
    expected = np.zeros(shape)
    for c in range(clusters):
        alone = boxes.sum(axis=0)[boxes[c] > 0].max() == 1
        expected += np.where(excited[c] > floor, excited[c], 0) if alone else excited[c]
    after = cells.empty()
    side = 2 * (window + radius) + 1
    box_a, box_b = np.full((2, side**3), 5.0, np.float32)
    after.n, _ = attractor.excite(
        cells.cells, cells.values, cells.n, owner, peaks, bounds, after.cells, after.values, after.slot, shape, window,
        weights, floor, box_a, box_b,
    )  # fmt: skip
    assert np.abs(after.dense() - expected).max() < 1e-6
    assert np.count_nonzero(after.values[: after.n]) == after.n <= room


@EXAMPLES
@given(st.lists(st.integers(0, 12), min_size=1, max_size=20), st.integers(1, 9), st.booleans())
@example([3], 3, False)
def test_inhibition_takes_a_cell_that_has_just_as_much(levels: list[int], phi: int, exact: bool) -> None:
    """Activity of exactly phi is none afterwards, and its cell is no longer active."""
    values = np.array(levels) / 16
    cells = active(np.arange(len(levels)) * 5, values, (8, 8, 8))
    cells.n = attractor.inhibit_and_normalise(
        cells.cells, cells.values, cells.n, cells.slot, np.float32(phi / 16 * (1 if exact else 0.9))
    )
    left = np.maximum(values - np.float64(np.float32(phi / 16 * (1 if exact else 0.9))), 0)
    assert cells.n == np.count_nonzero(left)
    expected = np.zeros(512)
    expected[: 5 * len(levels) : 5] = left / (left.sum() or 1)
    assert cells.dense().ravel() == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("between", "packets"), [(0.4, 1), (0.3, 2)])
def test_a_neighbour_that_is_just_as_strong_makes_no_flank(between: float, packets: int) -> None:
    """The cell between two peaks belongs to the first one's cluster, which the second joins if that cell is stronger."""
    shape = (8, 8, 8)
    cells = active(np.array([0, 1, 2]), np.array([0.5, between, 0.3]), shape)
    found, _, (owner, peaks, _) = clusters_of(cells, 1, 0)
    assert found == 2
    rows, headings = np.zeros((2, ROW)), np.ones((8, 2))
    join_flanks(cells.cells, cells.values, cells.slot, shape, owner, peaks, found)
    got = packet_rows(cells.cells, cells.values, 3, shape, owner, peaks, found, headings, rows)
    assert got == packets
    assert rows[:packets, MASS].sum() == pytest.approx(0.8 + between)
