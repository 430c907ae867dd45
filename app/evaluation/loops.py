"""Which loops of the floor a map has closed.

A look that joins two experiences closes a loop: from where the first was made the robot drove to where the second was
made, and the look says that both are one place. How often that way winds round each island of the floor (a block of
houses, the core of a corridor loop) is a row of whole numbers. As many loops are closed as these rows are independent.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.evaluation.looks import Births


def loops_closed(ends: NDArray[np.int64], births: Births, path: NDArray[np.float64], islands: NDArray[np.float64],
                 tick_s: float) -> int:  # fmt: skip
    """How many independent loops round `islands`, (k, 2) points in them, are closed by links between `ends`, (m, 2).

    births: (n, 4) of the experiences; path: where the robot truly was in each tick, (ticks, 2), tick_s apart.
    Links whose ends are not where one of the two was made must have been left out.
    """
    if len(ends) == 0 or len(islands) == 0:
        return 0
    made_s: NDArray[np.float64] = births[ends, 3]
    ticks = np.minimum(np.round(made_s / tick_s).astype(np.int64), len(path) - 1)  # (m, 2)
    turns = [_turns(path - island, ticks) for island in islands]
    return int(np.linalg.matrix_rank(np.unique(np.stack(turns, axis=1), axis=0)))


def _turns(path: NDArray[np.float64], ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    """How often the path winds round (0, 0) from the first to the second tick of each pair, and straight back; (m,)."""
    angle: NDArray[np.float64] = np.unwrap(np.arctan2(path[:, 1], path[:, 0]))
    return np.round((angle[ticks[:, 1]] - angle[ticks[:, 0]]) / (2 * np.pi))
