from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.local_view import matcher as view_match
from ratslam_core.local_view.matcher import Matcher

from . import literal


def literal_nearest(
    known: np.ndarray, new: np.ndarray, most: int, columns: int = 12, rows: int = 8
) -> tuple[int, float, int]:
    """Shift by shift, view by view, column by column; only a smaller difference replaces the best so far."""
    best = (-1, math.inf, 0)
    for shift in range(-most, most + 1):
        for view, old in enumerate(known):
            total = 0
            for column in range(columns):
                if 0 <= column + shift < columns:
                    for row in range(rows):
                        total += abs(int(new[rows * (column + shift) + row]) - int(old[rows * column + row]))
            mean = total / (rows * (columns - abs(shift)))
            if mean < best[1]:
                best = (view, mean, shift)
    return best


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.integers(0, 5), st.integers(0, 40), st.sampled_from([1, 2, 255]))
def test_the_nearest_view_is_that_of_the_loops_bit_for_bit(seed: int, most: int, count: int, highest: int) -> None:
    """With few grey levels, many views and shifts are equally near; the first must win."""
    rng = np.random.default_rng(seed)
    known = rng.integers(0, highest + 1, (count, 96)).astype(np.uint8)
    new = rng.integers(0, highest + 1, 96).astype(np.uint8)
    assert Matcher().nearest(known, new, most) == literal_nearest(known, new, most)


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.integers(1, 20), st.integers(1, 9), st.integers(0, 20))
def test_views_of_any_size_are_compared_by_all_their_columns(seed: int, columns: int, rows: int, most: int) -> None:
    rng, most = np.random.default_rng(seed), min(most, columns - 1)
    known = rng.integers(0, 256, (9, columns * rows)).astype(np.uint8)
    new = rng.integers(0, 256, columns * rows).astype(np.uint8)
    assert Matcher(columns, rows).nearest(known, new, most) == literal_nearest(known, new, most, columns, rows)


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.slow
def test_the_nearest_of_many_blocks(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(view_match, monkeypatch)
    rng = np.random.default_rng(5)
    known = rng.integers(0, 256, (300, 96)).astype(np.uint8)
    matcher = Matcher()
    for view in (0, 127, 128, 299):
        assert matcher.nearest(known, known[view].copy(), 1) == (view, 0.0, 0)
    moved = np.roll(known[200], 8)
    assert matcher.nearest(known, moved, 1) == (200, 0.0, 1)


def test_a_look_leaves_nothing_behind() -> None:
    """After a search with many shifts, one with fewer shifts finds the same as a new matcher."""
    rng = np.random.default_rng(6)
    known = rng.integers(0, 256, (20, 96)).astype(np.uint8)
    used = Matcher()
    for most in (5, 0, 2, 1):
        new = rng.integers(0, 256, 96).astype(np.uint8)
        assert used.nearest(known, new, most) == Matcher().nearest(known, new, most)


@pytest.mark.parametrize("interpreted", [False, True])
def test_the_difference_of_two_views_under_a_shift(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(view_match, monkeypatch)
    rng = np.random.default_rng(7)
    a, b = rng.integers(0, 256, (2, 96)).astype(np.uint8)
    for shift in range(-5, 6):
        expected = [
            abs(int(a[8 * (c + shift) + r]) - int(b[8 * c + r]))
            for c in range(12)
            if 0 <= c + shift < 12
            for r in range(8)
        ]
        assert view_match.difference(a, b, shift, 12, 8) == sum(expected) / len(expected)
