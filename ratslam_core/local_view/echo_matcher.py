"""The nearest stored view when views also hold echoes: the sonars rule most views out before their pictures are compared."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.matcher import SIZE, Features, Matcher, overlap

ECHOES = 8  # compiled with this number as a constant
FARTHEST = 1e5  # no two views are that far apart


@kind("echo matcher/1")
class EchoMatcher(Matcher):
    """As `Matcher`, for features with echoes behind the columns. They do not shift.

    [ours] The search is exact: a view is passed over only if its echoes alone are farther off than the best view so far.
    test_echo_matcher.py::test_the_nearest_view_is_that_of_the_loops_bit_for_bit.
    """

    def __init__(self, columns: int, rows: int, echoes: int, echo_weight: float) -> None:
        super().__init__(columns, rows)
        self.echoes, self.echo_weight = echoes, echo_weight
        self._guess = 0  # where the search begins: a view seen a moment ago is near, and rules out most others

    def nearest(self, known: NDArray[np.uint8], new: Features, most: int) -> tuple[int, float, int]:
        if len(known) == 0:
            return -1, math.inf, 0
        guess = min(self._guess, len(known) - 1)
        found = _nearest(
            known, new, most, self.columns, self.rows, self.echoes, self.echo_weight, guess, self._shifted, self._masks
        )
        self._guess = found[0]
        return found


@njit(cache=True, nogil=True)
def heard_apart(new: Features, stored: Features, first: int) -> float:
    """Mean absolute difference of the echoes, which begin at byte `first`; one that is unknown (0) counts as equal."""
    total = 0
    for k in range(first, len(new)):
        if new[k] > 0 and stored[k] > 0:
            total += abs(np.int64(new[k]) - np.int64(stored[k]))
    return total / (len(new) - first)


@njit(cache=True, nogil=True)
def _nearest(
    known: NDArray[np.uint8],
    new: Features,
    most: int,
    columns: int,
    rows: int,
    echoes: int,
    weight: float,
    guess: int,
    shifted: NDArray[np.uint8],
    masks: NDArray[np.uint8],
) -> tuple[int, float, int]:
    first = columns - 1 - most
    widths = np.empty(2 * most + 1)
    for row in range(first, columns + most):
        here, there, width = overlap(row - columns + 1, columns, rows)
        widths[row - first] = width
        for k in range(width):
            shifted[row, there + k] = new[here + k]
    tried, size = slice(first, columns + most), columns * rows
    views, masked, heard = shifted[tried], masks[tried], new[size:]
    near = known[guess : guess + 1]
    if size == SIZE and echoes == ECHOES:  # several times as quick with the sizes as constants
        _, limit, _ = _search(near, heard, views, masked, widths, weight, SIZE // 2, SIZE, ECHOES, FARTHEST)
        best, least, by = _search(known, heard, views, masked, widths, weight, SIZE // 2, SIZE, ECHOES, limit)
    else:
        _, limit, _ = _search(near, heard, views, masked, widths, weight, size // 2, size, echoes, FARTHEST)
        best, least, by = _search(known, heard, views, masked, widths, weight, size // 2, size, echoes, limit)
    return best, least, by - most


@njit(cache=True, nogil=True, inline="always")
def _search(
    known: NDArray[np.uint8],
    heard: NDArray[np.uint8],
    shifted: NDArray[np.uint8],
    masks: NDArray[np.uint8],
    widths: NDArray[np.float64],
    weight: float,
    half: int,
    size: int,
    echoes: int,
    limit: float,
) -> tuple[int, float, int]:
    """The nearest view that is no farther than `limit`. Among equals the first shift wins, then the first view."""
    best, least, by = -1, limit, len(shifted)
    for i in range(len(known)):
        row = known[i]
        total = np.int32(0)
        for k in range(echoes):
            a, b = np.int32(row[size + k]), np.int32(heard[k])
            apart = np.abs(np.subtract(a, b))
            total = np.add(total, apart if a > 0 and b > 0 else np.int32(0))
        echo = weight * (total / echoes)
        if echo > least:
            continue
        for s in range(len(shifted)):
            most = np.int32((least - echo) * widths[s]) + 1  # a sum above this is farther off, whatever is rounded
            total = _sum(row, shifted[s], masks[s], 0, half)
            if total > most:
                continue
            total = np.add(total, _sum(row, shifted[s], masks[s], half, size))
            mean = total / widths[s] + echo
            if mean < least or (mean == least and s < by):
                best, least, by = i, mean, s
    return best, least, by


@njit(cache=True, nogil=True, inline="always")
def _sum(stored: Features, new: Features, mask: Features, first: int, end: int) -> np.int32:
    total = np.int32(0)
    for k in range(first, end):
        apart = np.subtract(np.int32(stored[k] & mask[k]), np.int32(new[k]))
        total = np.add(total, np.abs(apart))
    return total
