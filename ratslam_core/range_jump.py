"""[ours] How much the sonars changed at once. Driving past a corner changes one or two, being carried away most of them.

The image alone misses one kidnap in five, since walls look alike, and is startled now and then by what is near; with the
sonars it misses one in forty, and is startled half as often.
test_range_jump.py, test_slam.py::test_sonars_help_to_notice_a_kidnap.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

FAR_M = 3.0  # echoes from beyond come and go
MOST_M = 1.0  # more is no surer a sign
STILL_M = 0.17  # less speaks against a kidnap


class RangeJump:
    """Remembers the last scan."""

    def __init__(self) -> None:
        self._last: NDArray[np.float64] | None = None

    def observe(self, ranges_m: NDArray[np.float64] | None) -> float:
        """By how much at least half of the sonars differ from the scan before, at most 1 m, beyond STILL_M; below 0 they hardly
        changed. 0 when there is nothing to compare with.

        ranges_m: (n,) metres, none negative; None forgets.
        """
        last, self._last = self._last, None if ranges_m is None else ranges_m.copy()
        if last is None or ranges_m is None:
            return 0.0
        return _half_changed(last, ranges_m) - STILL_M


@njit(cache=True, nogil=True)
def _half_changed(before, now):
    changes = np.empty(len(now))
    for k in range(len(now)):
        changes[k] = abs(min(now[k], FAR_M) - min(before[k], FAR_M))
    return min(np.sort(changes)[len(now) // 2], MOST_M)
