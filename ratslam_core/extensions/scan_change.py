"""[ours] How much the sonars changed at once. Driving past a corner changes one or two of them, being carried away most.

The image alone misses one kidnap in five, since walls look alike, and sometimes raises a false alarm when something is
near. With the sonars, one in forty is missed, and false alarms are half as frequent. test_scan_change.py,
test_kidnap_detector.py::test_sonars_help_to_notice_a_kidnap.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from ratslam_core.params import KidnapParams


@kind("scan change/2")
class ScanChange:
    """Remembers the last scan."""

    def __init__(self) -> None:
        self._last: NDArray[np.float64] | None = None

    def observe(self, ranges_m: NDArray[np.float64] | None, p: KidnapParams) -> float:
        """By how much (m) half of the sonars or more differ from the scan before, at most `sonar_most_m`, minus `sonar_still_m`.

        Below 0 they hardly changed; 0 when there is nothing to compare with. ranges_m: (n,) metres, none negative; None
        forgets the scan before.
        """
        last, self._last = self._last, None if ranges_m is None else ranges_m.copy()
        if last is None or ranges_m is None:
            return 0.0
        return _half_changed(last, ranges_m, p.sonar_reach_m, p.sonar_most_m) - p.sonar_still_m


@njit(cache=True, nogil=True)
def _half_changed(before: NDArray[np.float64], now: NDArray[np.float64], reach: float, most: float) -> float:
    changes = np.empty(len(now))
    for k in range(len(now)):
        change, at = abs(min(now[k], reach) - min(before[k], reach)), k
        while at > 0 and changes[at - 1] > change:  # insertion sort by hand: numpy's sort takes two seconds to compile
            changes[at] = changes[at - 1]
            at -= 1
        changes[at] = change
    return min(changes[len(now) // 2], most)
