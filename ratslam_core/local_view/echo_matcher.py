"""The nearest stored view when views also hold echoes: the sonars rule most views out before their pictures are compared."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ratslam_core.local_view.matcher import SIZE, Features, Matcher, shift_all, sum_apart
from ratslam_core.types import Bytes, Floats, Uints32

FARTHEST = 1e5  # no two views are that far apart


class HeardEchoes:
    """The echoes of all views once more, echo by echo, so that a processor compares many views at once."""

    def __init__(self, known: Bytes, size: int) -> None:
        """known: (n, size + echoes), the views."""
        room = len(known) + len(known) // 2 + 1024
        self.echoes = np.zeros((known.shape[1] - size, room), np.uint8)
        self.total, self.kept = np.zeros(room, np.int16), np.zeros(room, np.uint32)  # scratch for the search
        self._owner, self._size, self._count = _owner(known), size, 0

    def holds(self, known: Bytes) -> bool:
        """Whether these are views of the same memory, and perhaps more of them."""
        return _owner(known) is self._owner and self._count <= len(known) <= self.echoes.shape[1]

    def take(self, known: Bytes) -> None:
        """Take in what is new."""
        self.echoes[:, self._count : len(known)] = known[self._count :, self._size :].T
        self._count = len(known)

    def replace(self, view: int, new: Features) -> None:
        """One view is another now."""
        if view < self._count:
            self.echoes[:, view] = new[self._size :]


def _owner(array: Bytes) -> Bytes:
    """The array whose memory this is a part of."""
    return array.base if isinstance(array.base, np.ndarray) else array


class EchoMatcher(Matcher):
    """As `Matcher`, for features with echoes behind the columns. They do not shift.

    [ours] The search is exact: a view is passed over only if its echoes alone are farther off than the best view so far.
    test_matchers.py::test_the_nearest_view_is_that_of_the_loops_bit_for_bit.
    """

    def __init__(self, columns: int, rows: int, echoes: int, echo_weight: float) -> None:
        super().__init__(columns, rows)
        self.echoes, self.echo_weight = echoes, echo_weight
        self._guess = 0  # where the search begins: a view seen a moment ago is near, and rules out most others
        self._heard: HeardEchoes | None = None

    def nearest(self, known: Bytes, new: Features, most: int) -> tuple[int, float, int]:
        if len(known) == 0:
            return -1, math.inf, 0
        guess = min(self._guess, len(known) - 1)
        heard = self._heard_in(known)
        found = _nearest(
            known, new, most, self.columns, self.rows, self.echoes, self.echo_weight, guess, self._shifted, self._masks,
            heard.echoes, heard.total, heard.kept,
        )  # fmt: skip
        self._guess = found[0]
        return found

    def replaced(self, view: int, new: Features) -> None:
        if self._heard is not None:
            self._heard.replace(view, new)

    def _heard_in(self, known: Bytes) -> HeardEchoes:
        if self._heard is None or not self._heard.holds(known):
            self._heard = HeardEchoes(known, self.columns * self.rows)
        self._heard.take(known)
        return self._heard


@njit(cache=True, nogil=True)
def _nearest(
    known: Bytes, new: Features, most: int, columns: int, rows: int, echoes: int, weight: float, guess: int,
    shifted: Bytes, masks: Bytes, echoes_of: Bytes, total: NDArray[np.int16], kept: Uints32,
) -> tuple[int, float, int]:  # fmt: skip
    tried, widths = shift_all(new, most, columns, rows, shifted)
    size = columns * rows
    views, masked, heard = shifted[tried], masks[tried], new[size:]
    _sum_echoes(echoes_of, heard, len(known), total)
    kept[0] = guess
    if size == SIZE:  # several times as quick with the size as a constant
        _, limit, _ = _search(known, kept[:1], total, echoes, views, masked, widths, weight, SIZE // 2, SIZE, FARTHEST)
        near = _keep_near(total, len(known), echoes, weight, limit, kept)
        best, least, by = _search(known, near, total, echoes, views, masked, widths, weight, SIZE // 2, SIZE, limit)
    else:
        _, limit, _ = _search(known, kept[:1], total, echoes, views, masked, widths, weight, size // 2, size, FARTHEST)
        near = _keep_near(total, len(known), echoes, weight, limit, kept)
        best, least, by = _search(known, near, total, echoes, views, masked, widths, weight, size // 2, size, limit)
    return best, least, by - most


@njit(cache=True, nogil=True)
def _sum_echoes(echoes_of: Bytes, heard: Bytes, n: int, total: NDArray[np.int16]) -> None:
    """The sum of absolute differences of the echoes of each view; one that is unknown (0) counts as equal."""
    total[:n] = 0
    for k in range(len(heard)):
        b = np.int16(heard[k])
        if b > 0:
            echo = echoes_of[k]
            for i in range(n):
                a = np.int16(echo[i])
                apart = np.abs(np.subtract(a, b))
                total[i] = np.add(total[i], apart if a > 0 else np.int16(0))


@njit(cache=True, nogil=True)
def _keep_near(total: NDArray[np.int16], n: int, echoes: int, weight: float, limit: float, kept: Uints32) -> Uints32:
    """The views, in their order, whose echoes alone are no farther than the limit. Without a branch, as none can be foreseen."""
    most = 0
    while most < 255 * echoes and weight * ((most + 1) / echoes) <= limit:
        most += 1
    left = 0
    for i in range(n):
        kept[left] = i
        left += total[i] <= most
    return kept[:left]


@njit(cache=True, nogil=True, inline="always")
def _search(
    known: Bytes, near: Uints32, echo_sums: NDArray[np.int16], echoes: int, shifted: Bytes, masks: Bytes,
    widths: Floats, weight: float, half: int, size: int, limit: float,
) -> tuple[int, float, int]:  # fmt: skip
    """Of these views, the nearest that is no farther than `limit`. Among equals the first shift wins, then the first view."""
    best, least, by = -1, limit, len(shifted)
    for i in near:
        row = known[i]
        echo = weight * (echo_sums[i] / echoes)
        if echo > least:
            continue
        for s in range(len(shifted)):
            most = np.int32((least - echo) * widths[s]) + 1  # a sum above this is farther off, whatever is rounded
            total = sum_apart(row, shifted[s], masks[s], 0, half)
            if total > most:
                continue
            total = np.add(total, sum_apart(row, shifted[s], masks[s], half, size))
            mean = total / widths[s] + echo
            if mean < least or (mean == least and s < by):
                best, least, by = int(i), mean, s
    return best, least, by
