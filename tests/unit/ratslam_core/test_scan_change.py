from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.extensions import scan_change
from ratslam_core.extensions.scan_change import MOST, NEAR_M, REACH_M, ScanChange
from tests.unit.ratslam_core import literal

SCANS = st.lists(st.tuples(st.floats(0, 8), st.floats(0, 8)), min_size=1, max_size=16)


def jump(before: np.ndarray, now: np.ndarray) -> float:
    remembered = ScanChange()
    assert remembered.observe(before) == 0.0
    return remembered.observe(now)


@settings(max_examples=100)
@given(SCANS, st.randoms(use_true_random=False))
def test_it_is_the_mean_of_what_each_sonar_changed(scans: list[tuple[float, float]], random) -> None:
    """In any order, to and fro alike; and in other units of length, but for the limits."""
    before, now = np.array(scans).T.copy()
    logs = [np.log(np.clip(some, NEAR_M, REACH_M)) for some in (before, now)]
    found = jump(before, now)
    assert found == pytest.approx(np.minimum(np.abs(logs[1] - logs[0]), MOST).mean(), abs=1e-9)
    order = random.sample(range(len(scans)), len(scans))
    assert jump(before[order], now[order]) == pytest.approx(found, abs=1e-9)
    assert jump(now, before) == pytest.approx(found, abs=1e-9)


@settings(max_examples=50)
@given(SCANS, st.integers(0, 15))
def test_one_sonar_does_not_speak_for_all(scans: list[tuple[float, float]], changed: int) -> None:
    before, after = np.array(scans).T
    now = before.copy()
    few = min(changed, len(scans))
    now[:few] = after[:few]
    assert jump(before.copy(), now) <= MOST * few / len(scans) + 1e-9


@pytest.mark.parametrize("interpreted", [False, True])
def test_without_a_scan_before_there_is_nothing_to_compare(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if interpreted:
        literal.interpret(scan_change, monkeypatch)
    near, far = np.full(8, 1.0), np.full(8, 1.2)
    remembered = ScanChange()
    scans = (near, far, None, far, near, np.full(8, 9.0), np.full(8, 5.0))
    found = [remembered.observe(scan) for scan in scans]
    some = np.log(1.2)
    assert found == pytest.approx([0.0, some, 0.0, 0.0, some, MOST, 0.0])


def test_what_is_changed_afterwards_is_not_what_was_seen() -> None:
    scan, remembered = np.full(8, 1.0), ScanChange()
    remembered.observe(scan)
    scan += 0.2
    assert remembered.observe(scan) == pytest.approx(np.log(1.2))
