"""A loop has one plateau: where the times on the two ways round meet. It moves towards the goal on the slower way."""

from __future__ import annotations

import numpy as np
import pytest

from ratslam_core import GoalMemory
from ratslam_core.goal_memory import lead_s

from .goal_drives import CELL_M, SHAPE, drive

# a loop of 16 m: the goal is in the middle of its left side
LEFT, TOP, RIGHT, BOTTOM = (16.0, 32.0), [(16.0, 40.0), (40.0, 40.0)], (40.0, 32.0), [(40.0, 24.0), (16.0, 24.0)]
APART_M = 2.0


def plateau(top_speed: float) -> tuple[float, float]:
    """The middle of the cells on the drive round that no way leads by more than 0.3 s, (x, y)."""
    memory = GoalMemory(None, SHAPE, CELL_M)
    time_s = drive(memory, [LEFT, *TOP, RIGHT], top_speed)
    drive(memory, [RIGHT, *BOTTOM, LEFT], 0.4, time_s)
    y, x = np.nonzero(lead_s(memory, memory.times_to(16, 32), APART_M) < 0.3)
    return float(np.median(x)), float(np.median(y))


def test_where_one_way_is_slow_the_plateau_moves_into_it() -> None:
    x, y = plateau(0.4)  # equal speed: it is opposite the goal
    assert (x, y) == (pytest.approx(40, abs=3), pytest.approx(32, abs=6))
    x, y = plateau(0.16)
    assert 20 < x < 36
    assert y == pytest.approx(40, abs=4)


def test_a_way_without_another_has_no_plateau() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    drive(memory, [LEFT, *TOP, RIGHT], 0.4)
    assert np.isinf(lead_s(memory, memory.times_to(16, 32), APART_M)).all()
    with pytest.raises(ValueError, match=r"T must have shape \(64, 64\)"):
        lead_s(memory, np.zeros((3, 3)))
