"""The search through views, with echoes and without, against loops."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.local_view import echo_matcher, matcher
from ratslam_core.local_view.echo_matcher import EchoMatcher
from ratslam_core.local_view.matcher import Matcher

from .literal import also_interpreted


def literal_nearest(
    known: np.ndarray,
    new: np.ndarray,
    most: int,
    columns: int = 12,
    rows: int = 8,
    echoes: int = 0,
    weight: float = 0.0,
) -> tuple[int, float, int]:
    """Shift by shift, view by view, byte by byte; only a smaller difference replaces the best so far."""
    best, size, seen = (-1, math.inf, 0), columns * rows, new.tolist()
    for shift in range(-most, most + 1):
        both = [c for c in range(columns) if 0 <= c + shift < columns]
        for view, old in enumerate(known.tolist()):
            total = sum(abs(seen[rows * (c + shift) + r] - old[rows * c + r]) for c in both for r in range(rows))
            heard = sum(abs(seen[k] - old[k]) for k in range(size, size + echoes) if seen[k] and old[k])
            mean = total / (rows * (columns - abs(shift))) + weight * (heard / max(echoes, 1))
            if mean < best[1]:
                best = (view, mean, shift)
    return best


@settings(max_examples=60)
@given(
    st.integers(0, 2**32 - 1), st.lists(st.integers(0, 5), min_size=3, max_size=3), st.integers(0, 40),
    st.sampled_from([1, 2, 255]), st.sampled_from([0.0, 0.125, 0.12, 3.0]),
)  # fmt: skip
def test_the_nearest_view_is_that_of_the_loops_bit_for_bit(
    seed: int, shifts: list[int], count: int, highest: int, weight: float
) -> None:
    """With few levels, many views and shifts are equally near: the first must win, whatever was looked for before."""
    rng, plain, hearing = np.random.default_rng(seed), Matcher(), EchoMatcher(12, 8, 8, weight)
    known = rng.integers(0, highest + 1, (count, 104)).astype(np.uint8)
    pictures = known[:, :96].copy()
    for most in shifts:
        new = rng.integers(0, highest + 1, 104).astype(np.uint8)
        assert hearing.nearest(known, new, most) == literal_nearest(known, new, most, 12, 8, 8, weight)
        assert plain.nearest(pictures, new[:96], most) == literal_nearest(pictures, new[:96], most)


@also_interpreted(matcher, echo_matcher)
def test_views_of_any_size_are_compared_by_all_their_columns() -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        columns, rows, echoes = rng.integers(1, (21, 10, 10)).tolist()
        most, size = min(seed % 6, columns - 1), columns * rows
        known = rng.integers(0, 256, (5, size + echoes)).astype(np.uint8)
        pictures, hearing, plain = (
            known[:, :size].copy(),
            EchoMatcher(columns, rows, echoes, 0.5),
            Matcher(columns, rows),
        )
        for view in (4, 0):
            new = known[view] ^ rng.integers(0, 8, size + echoes).astype(np.uint8)
            heard = literal_nearest(known, new, most, columns, rows, echoes, 0.5)
            assert hearing.nearest(known, new, most) == heard
            assert plain.nearest(pictures, new[:size], most) == literal_nearest(
                pictures, new[:size], most, columns, rows
            )


def test_views_that_come_go_and_are_replaced_are_found_among_many() -> None:
    rng, hearing, plain = np.random.default_rng(6), EchoMatcher(12, 8, 8, 0.5), Matcher()
    memory = rng.integers(0, 256, (3000, 104)).astype(np.uint8)
    pictures = memory[:, :96].copy()
    for count in (1, 2, 128, 129, 1500, 2999, 2, 300):
        view = count - 1
        assert hearing.nearest(memory[:count], memory[view], 1) == (view, 0.0, 0)
        assert plain.nearest(pictures[:count], pictures[view].copy(), 1) == (view, 0.0, 0)
    for search in (hearing, plain):
        assert search.nearest(memory[:0], memory[1], 1) == (-1, math.inf, 0)
    assert plain.nearest(pictures[:300], np.roll(pictures[200], 8), 1) == (200, 0.0, 1)
    memory[7] = rng.integers(0, 256, 104)
    hearing.replaced(7, memory[7])
    assert hearing.nearest(memory[:2999], memory[7], 1) == (7, 0.0, 0)
    other = memory[::-1].copy()
    assert hearing.nearest(other[:2999], memory[2999], 1) == (0, 0.0, 0)


@also_interpreted(matcher)
def test_the_difference_of_two_views_under_a_shift() -> None:
    a, b = np.random.default_rng(7).integers(0, 256, (2, 12, 8)).astype(np.uint8)
    for shift in range(-5, 6):
        here, there = slice(max(shift, 0), 12 + min(shift, 0)), slice(max(-shift, 0), 12 + min(-shift, 0))
        expected = np.abs(a[here].astype(int) - b[there]).mean()
        assert matcher.difference(a.ravel(), b.ravel(), shift, 12, 8) == expected
