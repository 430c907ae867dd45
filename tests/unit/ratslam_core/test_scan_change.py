from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import KidnapParams
from ratslam_core.extensions import scan_change
from ratslam_core.extensions.scan_change import ScanChange
from tests.unit.ratslam_core import literal

P = KidnapParams()
SCANS = st.lists(st.tuples(st.floats(0, 8), st.floats(0, 8)), min_size=1, max_size=16)


def jump(before: np.ndarray, now: np.ndarray) -> float:
    remembered = ScanChange()
    assert remembered.observe(before, P) == 0.0
    return remembered.observe(now, P) + P.sonar_still_m


@settings(max_examples=100)
@given(SCANS, st.randoms(use_true_random=False))
def test_it_is_what_half_of_the_sonars_exceed_in_any_order(scans: list[tuple[float, float]], random) -> None:
    before, now = np.array(scans).T.copy()
    changes = np.abs(np.minimum(now, P.sonar_reach_m) - np.minimum(before, P.sonar_reach_m))
    found = jump(before, now)
    assert -1e-12 <= found <= P.sonar_most_m
    assert np.sum(changes >= found - 1e-12) >= len(scans) / 2
    if found < P.sonar_most_m:
        assert np.sum(changes > found + 1e-12) <= len(scans) / 2
    order = random.sample(range(len(scans)), len(scans))
    assert jump(before[order], now[order]) == found


@settings(max_examples=50)
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
        literal.interpret(scan_change, monkeypatch)
    near, far = np.full(8, 1.0), np.full(8, 1.6)
    remembered = ScanChange()
    found = [remembered.observe(scan, P) for scan in (near, far, None, far, near, np.full(8, 9.0), np.full(8, 4.0))]
    expected = [
        0.0,
        0.6 - P.sonar_still_m,
        0.0,
        0.0,
        0.6 - P.sonar_still_m,
        P.sonar_most_m - P.sonar_still_m,
        -P.sonar_still_m,
    ]
    assert found == pytest.approx(expected)


def test_what_is_changed_afterwards_is_not_what_was_seen() -> None:
    scan, remembered = np.full(8, 1.0), ScanChange()
    remembered.observe(scan, P)
    scan += 0.5
    assert remembered.observe(scan, P) == 0.5 - P.sonar_still_m
