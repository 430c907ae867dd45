"""[ours] How much the sonars changed at once. Driving past a corner changes one or two of them, being carried away most.

The image alone misses many kidnaps, since walls look alike, and sometimes raises a false alarm when something is near.
Ranges are compared by their ratio, since a few centimetres are much beside a wall and nothing in a hall, and each sonar
counts up to a limit, so that one that looks past a corner does not speak for all. test_scan_change.py,
test_kidnap_detector.py::test_sonars_help_to_notice_a_kidnap.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind

NEAR_M, REACH_M = 0.2, 4.0  # shorter and longer ranges count as these, since distant echoes come and go
MOST = 0.35  # a larger change of one sonar, as the logarithm of the ratio of its ranges, counts as this


@kind("scan change/3")
class ScanChange:
    """Remembers the last scan."""

    def __init__(self) -> None:
        self._last: NDArray[np.float64] | None = None

    def observe(self, ranges_m: NDArray[np.float64] | None) -> float:
        """By how much the sonars differ from the scan before: the mean of |ln(now / before)|, each at most MOST.

        0 when there is nothing to compare with. ranges_m: (n,) metres, none negative; None forgets the scan before.
        """
        last, self._last = self._last, None if ranges_m is None else ranges_m.copy()
        if last is None or ranges_m is None:
            return 0.0
        return _change(last, ranges_m)


@njit(cache=True, nogil=True)
def _change(before: NDArray[np.float64], now: NDArray[np.float64]) -> float:
    total = 0.0
    for k in range(len(now)):
        ratio = min(max(now[k], NEAR_M), REACH_M) / min(max(before[k], NEAR_M), REACH_M)
        total += min(abs(math.log(ratio)), MOST)
    return total / len(now)
