from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import range_jump
from ratslam_core.range_jump import FAR_M, MOST_M, STILL_M, RangeJump
from tests.unit.ratslam_core import literal

SCANS = st.lists(st.tuples(st.floats(0, 8), st.floats(0, 8)), min_size=1, max_size=16)


def jump(before: np.ndarray, now: np.ndarray) -> float:
    remembered = RangeJump()
    assert remembered.observe(before) == 0.0
    return remembered.observe(now) + STILL_M


@settings(max_examples=100, deadline=None)
@given(SCANS, st.randoms(use_true_random=False))
def test_it_is_what_half_of_the_sonars_exceed_in_any_order(scans: list[tuple[float, float]], random) -> None:
    before, now = np.array(scans).T.copy()
    changes = np.abs(np.minimum(now, FAR_M) - np.minimum(before, FAR_M))
    found = jump(before, now)
    assert -1e-12 <= found <= MOST_M
    assert np.sum(changes >= found - 1e-12) >= len(scans) / 2
    if found < MOST_M:
        assert np.sum(changes > found + 1e-12) <= len(scans) / 2
    order = random.sample(range(len(scans)), len(scans))
    assert jump(before[order], now[order]) == found


@settings(max_examples=50, deadline=None)
@given(SCANS, st.integers(0, 15))
def test_fewer_than_half_of_them_say_nothing(scans: list[tuple[float, float]], changed: int) -> None:
    before, after = np.array(scans).T
    now = before.copy()
    few = min(changed, (len(scans) - 1) // 2)
    now[:few] = after[:few]
    assert jump(before.copy(), now) == pytest.approx(0.0)


@pytest.mark.parametrize("interpreted", [False, True])
def test_without_a_scan_before_there_is_nothing_to_compare(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(range_jump, monkeypatch)
    near, far = np.full(8, 1.0), np.full(8, 1.6)
    remembered = RangeJump()
    found = [remembered.observe(scan) for scan in (near, far, None, far, near, np.full(8, 9.0), np.full(8, 4.0))]
    expected = [0.0, 0.6 - STILL_M, 0.0, 0.0, 0.6 - STILL_M, MOST_M - STILL_M, -STILL_M]
    assert found == pytest.approx(expected)


def test_what_is_changed_afterwards_is_not_what_was_seen() -> None:
    scan, remembered = np.full(8, 1.0), RangeJump()
    remembered.observe(scan)
    scan += 0.5
    assert remembered.observe(scan) == 0.5 - STILL_M
