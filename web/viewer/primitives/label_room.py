"""Keeps the labels over a plate from covering one another: what may move gives way to what stays where it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

LEAN_RAD = math.radians(90 - 50)  # labels face a camera 50 degrees above the horizon
GAP = 0.08  # plate units
NEAR = 8  # labels around which a free place is looked for first
Array = NDArray[np.float64]
Place = tuple[float, float, float]
NAME, TAG, ROUTE, CLOSURE, ROBOT, GHOST, ERROR = range(7)  # the later one gives way


def clear_place(at: Array, size: Array, taken: Array, room: Array, gap: float) -> Array:
    """The place nearest to `at` (2,) where the bar of a label covers nothing; where there is none, `at` within the room.

    size: (2,) of the bar; taken: (n, 4) middles and sizes of bars; room: (2, 2) its lower left corner and its upper right one.
    """
    low, high = room[0] + size / 2, room[1] - size / 2
    low, high = np.minimum(low, (low + high) / 2), np.maximum(high, (low + high) / 2)
    wanted = np.clip(at, low, high)
    reach = (taken[:, 2:] + size) / 2 + gap
    order = np.argsort(np.abs((taken[:, :2] - wanted) / np.maximum(reach, 1e-9)).max(1), kind="stable")
    if not _covered(wanted[None], taken, reach)[0]:
        return wanted
    for some in (order[:NEAR], order[: 3 * NEAR], order):
        across, up = (
            np.concatenate([wanted[k : k + 1], taken[some, k] - reach[some, k], taken[some, k] + reach[some, k]])
            for k in (0, 1)
        )
        places = np.stack(np.meshgrid(across, up), -1).reshape(-1, 2)
        places = places[((places >= low) & (places <= high)).all(1)]
        free = places[~_covered(places, taken, reach)]
        if len(free):
            return free[np.hypot(*(free - wanted).T).argmin()]
    return wanted


def _covered(places: Array, taken: Array, reach: Array) -> NDArray[np.bool_]:
    """(k,) whether a bar at each place (k, 2) would cover one. reach: (n, 2) how far their middles must be apart."""
    across, up = (np.abs(places[:, k, None] - taken[:, k]) < reach[:, k] - 1e-9 for k in (0, 1))
    return np.any(across & up, axis=1)


@dataclass
class _Label:
    rank: int
    at: Place
    size: tuple[float, float]
    move: Callable[[Place], None]
    bar: Array = field(default_factory=lambda: np.full(4, np.nan))  # as it is seen; it has no place yet


class LabelRoom:
    """The labels of one plate, as an eye before it sees them. One that has to give way moves aside, forwards or backwards."""

    def __init__(self, half: tuple[float, float]) -> None:
        """half: of the width and of the depth in which labels are kept, plate units."""
        self._room = np.array([_seen((-half[0], -half[1], 0.0)), _seen((half[0], half[1], 1.5))])
        self._fixed: dict[Hashable, tuple[int, Array]] = {}
        self._labels: dict[Hashable, _Label] = {}

    def fix(self, owner: Hashable, things: Sequence[tuple[Place, float, float]], rank: int = NAME) -> None:
        """These labels or bodies of an owner, each with its place, width and height, stay where they are; there are no others
        of it."""
        bars = np.array([(*_seen(at), width, height) for at, width, height in things]).reshape(-1, 4)
        if not np.array_equal(bars, self._fixed.get(owner, (rank, np.zeros((0, 4))))[1]):
            self._fixed[owner] = rank, bars
            self._settle(rank)

    def put(
        self, owner: Hashable, rank: int, at: Place, size: tuple[float, float], move: Callable[[Place], None]
    ) -> None:
        """A label that would be best `at` a place. move: takes it to one."""
        self._labels[owner] = _Label(rank, at, size, move)
        self._settle(rank, owner)

    def leave(self, owner: Hashable) -> None:
        label = self._labels.pop(owner, None)
        if label is not None:
            self._settle(label.rank)

    def _settle(self, rank: int, owner: Hashable | None = None) -> None:
        """Gives all labels from a rank on their places; of that rank, those from this owner's on."""
        placed: list[Array] = []
        before = owner is not None
        for key, label in sorted(self._labels.items(), key=lambda item: item[1].rank):
            before = before and key != owner
            if label.rank >= rank and not before:
                fixed = [bars for first, bars in self._fixed.values() if first <= label.rank]
                taken = np.vstack([np.zeros((0, 4)), *fixed, *placed])
                wanted, size = _seen(label.at), np.array(label.size)
                bar = np.concatenate([clear_place(wanted, size, taken, self._room, GAP), size])
                if not np.array_equal(bar, label.bar):
                    label.bar = bar
                    aside, up = (bar[:2] - wanted).tolist()
                    label.move((label.at[0] + aside, label.at[1] + up / math.cos(LEAN_RAD), label.at[2]))
            placed.append(label.bar)


def _seen(at: Place) -> Array:
    """(2,) a place of the plate in the plane in which labels lie."""
    return np.array([at[0], at[1] * math.cos(LEAN_RAD) + at[2] * math.sin(LEAN_RAD)])
