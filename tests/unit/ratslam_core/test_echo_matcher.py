"""The search through views with echoes, against loops."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.local_view import echo_matcher
from ratslam_core.local_view.echo_matcher import EchoMatcher
from ratslam_core.local_view.matcher import Matcher

from . import literal


def literal_nearest(
    known: np.ndarray, new: np.ndarray, most: int, columns: int, rows: int, echoes: int, weight: float
) -> tuple[int, float, int]:
    """Shift by shift, view by view, byte by byte; only a smaller difference replaces the best so far."""
    best, size = (-1, math.inf, 0), columns * rows
    for shift in range(-most, most + 1):
        for view, old in enumerate(known):
            total = heard = 0
            for column in range(columns):
                if 0 <= column + shift < columns:
                    for row in range(rows):
                        total += abs(int(new[rows * (column + shift) + row]) - int(old[rows * column + row]))
            for k in range(size, size + echoes):
                if new[k] and old[k]:
                    heard += abs(int(new[k]) - int(old[k]))
            mean = total / (rows * (columns - abs(shift))) + weight * (heard / echoes)
            if mean < best[1]:
                best = (view, mean, shift)
    return best


@settings(max_examples=60)
@given(
    st.integers(0, 2**32 - 1), st.integers(0, 5), st.integers(0, 40), st.sampled_from([1, 2, 255]),
    st.sampled_from([0.0, 0.125, 0.12, 3.0]),
)  # fmt: skip
def test_the_nearest_view_is_that_of_the_loops_bit_for_bit(
    seed: int, most: int, count: int, highest: int, weight: float
) -> None:
    """With few levels, many views and shifts are equally near; the first must win, wherever the search begins."""
    rng, matcher = np.random.default_rng(seed), EchoMatcher(12, 8, 8, weight)
    known = rng.integers(0, highest + 1, (count, 104)).astype(np.uint8)
    for _ in range(3):
        new = rng.integers(0, highest + 1, 104).astype(np.uint8)
        assert matcher.nearest(known, new, most) == literal_nearest(known, new, most, 12, 8, 8, weight)


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.parametrize(("columns", "rows", "echoes"), [(12, 8, 8), (12, 8, 5), (7, 3, 2)])
def test_views_of_any_size_are_compared(
    columns: int, rows: int, echoes: int, interpreted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if interpreted:
        literal.interpret(echo_matcher, monkeypatch)
    rng, matcher = np.random.default_rng(3), EchoMatcher(columns, rows, echoes, 0.5)
    known = rng.integers(0, 256, (6, columns * rows + echoes)).astype(np.uint8)
    for view in (5, 0, 3):
        new = known[view].copy()
        new[:9] ^= 7
        assert matcher.nearest(known, new, 2) == literal_nearest(known, new, 2, columns, rows, echoes, 0.5)


def test_views_that_were_lost_since_do_no_harm() -> None:
    rng, matcher = np.random.default_rng(4), EchoMatcher(12, 8, 8, 0.1)
    known = rng.integers(0, 256, (9, 104)).astype(np.uint8)
    assert matcher.nearest(known, known[8], 1) == (8, 0.0, 0)
    assert matcher.nearest(known[:2], known[1], 1) == (1, 0.0, 0)
    assert matcher.nearest(known[:0], known[1], 1) == (-1, math.inf, 0)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_unknown_echoes_leave_the_picture(seed: int) -> None:
    rng = np.random.default_rng(seed)
    known, new = rng.integers(0, 256, (12, 104)).astype(np.uint8), rng.integers(0, 256, 104).astype(np.uint8)
    new[96:] = 0
    assert EchoMatcher(12, 8, 8, 0.7).nearest(known, new, 2) == Matcher().nearest(known[:, :96].copy(), new[:96], 2)


def test_views_that_are_learnt_grow_and_are_replaced_are_found() -> None:
    rng, matcher = np.random.default_rng(6), EchoMatcher(12, 8, 8, 0.5)
    memory = rng.integers(0, 256, (3000, 104)).astype(np.uint8)
    for count in (1, 2, 1500, 2999):
        view = count - 1
        assert matcher.nearest(memory[:count], memory[view], 1) == (view, 0.0, 0)
    memory[7] = rng.integers(0, 256, 104)
    matcher.replaced(7, memory[7])
    assert matcher.nearest(memory[:2999], memory[7], 1) == (7, 0.0, 0)
    other = memory[::-1].copy()
    assert matcher.nearest(other[:2999], memory[2999], 1) == (0, 0.0, 0)
