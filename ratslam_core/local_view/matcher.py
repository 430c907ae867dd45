"""The nearest stored view: sums of absolute differences under horizontal shifts, one pass through memory. ACRA 2006 section 7.

Features are stored column after column, so that turning the robot shifts them by whole columns. There are 12 columns of
8 bytes unless the front end says otherwise.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from ratslam_core.params import COLUMNS, ROWS
from ratslam_core.types import Bytes, Floats, Ints, Ints32

SIZE = COLUMNS * ROWS
BLOCK = 128  # stored views that stay in the processor's nearest cache while all shifts are tried

Features = Bytes  # (columns * rows,)


class Matcher:
    """Finds the nearest of the stored views. Owns its small buffers, so that a search allocates nothing."""

    def __init__(self, columns: int = COLUMNS, rows: int = ROWS) -> None:
        self.columns, self.rows = columns, rows
        self._shifted = np.zeros((2 * columns - 1, columns * rows), np.uint8)  # the new view, shift by shift
        self._masks = np.zeros_like(self._shifted)  # 255 where a stored view overlaps it, else 0
        self._least = np.zeros(len(self._masks), np.int32)
        self._at = np.zeros(len(self._masks), np.int64)
        for shift in range(1 - columns, columns):
            _, there, width = overlap(shift, columns, rows)
            self._masks[shift + columns - 1, there : there + width] = 255

    def nearest(self, known: Bytes, new: Features, most: int) -> tuple[int, float, int]:
        """The nearest view, its mean absolute difference over the columns that overlap, and the shift.

        known: (n, columns * rows); with none known (-1, inf, 0). Shifts from -most to most columns are tried. Among
        equals the first shift wins, then the first view.
        """
        if len(known) == 0:
            return -1, math.inf, 0
        return _nearest(known, new, most, self.columns, self.rows, self._shifted, self._masks, self._least, self._at)

    def apart_at(
        self, known: Bytes, new: Features, views: Ints, shifts: Ints, slack: int, most: int, echo_weight: float
    ) -> tuple[Floats, Ints]:
        """How far each of these views is from the new one at shifts within `slack` of the one given, and at which of them."""
        return _apart_at_any_size(
            known, new, views, shifts, slack, most, self.columns, self.rows, echo_weight, self._shifted, self._masks
        )

    def replaced(self, view: int, new: Features) -> None:
        """A stored view is another now."""


@njit(cache=True, nogil=True)
def overlap(shift: int, columns: int, rows: int) -> tuple[int, int, int]:
    """Where the columns that overlap begin in the new and in the stored view, and how many bytes they hold."""
    return max(shift, 0) * rows, max(-shift, 0) * rows, (columns - abs(shift)) * rows


@njit(cache=True, nogil=True)
def difference(new: Features, stored: Features, shift: int, columns: int, rows: int) -> float:
    """Mean absolute difference of two views over the columns that overlap."""
    here, there, width = overlap(shift, columns, rows)
    total = 0
    for k in range(width):
        total += abs(np.int64(new[here + k]) - np.int64(stored[there + k]))
    return total / width


@njit(cache=True, nogil=True)
def turned_apart(new: Features, last: Features, shift: float, columns: int, rows: int) -> float:
    """Mean absolute difference of an image and the last one moved `shift` columns to the right, over those that both show.

    Between two columns, the last image is interpolated. Infinite if the two show nothing in common.
    """
    total, seen = 0.0, 0
    for c in range(columns):
        at = c - shift
        if at < 0.0 or at > columns - 1:
            continue
        left = min(int(at), columns - 2) if columns > 1 else 0
        share = at - left
        right = left + 1 if share > 0.0 else left
        for r in range(rows):
            before = (1.0 - share) * last[left * rows + r] + share * last[right * rows + r]
            total += abs(new[c * rows + r] - before)
        seen += 1
    return total / (seen * rows) if seen else np.inf


@njit(cache=True, nogil=True)
def least_difference(new: Features, stored: Features, most: int, columns: int, rows: int) -> float:
    """The least `difference` under shifts from -most to most columns."""
    least = np.inf
    for shift in range(-most, most + 1):
        least = min(least, difference(new, stored, shift, columns, rows))
    return least


@njit(cache=True, nogil=True)
def _apart_at_any_size(
    known: Bytes, new: Features, views: Ints, shifts: Ints, slack: int, most: int, columns: int, rows: int,
    echo_weight: float, shifted: Bytes, masks: Bytes,
) -> tuple[Floats, Ints]:  # fmt: skip
    """For each of these views its least `difference` at shifts within `slack` of the one given, and that shift."""
    size = columns * rows
    tried, widths = shift_all(new, most, columns, rows, shifted)
    views_of, masked = shifted[tried], masks[tried]
    if size == SIZE:
        return _apart_at(known, new, views, shifts, slack, most, SIZE, echo_weight, views_of, masked, widths)
    return _apart_at(known, new, views, shifts, slack, most, size, echo_weight, views_of, masked, widths)


@njit(cache=True, nogil=True, inline="always")
def _apart_at(
    known: Bytes, new: Features, views: Ints, shifts: Ints, slack: int, most: int, size: int, echo_weight: float,
    shifted: Bytes, masks: Bytes, widths: Floats,
) -> tuple[Floats, Ints]:  # fmt: skip
    least, by = np.full(len(views), np.inf), np.zeros(len(views), np.int64)
    for k in range(len(views)):
        stored = known[views[k]]
        for shift in range(max(shifts[k] - slack, -most), min(shifts[k] + slack, most) + 1):
            apart = sum_apart(stored, shifted[shift + most], masks[shift + most], 0, size) / widths[shift + most]
            if apart < least[k]:
                least[k], by[k] = apart, shift
        if len(new) > size:
            least[k] += echo_weight * heard_apart(new, stored, size)
    return least, by


@njit(cache=True, nogil=True, inline="always")
def sum_apart(stored: Features, new: Features, mask: Features, first: int, end: int) -> np.int32:
    """The sum of absolute differences of these bytes, of the stored view where the mask has 255.

    LLVM turns int32 arithmetic (np.add, np.subtract keep the type) over a fixed number of bytes into one instruction
    for 16 differences. Hence every shift covers all bytes, masked where nothing overlaps.
    """
    total = np.int32(0)
    for k in range(first, end):
        apart = np.subtract(np.int32(stored[k] & mask[k]), np.int32(new[k]))
        total = np.add(total, np.abs(apart))
    return total


@njit(cache=True, nogil=True)
def shift_all(new: Features, most: int, columns: int, rows: int, shifted: Bytes) -> tuple[slice, Floats]:
    """Write the new view, shift by shift, into its rows; which rows these are, and how many bytes overlap in each."""
    first = columns - 1 - most
    widths = np.empty(2 * most + 1)
    for row in range(first, columns + most):
        here, there, width = overlap(row - columns + 1, columns, rows)
        widths[row - first] = width
        for k in range(width):
            shifted[row, there + k] = new[here + k]
    return slice(first, columns + most), widths


@njit(cache=True, nogil=True, inline="always")
def heard_apart(new: Features, stored: Features, first: int) -> float:
    """Mean absolute difference of the echoes, which begin at byte `first`; one that is unknown (0) counts as equal."""
    total = 0
    for k in range(first, len(new)):
        if new[k] > 0 and stored[k] > 0:
            total += abs(np.int64(new[k]) - np.int64(stored[k]))
    return total / (len(new) - first)


@njit(cache=True, nogil=True)
def sub_column(new: Features, stored: Features, shift: int, columns: int, rows: int) -> float:
    """The shift to a fraction of a column: where the flanks of the difference on both sides of its minimum meet."""
    left = difference(new, stored, shift - 1, columns, rows)
    least = difference(new, stored, shift, columns, rows)
    right = difference(new, stored, shift + 1, columns, rows)
    steepest = max(left, right) - least
    return shift + (left - right) / (2 * steepest) if steepest > 0 else float(shift)


@njit(cache=True, nogil=True)
def _nearest(
    known: Bytes, new: Features, most: int, columns: int, rows: int, shifted: Bytes, masks: Bytes, least: Ints32,
    at: Ints,
) -> tuple[int, float, int]:  # fmt: skip
    tried, widths = shift_all(new, most, columns, rows, shifted)
    if known.shape[1] == SIZE:  # five times as quick with the size as a constant
        _least_sums(known, shifted[tried], masks[tried], SIZE, least, at)
    else:
        _least_sums(known, shifted[tried], masks[tried], known.shape[1], least, at)
    best, smallest, by = -1, np.inf, 0
    for row in range(2 * most + 1):
        mean = least[row] / widths[row]
        if mean < smallest:
            best, smallest, by = at[row], mean, row - most
    return best, smallest, by


@njit(cache=True, nogil=True, inline="always")
def _least_sums(known: Bytes, shifted: Bytes, masks: Bytes, size: int, least: Ints32, at: Ints) -> None:
    """For each shift, the least sum of absolute differences and the first view that has it."""
    least[:] = 1 << 30
    at[:] = -1
    for first in range(0, len(known), BLOCK):
        block = known[first : first + BLOCK]
        for s in range(len(shifted)):
            new, mask = shifted[s], masks[s]
            best, which = least[s], at[s]
            for i in range(len(block)):
                total = sum_apart(block[i], new, mask, 0, size)
                if total < best:
                    best, which = total, first + i
            least[s], at[s] = best, which
