"""How much of the floor a robot has covered: from which it could drive to its path within a metre."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from disk import kind
from sim2d import FreeSpace

NEAR_M = 1.0


@kind("coverage/1")
class Coverage:
    """Follows a path as it grows. The work is that of what is new."""

    CACHES = ("_floor",)

    def __init__(self) -> None:
        self._floor: FreeSpace | None = None
        self._covered: NDArray[np.bool_] = np.zeros((0, 0), np.bool_)
        self._count = self._followed = 0

    def settle(self, floor: FreeSpace) -> None:
        """Go on, on this floor, after having been restored. On a floor of another size, begin anew."""
        self._floor = floor if self._covered.shape == tuple(floor.grid) else None

    def follow(self, floor: FreeSpace, path: NDArray[np.float64]) -> float:
        """The share of this floor that a path, (n, 2) m, covers. Another floor or a shorter path begins anew."""
        if floor is not self._floor or len(path) < self._followed:
            self._floor, self._covered = floor, np.zeros(floor.grid, np.bool_)
            self._count = self._followed = 0
        self._count += floor.cover(self._covered, path[self._followed :], NEAR_M)
        self._followed = len(path)
        return self._count / max(1, floor.floor_cells)
