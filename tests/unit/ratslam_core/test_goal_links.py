"""The links of the goal memory: what is learnt from packets, and what is refused without a trace."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ratslam_core import GoalMemory, GoalMemoryParams, Packet, goal_links, goal_memory
from ratslam_core.goal_memory import ARRIVED, REACH, WIDER

from . import literal
from .goal_drives import CELL_M, SHAPE, SHORT_AND_SLOW, Place, drive, packet_cells


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_small_memory_by_hand(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """C1-C5 with numbers: two cells in one iteration, two in the next, and then again."""
    if interpreted:
        literal.interpret(goal_links, monkeypatch)
    monkeypatch.setattr(goal_memory, "ROOM", 2)
    memory = GoalMemory(GoalMemoryParams(stride_m=0.0, share=0.3, rate=0.5), (2, 5, 8), CELL_M)
    # (0, 0) holds 0.5 + 0.1 over two headings, (1, 0) holds 0.4, (5, 4) is below the share
    cells = np.array([(0, 0, 0, 0), (1, 0, 0, 1), (0, 0, 1, 40), (5, 4, 0, 37)], np.int32)
    memory.learn(cells, np.array([0.5, 0.4, 0.1, 0.1], np.float32), 10.0)
    assert len(memory) == 0
    # (7, 4) is diagonally across the corner from (0, 0), (0, 0) stays active
    cells = np.array([(7, 4, 1, 79), (0, 0, 0, 0)], np.int32)
    memory.learn(cells, np.array([0.8, 0.4], np.float32), 12.0)

    def tau(elapsed: float, G_i: float, G_j: float, most: float, apart: float) -> float:
        return 1.0 * elapsed + 0.25 * (1 - G_i * G_j / most**2) + 0.1 * apart

    expected = {
        (0, 39): tau(2, 0.6, 0.8, 0.8, math.sqrt(2)),
        (1, 39): tau(2, 0.4, 0.8, 0.8, math.sqrt(5)),
        (0, 1): tau(2, 0.4, 0.4, 0.8, 1),
    }
    pairs, times = memory.links
    got = dict(zip(map(tuple, pairs.tolist()), times.tolist(), strict=True))
    assert got == pytest.approx(expected)
    memory.learn(cells[1:], np.array([0.9], np.float32), 12.5)
    pairs, times = memory.links
    got = dict(zip(map(tuple, pairs.tolist()), times.tolist(), strict=True))
    expected[0, 39] = 0.5 * expected[0, 39] + 0.5 * tau(0.5, 0.8, 0.9, 0.9, math.sqrt(2))
    assert got == pytest.approx(expected)
    T = memory.times_to(0, 0)
    assert T.shape == (5, 8)
    assert (T[0, 0], T[4, 7], T[0, 1]) == pytest.approx((0, expected[0, 39], expected[0, 1]))
    assert np.isinf(T).sum() == 37
    assert memory.direction(T, Packet(6.2, 3.4, 0.0, 1.0)) == pytest.approx(math.atan2(1.6, 1.8))  # nothing known here
    assert memory.direction(T, Packet(7.0, 4.0, 0.0, 1.0)) == pytest.approx(math.pi / 4)
    assert memory.direction(T, Packet(7.3, 4.4, 0.0, 1.0)) is None  # arrived, across the corner
    assert memory.direction(T, Packet(4.0, 2.0, 0.0, 1.0)) is not None
    assert memory.direction(np.full((5, 8), np.inf), Packet(4.0, 2.0, 0.0, 1.0)) is None
    assert memory.memory_bytes >= 12 * 3 + 4 * 40


def test_a_leap_of_the_packet_is_linked_but_is_no_direction() -> None:
    """C V.E: the same place in two parts of the pose cells. There is a time between them, but no direction to drive."""
    memory = GoalMemory(None, SHAPE, CELL_M)
    memory.learn(*packet_cells(10, 10), 1.0)
    memory.learn(*packet_cells(40, 40), 1.1)
    T = memory.times_to(40, 40)
    assert T[10, 10] == pytest.approx(0.1 + 0.1 * math.hypot(30, 30), rel=1e-5)
    assert memory.direction(T, Packet(10.0, 10.0, 0.0, 1.0)) is None


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_weaker_packet_takes_part_but_does_not_say_where_the_robot_is(
    interpreted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if interpreted:
        literal.interpret(goal_links, monkeypatch)
    memory = GoalMemory(None, SHAPE, CELL_M)
    for k, x in enumerate((10.0, 11.0, 12.0)):
        cells, activity = packet_cells(x, 10)
        rival, weaker = packet_cells(63 - 7 * k, 40)
        both = np.concatenate([0.6 * activity, 0.4 * weaker]).astype(np.float32)
        memory.learn(np.concatenate([cells, rival]), both, 1.0 + k)
        assert (len(memory) > 0) == (k == 2)  # a stride is reached after two cells, however far the rival packet moved
    link = 2 + 0.25 * (1 - 0.4 / 0.6) + 0.1 * math.hypot(13, 30)
    assert memory.times_to(12, 10)[40, 63] == pytest.approx(link, rel=1e-3)


def test_a_robot_that_stands_learns_nothing_until_it_moves() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    for k in range(50):
        memory.learn(*packet_cells(10, 10), 0.1 * (k + 1))
    assert len(memory) == 0
    memory.learn(*packet_cells(12, 10), 5.1)
    back = math.exp(-(2**2) / 1.8**2)  # the same link the other way: both ends active, but weakly
    expected = 5.0 + 0.2 + 0.2 * 0.25 * (1 - back)
    assert memory.times_to(12, 10)[10, 10] == pytest.approx(expected, rel=1e-3)


def test_what_is_learnt_later_changes_the_times() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    time_s = drive(memory, SHORT_AND_SLOW, 0.1)
    before = memory.times_to(38, 30)[30, 12]
    for _ in range(5):
        time_s = drive(memory, [*SHORT_AND_SLOW, SHORT_AND_SLOW[0]], 0.5, time_s)
    assert memory.times_to(38, 30)[30, 12] < 0.6 * before


def test_links_grow_with_the_places_seen_and_not_with_time() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    corners: list[Place] = [(10, 10), (50, 10), (50, 50), (10, 50), (10, 10)]
    time_s = drive(memory, corners, 0.5)
    first, room = len(memory), memory.memory_bytes
    for _ in range(3):
        time_s = drive(memory, corners, 0.5, time_s)
    assert len(memory) < 1.5 * first
    assert memory.memory_bytes <= 2 * room < 2_000_000


def test_wrong_cells_leave_no_trace(monkeypatch: pytest.MonkeyPatch) -> None:
    """After a call that was refused, the next one is right, compiled and interpreted."""
    for interpreted in (False, True):
        if interpreted:
            literal.interpret(goal_links, monkeypatch)
        memory, fresh = GoalMemory(None, SHAPE, CELL_M), GoalMemory(None, SHAPE, CELL_M)
        cells, activity = packet_cells(10, 10)
        cells[20, 0] = 99
        with pytest.raises(ValueError, match="must lie in"):
            memory.learn(cells, activity, 1.0)
        for each in (memory, fresh):
            each.learn(*packet_cells(20, 20), 2.0)
            each.learn(*packet_cells(23, 20), 3.0)
        assert np.array_equal(memory.links[0], fresh.links[0])
        assert np.array_equal(memory.links[1], fresh.links[1])


def single(x: int, y: int, *more: tuple[int, int, float], value: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """One active cell, and others: x, y, activity."""
    rows = [(x, y, value), *more]
    cells = np.array([(at_x, at_y, 0, at_y * SHAPE[2] + at_x) for at_x, at_y, _ in rows], np.int32)
    return cells, np.array([activity for *_, activity in rows], np.float32)


def test_a_cell_just_at_the_share_is_not_above_it() -> None:
    for activity, links in ((0.25, 1), (0.2501, 2)):
        memory = GoalMemory(GoalMemoryParams(share=0.5), SHAPE, CELL_M)
        memory.learn(*single(10, 10, (11, 10, activity)), 1.0)
        memory.learn(*single(20, 10), 2.0)
        assert len(memory) == links


@pytest.mark.parametrize("interpreted", [False, True])
def test_the_centre_is_that_of_what_is_near_the_strongest(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """As far as `near` cells along each axis, round the torus, and no farther."""
    if interpreted:
        literal.interpret(goal_links, monkeypatch)
    values = np.array([0.5, 0.25])
    for x, y in ((10, 10), (1, 62)):
        for dx, dy in ((3, 0), (-3, 0), (0, 3), (0, -3), (3, -3), (4, 0), (0, -4), (-4, 1), (1, 4)):
            flats = np.array([y * 64 + x, (y + dy) % 64 * 64 + (x + dx) % 64])
            part = 1 / 3 if max(abs(dx), abs(dy)) <= 3 else 0.0
            expected = (x + part * dx) % 64, (y + part * dy) % 64
            assert goal_links.centre(flats, values, SHAPE, 3) == pytest.approx(expected)


def test_a_stride_is_reached_just_as_it_is_reached() -> None:
    for x, links in ((11, 0), (12, 1)):  # half a metre is two cells
        memory = GoalMemory(None, SHAPE, CELL_M)
        memory.learn(*single(10, 10), 1.0)
        memory.learn(*single(x, 10), 2.0)
        assert len(memory) == links


def test_a_link_takes_twelve_bytes_and_is_never_more_than_half_of_the_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(goal_memory, "ROOM", 4)
    memory = GoalMemory(None, SHAPE, CELL_M)
    plane = 4 * SHAPE[1] * SHAPE[2]
    assert memory.memory_bytes == 12 * 4 + plane
    for k in range(20):
        memory.learn(*single(3 * k, 10), 1.0 + k)
        assert len(memory) == k
        room = (memory.memory_bytes - plane) / 12
        assert max(4, 2 * k) <= room <= max(4, 4 * k)


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_cell_is_in_reach_up_to_the_limit(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing has been learnt yet, any known cell within the reach will do, on all sides and round the torus."""
    if interpreted:
        literal.interpret(goal_links, monkeypatch)
    none = np.full(8, goal_links.FREE)
    for dx, dy, found in (
        *((3, 0, True), (-3, 0, True), (0, 3, True), (0, -3, True), (2, 2, True), (-2, 2, True)),
        *((3, 1, False), (-1, 3, False), (4, 0, False), (0, -4, False), (3, 3, False)),
    ):
        T = np.full((64, 64), np.inf)
        there = (1 + dy) % 64, (62 + dx) % 64
        T[there] = 7.0
        assert goal_links.lowest(T, 62, 1, 3, none) == (there[0] * 64 + there[1] if found else -1)


def test_it_looks_as_far_as_it_may() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    for away, heading in ((REACH, 0.0), (2 * REACH, 0.0), (WIDER * REACH, 0.0), (WIDER * REACH + 1, None)):
        T = np.full((64, 64), np.inf)
        T[30, 10 + away] = 0.0
        assert memory.direction(T, Packet(10.0, 30.0, 0.0, 1.0)) == heading


def test_it_has_arrived_just_at_the_limit() -> None:
    memory = GoalMemory(None, SHAPE, CELL_M)
    T = np.full((64, 64), np.inf)
    T[30, 10] = 0.0
    assert memory.direction(T, Packet(10.0 + ARRIVED, 30.0, 0.0, 1.0)) is None
    assert memory.direction(T, Packet(10.1 + ARRIVED, 30.0, 0.0, 1.0)) == pytest.approx(math.pi)


def test_the_largest_plane_and_the_smallest_are_planes() -> None:
    for shape in ((1, 1024, 1024), (1, 1, 1)):
        assert len(GoalMemory(None, shape, CELL_M)) == 0


def test_there_is_room_for_all_links_between_two_packets(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(goal_memory, "ROOM", 2)
    memory = GoalMemory(GoalMemoryParams(share=0.0), SHAPE, CELL_M)
    memory.learn(*packet_cells(10, 10), 1.0)
    memory.learn(*packet_cells(30, 10), 2.0)
    assert len(memory) == 81 * 81
    assert memory.memory_bytes - 4 * SHAPE[1] * SHAPE[2] >= 24 * len(memory)
