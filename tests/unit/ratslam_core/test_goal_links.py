"""The links of the goal memory: what is learnt from packets, and what is refused without a trace."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core import GoalMemory, GoalMemoryParams, Packet, goal_memory
from ratslam_core.goal_memory import ARRIVED, REACH, WIDER

from .goal_drives import CELL_M, SHAPE, packet_cells
from .literal import also_interpreted


@also_interpreted(goal_memory)
def test_a_weaker_packet_takes_part_but_does_not_say_where_the_robot_is() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    for k, x in enumerate((10.0, 11.0, 12.0)):
        cells, activity = packet_cells(x, 10)
        rival, weaker = packet_cells(63 - 7 * k, 40)
        both = np.concatenate([0.6 * activity, 0.4 * weaker]).astype(np.float32)
        memory.learn(np.concatenate([cells, rival]), both, 1.0 + k)
        assert (len(memory) > 0) == (k == 2)  # a stride is reached after two cells, however far the rival packet moved
    link = 2 + 0.25 * (1 - 0.4 / 0.6) + 0.1 * math.hypot(13, 30)
    assert memory.times_to(12, 10)[40, 63] == pytest.approx(link, rel=1e-3)


@also_interpreted(goal_memory)
def test_wrong_cells_leave_no_trace() -> None:
    """After a call that was refused, the next one is right."""
    memory, fresh = GoalMemory(None, SHAPE, CELL_M), GoalMemory(None, SHAPE, CELL_M)
    cells, activity = packet_cells(10, 10)
    cells[20, 0] = 99
    with pytest.raises(ValueError, match="must lie in"):
        memory.learn(cells, activity, 1.0)
    for each in (memory, fresh):
        each.learn(*packet_cells(20, 20), 2.0)
        each.learn(*packet_cells(23, 20), 3.0)
    for part in (0, 1):
        assert np.array_equal(memory.links[part], fresh.links[part])


def single(x: int, y: int, *more: tuple[int, int, float], value: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """One active cell, and others: x, y, activity."""
    rows = [(x, y, value), *more]
    cells = np.array([(at_x, at_y, 0, at_y * SHAPE[2] + at_x) for at_x, at_y, _ in rows], np.int32)
    return cells, np.array([activity for *_, activity in rows], np.float32)


def test_shares_and_strides_are_reached_just_as_they_are() -> None:
    """A cell at the share is not above it; half a metre is two cells."""
    for activity, x, links in ((0.25, 20, 1), (0.2501, 20, 2), (0.25, 11, 0), (0.25, 12, 1)):
        memory = GoalMemory(GoalMemoryParams(share=0.5), SHAPE, CELL_M)
        memory.learn(*single(10, 10, (10, 11, activity)), 1.0)
        memory.learn(*single(x, 10), 2.0)
        assert len(memory) == links


@also_interpreted(goal_memory)
def test_the_centre_is_that_of_what_is_near_the_strongest() -> None:
    """As far as `near` cells along each axis, round the torus, and no farther."""
    values = np.array([0.5, 0.25])
    for x, y in ((10, 10), (1, 62)):
        for dx, dy in ((3, 0), (-3, 0), (0, 3), (0, -3), (3, -3), (4, 0), (0, -4), (-4, 1), (1, 4)):
            flats = np.array([y * 64 + x, (y + dy) % 64 * 64 + (x + dx) % 64])
            part = 1 / 3 if max(abs(dx), abs(dy)) <= 3 else 0.0
            expected = (x + part * dx) % 64, (y + part * dy) % 64
            assert goal_memory.centre(flats, values, SHAPE, 3) == pytest.approx(expected)


@also_interpreted(goal_memory)
def test_a_link_takes_twelve_bytes_and_is_never_more_than_half_of_the_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(goal_memory, "ROOM", 4)
    memory, plane = GoalMemory(None, SHAPE, CELL_M), 4 * SHAPE[1] * SHAPE[2]
    assert memory.memory_bytes == 12 * 4 + plane
    for k in range(20):
        memory.learn(*single(3 * k, 10), 1.0 + k)
        assert len(memory) == k
        room = (memory.memory_bytes - plane) / 12
        assert max(4, 2 * k) <= room <= max(4, 4 * k)
    memory = GoalMemory(GoalMemoryParams(share=0.0), SHAPE, CELL_M)  # there is room for all links between two packets
    memory.learn(*packet_cells(10, 10), 1.0)
    memory.learn(*packet_cells(30, 10), 2.0)
    assert len(memory) == 81 * 81
    assert memory.memory_bytes - plane >= 24 * len(memory)


@also_interpreted(goal_memory)
def test_a_cell_is_in_reach_up_to_the_limit() -> None:
    """Where nothing has been learnt yet, any known cell within the reach will do, on all sides and round the torus."""
    none = np.full(8, goal_memory.FREE)
    for dx, dy, found in (
        *((3, 0, True), (-3, 0, True), (0, 3, True), (0, -3, True), (2, 2, True), (-2, 2, True)),
        *((3, 1, False), (-1, 3, False), (4, 0, False), (0, -4, False), (3, 3, False)),
    ):
        T = np.full((64, 64), np.inf)
        there = (1 + dy) % 64, (62 + dx) % 64
        T[there] = 7.0
        assert goal_memory.lowest(T, 62, 1, 3, none) == (there[0] * 64 + there[1] if found else -1)


def test_it_looks_as_far_as_it_may_and_has_arrived_just_at_the_limit() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    for x, y, heading in (
        (10.0 - REACH, 30.0, 0.0), (10.0, 30.0 - 2 * REACH, math.pi / 2), (10.0 - WIDER * REACH, 30.0, 0.0),
        (9.0 - WIDER * REACH, 30.0, None), (10.0 + ARRIVED, 30.0, None), (10.1 + ARRIVED, 30.0, math.pi),
        (8.0, 29.0, math.atan2(1.0, 2.0)),
    ):  # fmt: skip
        T = np.full((64, 64), np.inf)
        T[30, 10] = 0.0
        assert memory.direction(T, Packet(x % 64, y, 0.0, 1.0)) == (heading and pytest.approx(heading)), (x, y)
