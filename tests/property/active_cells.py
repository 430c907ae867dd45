"""Sets of active cells as the kernels take them, made from dense activity and turned back into it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Shape = tuple[int, int, int]  # n_theta, n_y, n_x


@dataclass
class Active:
    """The first n rows of cells and values, and the slot that indexes them."""

    shape: Shape
    cells: NDArray[np.int32]
    values: NDArray[np.float32]
    slot: NDArray[np.int32]
    n: int

    def dense(self) -> NDArray[np.float64]:
        """The activity, shape (n_theta, n_y, n_x), after a look at whether rows, flat indices and slot agree."""
        rows, values = self.cells[: self.n], self.values[: self.n].astype(float)
        flats = (rows[:, 2] * self.shape[1] + rows[:, 1]) * self.shape[2] + rows[:, 0]
        assert rows[:, 3].tolist() == flats.tolist()
        expected = np.zeros_like(self.slot)
        expected[flats] = np.arange(self.n) + 1
        assert self.slot.tolist() == expected.tolist()
        dense = np.zeros(self.slot.size)
        dense[flats] = values
        return dense.reshape(self.shape)

    def empty(self) -> Active:
        """Room for a result, with the same slot."""
        return Active(self.shape, np.zeros_like(self.cells), np.zeros_like(self.values), self.slot, 0)


def active(flats: NDArray[np.int64], values: NDArray[np.float64], shape: Shape) -> Active:
    """These cells in this order, with room for all cells there are."""
    size, n = int(np.prod(shape)), len(flats)
    cells, slot, room = np.zeros((size, 4), np.int32), np.zeros(size, np.int32), np.zeros(size, np.float32)
    cells[:n, 2], cells[:n, 1], cells[:n, 0] = np.unravel_index(flats, shape)
    cells[:n, 3], room[:n] = flats, values
    slot[flats] = np.arange(n) + 1
    return Active(shape, cells, room, slot, n)


def scattered(rng: np.random.Generator, shape: Shape, middles: int, most: int, spread: int) -> NDArray[np.int64]:
    """Flat indices of cells around a few middles anywhere, in the order of the layers; none twice."""
    at = rng.integers(0, shape, (middles, 3))[rng.integers(0, middles, most)]
    places = (at + rng.integers(-spread, spread + 1, (most, 3))) % shape
    return np.unique(np.ravel_multi_index(tuple(places.T), shape))


def shorter(apart: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """Offsets on a ring, the shorter way round."""
    return (apart + size // 2) % size - size // 2
