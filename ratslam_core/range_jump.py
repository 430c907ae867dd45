"""[ours] How much the sonars changed at once. Driving past a corner changes one or two, being carried away most of them.

The image alone misses one kidnap in five, since walls look alike; with the sonars one in fifty.
test_range_jump.py, test_slam.py::test_sonars_help_to_notice_a_kidnap.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FAR_M = 3.0  # echoes from beyond come and go
MOST_M = 1.0  # more is no surer a sign


class RangeJump:
    """Remembers the last scan."""

    def __init__(self) -> None:
        self._last: NDArray[np.float64] | None = None

    def observe(self, ranges_m: NDArray[np.float64] | None) -> float:
        """By how much at least half of the sonars differ from the scan before, 0 to 1 m; 0 when there is none to compare with.

        ranges_m: (n,) metres, none negative; None forgets.
        """
        last, self._last = self._last, None if ranges_m is None else ranges_m.copy()
        if last is None or ranges_m is None:
            return 0.0
        return _half_changed(last, ranges_m)


@njit(cache=True, nogil=True)
def _half_changed(before, now):
    changes = np.empty(len(now))
    for k in range(len(now)):
        changes[k] = abs(min(now[k], FAR_M) - min(before[k], FAR_M))
    return min(np.sort(changes)[len(now) // 2], MOST_M)
