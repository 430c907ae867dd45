"""A loop has one plateau: where the times on the two ways round meet. It moves towards the goal on the slower way."""

from __future__ import annotations

import numpy as np
import pytest

from ratslam_core import GoalMemory
from ratslam_core.goal_plateau import lead_s

from .goal_drives import CELL_M, SHAPE, Place, drive

# a loop of 16 m: the goal is in the middle of its left side
LEFT, TOP, RIGHT, BOTTOM = (16.0, 32.0), [(16.0, 40.0), (40.0, 40.0)], (40.0, 32.0), [(40.0, 24.0), (16.0, 24.0)]
APART_M = 2.0


def driven_round(top_speed: float) -> tuple[GoalMemory, np.ndarray]:
    memory = GoalMemory(None, SHAPE, CELL_M)
    way: list[Place] = [LEFT, *TOP, RIGHT]
    time_s = drive(memory, way, top_speed)
    drive(memory, [RIGHT, *BOTTOM, LEFT], 0.4, time_s)
    return memory, memory.times_to(16, 32)


def plateau(memory: GoalMemory, T: np.ndarray) -> np.ndarray:
    """The middle of the cells on the drive that no way leads by more than 0.3 s, (x, y)."""
    lead = lead_s(memory, T, APART_M)
    y, x = np.nonzero(lead < 0.3)
    assert len(x) > 0
    return np.array([np.median(x), np.median(y)])


def test_at_equal_speed_the_plateau_is_opposite_the_goal() -> None:
    memory, T = driven_round(0.4)
    x, y = plateau(memory, T)
    assert x == pytest.approx(40, abs=3)
    assert y == pytest.approx(32, abs=6)


def test_where_one_way_is_slow_the_plateau_moves_into_it() -> None:
    memory, T = driven_round(0.16)
    x, y = plateau(memory, T)
    assert 20 < x < 36
    assert y == pytest.approx(40, abs=4)


def test_a_way_without_another_has_no_plateau() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    drive(memory, [LEFT, *TOP, RIGHT], 0.4)
    assert np.isinf(lead_s(memory, memory.times_to(16, 32), APART_M)).all()


def test_the_times_must_be_those_of_the_memory() -> None:
    with pytest.raises(ValueError, match=r"T must have shape \(64, 64\)"):
        lead_s(GoalMemory(None, SHAPE, CELL_M), np.zeros((3, 3)))
