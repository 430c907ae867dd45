"""Keeps the labels over a plate from covering one another: what may move gives way to what stays where it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEAN_RAD = math.radians(90 - 50)  # labels face a camera 50 degrees above the horizon
GAP = 0.08  # plate units
NEAR = 8  # labels around which a free place is looked for first
Array = NDArray[np.float64]
Place = tuple[float, float, float]
TAG, ROUTE, CLOSURE, GHOST, ERROR = range(5)  # the later one gives way


def clear_place(at: Array, size: Array, taken: Array, room: Array, gap: float) -> Array:
    """The place nearest to `at` (2,) where the bar of a label covers nothing; where there is none, `at` within the room.

    size: (2,) of the bar; taken: (n, 4) middles and sizes of bars; room: (2, 2) its lower left corner and its upper right one.
    """
    low, high = room[0] + size / 2, room[1] - size / 2
    low, high = np.minimum(low, (low + high) / 2), np.maximum(high, (low + high) / 2)
    wanted = np.clip(at, low, high)
    reach = (taken[:, 2:] + size) / 2 + gap
    order = np.argsort(np.abs((taken[:, :2] - wanted) / np.maximum(reach, 1e-9)).max(1), kind="stable")
    for some in (order[:NEAR], order):
        across, up = (
            np.concatenate([wanted[k : k + 1], taken[some, k] - reach[some, k], taken[some, k] + reach[some, k]])
            for k in (0, 1)
        )
        places = np.stack(np.meshgrid(across, up), -1).reshape(-1, 2)
        places = places[((places >= low) & (places <= high)).all(1)]
        covers = (np.abs(places[:, None] - taken[:, :2]) < reach - 1e-9).all(axis=2)
        free = places[~np.any(covers, axis=1)]
        if len(free):
            return free[np.hypot(*(free - wanted).T).argmin()]
    return wanted


@dataclass
class _Label:
    rank: int
    at: Place
    size: tuple[float, float]
    move: Callable[[Place], None]
    bar: Array | None = None  # (4,) as it is seen; None: it has no place yet


class LabelRoom:
    """The labels of one plate, as an eye before it sees them. One that has to give way moves aside, forwards or backwards."""

    def __init__(self, half: tuple[float, float]) -> None:
        """half: of the width and of the depth in which labels are kept, plate units."""
        self._room = np.array([_seen((-half[0], -half[1], 0.0)), _seen((half[0], half[1], 1.5))])
        self._fixed: dict[Hashable, Array] = {}
        self._labels: dict[Hashable, _Label] = {}

    def fix(self, owner: Hashable, labels: Sequence[tuple[Place, float, float]]) -> None:
        """These labels of an owner, each with its place, width and height, stay where they are; there are no others of it."""
        bars = np.array([(*_seen(at), width, height) for at, width, height in labels]).reshape(-1, 4)
        if not np.array_equal(bars, self._fixed.get(owner, np.zeros((0, 4)))):
            self._fixed[owner] = bars
            self._settle(TAG)

    def put(
        self, owner: Hashable, rank: int, at: Place, size: tuple[float, float], move: Callable[[Place], None]
    ) -> None:
        """A label that would be best `at` a place. move: takes it to one."""
        self._labels[owner] = _Label(rank, at, size, move)
        self._settle(rank)

    def leave(self, owner: Hashable) -> None:
        label = self._labels.pop(owner, None)
        if label is not None:
            self._settle(label.rank)

    def _settle(self, rank: int) -> None:
        """Gives all labels from a rank on their places."""
        taken = np.vstack([np.zeros((0, 4)), *self._fixed.values()])
        for label in sorted(self._labels.values(), key=lambda label: label.rank):
            if label.rank >= rank or label.bar is None:
                wanted, size = _seen(label.at), np.array(label.size)
                bar = np.concatenate([clear_place(wanted, size, taken, self._room, GAP), size])
                if label.bar is None or not np.array_equal(bar, label.bar):
                    label.bar = bar
                    aside, up = (bar[:2] - wanted).tolist()
                    label.move((label.at[0] + aside, label.at[1] + up / math.cos(LEAN_RAD), label.at[2]))
            taken = np.vstack([taken, label.bar])


def _seen(at: Place) -> Array:
    """(2,) a place of the plate in the plane in which labels lie."""
    return np.array([at[0], at[1] * math.cos(LEAN_RAD) + at[2] * math.sin(LEAN_RAD)])
