from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core.extensions import kidnap_detector
from ratslam_core.extensions.kidnap_detector import MOST, NEAR_M, REACH_M, ScanChange
from tests.unit.ratslam_core.literal import also_interpreted

SCANS = st.lists(st.tuples(st.floats(0, 8), st.floats(0, 8)), min_size=1, max_size=16)


def jump(before: np.ndarray, now: np.ndarray) -> float:
    remembered = ScanChange()
    assert remembered.observe(before) == 0.0
    return remembered.observe(now)


@settings(max_examples=100)
@given(SCANS, st.randoms(use_true_random=False))
def test_it_is_the_mean_of_what_each_sonar_changed(scans: list[tuple[float, float]], random) -> None:
    """In any order, to and fro alike. One sonar does not speak for all: it counts up to a limit."""
    before, now = np.array(scans).T.copy()
    logs = [np.log(np.clip(some, NEAR_M, REACH_M)) for some in (before, now)]
    found = jump(before, now)
    assert found == pytest.approx(np.minimum(np.abs(logs[1] - logs[0]), MOST).mean(), abs=1e-9)
    order = random.sample(range(len(scans)), len(scans))
    assert jump(before[order], now[order]) == pytest.approx(found, abs=1e-9)
    assert jump(now, before) == pytest.approx(found, abs=1e-9)


@also_interpreted(kidnap_detector)
def test_without_a_scan_before_there_is_nothing_to_compare() -> None:
    """What is changed afterwards is not what was seen."""
    near, far = np.full(8, 1.0), np.full(8, 1.2)
    remembered, some = ScanChange(), np.log(1.2)
    scans = (near, far, None, far, near, np.full(8, 9.0), np.full(8, 5.0))
    assert [remembered.observe(scan) for scan in scans] == pytest.approx([0.0, some, 0.0, 0.0, some, MOST, 0.0])
    remembered.observe(near)
    near += 0.2
    assert remembered.observe(near) == pytest.approx(some)
