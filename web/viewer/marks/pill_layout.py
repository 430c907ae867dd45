"""Keeps pills from covering each other, by pushing overlapping bars apart in the plane in which they are seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

GAP = 0.1


def spread(
    centres: NDArray[np.float64], widths: NDArray[np.float64], height: float, rounds: int = 60
) -> NDArray[np.float64]:
    """(n, 2) centres, moved no more than needed so that no two bars overlap; the first of a pair moves less."""
    places = np.array(centres, np.float64)
    for _ in range(rounds):
        moved = False
        for i in range(len(places)):
            for j in range(i + 1, len(places)):
                moved |= _part(places, i, j, (widths[i] + widths[j]) / 2 + GAP, height + GAP)
        if not moved:
            return places
    return _stacked(places, height)


def overlap(a: NDArray[np.float64], b: NDArray[np.float64], width: float, height: float) -> bool:
    """Whether two bars overlap. width, height: the sums of their half widths and of their half heights."""
    return bool(abs(a[0] - b[0]) < width - 1e-9 and abs(a[1] - b[1]) < height - 1e-9)


def _part(places: NDArray[np.float64], i: int, j: int, width: float, height: float) -> bool:
    if not overlap(places[i], places[j], width, height):
        return False
    apart = places[j] - places[i]
    across, up = width - abs(apart[0]), height - abs(apart[1])
    axis, lack = (1, up) if up <= across else (0, across)
    side = 1.0 if apart[axis] >= 0 else -1.0
    places[i, axis] -= side * (lack * 0.3 + 1e-6)
    places[j, axis] += side * (lack * 0.7 + 1e-6)
    return True


def _stacked(places: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """A layout that always works: one above the other, in the order of their heights."""
    order = np.argsort(places[:, 1], kind="stable")
    floor = -np.inf
    for row in order:
        places[row, 1] = floor = max(places[row, 1], floor + height + GAP)
    return places
