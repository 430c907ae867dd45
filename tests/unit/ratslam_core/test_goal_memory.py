"""Times to a goal and directions to it, by what the goal memory has learnt, and what it refuses."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import GoalMemory, GoalMemoryParams, Packet, PoseCells, goal_links, goal_memory
from ratslam_core.goal_memory import ARRIVED

from . import literal
from .goal_drives import CELL_M, DT, SHAPE, SHORT_AND_SLOW, Place, drive, packet_cells

LONG_AND_FAST: list[Place] = [(40, 30), (40, 44), (10, 44), (10, 30)]


def two_ways(params: GoalMemoryParams) -> GoalMemory:
    """From (10, 30) to (40, 30) straight at 0.1 m/s, 75 s, and round the block at 0.4 m/s, 36 s."""
    memory = GoalMemory(params, SHAPE, CELL_M)
    arrived_s = drive(memory, SHORT_AND_SLOW, 0.1)
    drive(memory, LONG_AND_FAST, 0.4, arrived_s)
    return memory


def follow(memory: GoalMemory, T: NDArray, x: float, y: float) -> list[Place]:
    """Move half a cell at a time where the memory points, until it gives no direction."""
    way = [(x, y)]
    while len(way) < 1000:
        heading = memory.direction(T, Packet(x, y, 0.0, 1.0))
        if heading is None:
            break
        x = (x + 0.5 * math.cos(heading)) % memory.shape[2]
        y = (y + 0.5 * math.sin(heading)) % memory.shape[1]
        way.append((x, y))
    return way


def fixed_point(pairs: NDArray, tau: NDArray, size: int, goal: int) -> list[float]:
    """C6, literally: T_i <- min(T_i, min_j (T_j + tau_ji)) until nothing decreases."""
    T = [math.inf] * size
    T[goal] = 0.0
    links = [(int(i), int(j), float(t)) for (i, j), t in zip(pairs, tau, strict=True)]
    decreased = True
    while decreased:
        decreased = False
        for i, j, t in links:
            for a, b in ((i, j), (j, i)):
                if T[b] + t < T[a]:
                    T[a] = T[b] + t
                    decreased = True
    return T


@pytest.fixture(scope="module")
def explored() -> tuple[GoalMemory, PoseCells]:
    """A real packet on a winding way over a small torus."""
    pose_cells, rng = PoseCells(), np.random.default_rng(3)
    memory = GoalMemory(None, pose_cells.shape, CELL_M)
    for k in range(1500):
        turn = math.sin(k / 40) + float(rng.normal(0, 0.3))
        pose_cells.step(speed=float(rng.uniform(0.2, 0.6)), yaw_rate=turn, dt=DT)
        memory.learn(*pose_cells.active, DT * (k + 1))
    return memory, pose_cells


def test_times_are_the_fixed_point_of_equation_6(explored: tuple[GoalMemory, PoseCells]) -> None:
    memory, pose_cells = explored
    x, y = round(pose_cells.winner.x) % 64, round(pose_cells.winner.y) % 64
    T = memory.times_to(x, y)
    pairs, tau = memory.links
    assert len(pairs) == len(memory) > 1000
    assert T.ravel() == pytest.approx(fixed_point(pairs, tau, 64 * 64, y * 64 + x))
    assert np.isfinite(T).sum() > 200
    assert T[y, x] == 0 < np.sort(T.ravel())[1]


def test_there_are_no_local_minima(explored: tuple[GoalMemory, PoseCells]) -> None:
    """From wherever a way is known, following the direction arrives within one cell of the goal."""
    memory, pose_cells = explored
    goal_x, goal_y = round(pose_cells.winner.x) % 64, round(pose_cells.winner.y) % 64
    T = memory.times_to(goal_x, goal_y)
    for y, x in list(zip(*np.nonzero(np.isfinite(T)), strict=True))[::10]:
        end_x, end_y = follow(memory, T, float(x), float(y))[-1]
        assert math.hypot((end_x - goal_x + 32) % 64 - 32, (end_y - goal_y + 32) % 64 - 32) <= 1


def test_the_faster_way_wins_over_the_shorter_one() -> None:
    """Because linked packets are a stride apart. Linked in every iteration, as printed, the shorter way would seem faster."""
    memory = two_ways(GoalMemoryParams())
    T = memory.times_to(40, 30)
    assert max(y for _, y in follow(memory, T, 10, 30)) > 42
    slow = GoalMemory(None, SHAPE, CELL_M)
    drive(slow, SHORT_AND_SLOW, 0.1)
    assert slow.times_to(40, 30)[30, 10] > 1.2 * T[30, 10]

    printed = two_ways(GoalMemoryParams(stride_m=0.0))
    assert max(y for _, y in follow(printed, printed.times_to(40, 30), 10, 30)) < 34


def test_times_grow_with_the_time_that_a_way_took() -> None:
    times = []
    for speed in (0.4, 0.2, 0.1):
        memory = GoalMemory(None, SHAPE, CELL_M)
        drive(memory, SHORT_AND_SLOW, speed)
        times.append(memory.times_to(36, 30)[30, 12] / (24 * CELL_M / speed))
    # Links from the rear of a packet to the front of the next are longer than the stride: all times are too short.
    assert all(0.33 < part < 0.8 for part in times), times
    assert max(times) < 2 * min(times)  # over a fourfold range of speeds


@pytest.mark.slow
@pytest.mark.parametrize("name", [item.name for item in fields(GoalMemoryParams) if isinstance(item.default, float)])
@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_small_changes_of_the_parameters_keep_the_route(name: str, factor: float) -> None:
    """C IV.C: insensitive to small changes."""
    params = GoalMemoryParams()
    memory = two_ways(replace(params, **{name: factor * getattr(params, name)}))
    way = follow(memory, memory.times_to(40, 30), 10, 30)
    assert max(y for _, y in way) > 42
    assert math.dist(way[-1], (40, 30)) <= ARRIVED


@pytest.mark.parametrize("interpreted", [False, True])
def test_it_does_not_point_through_a_wall(interpreted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Down one corridor and back up the next, 1.5 m away. The goal's corridor is in reach, but its cells are not linked."""
    monkeypatch.setattr(goal_memory, "REACH", 4)
    memory = GoalMemory(None, SHAPE, CELL_M)
    drive(memory, [(10, 30), (40, 30), (40, 36), (10, 36)], 0.4)
    T = memory.times_to(12, 36)
    way = follow(memory, T, 14, 31)
    if interpreted:
        literal.interpret(goal_links, monkeypatch)
    heading = memory.direction(T, Packet(14.0, 31.0, 0.0, 1.0))
    assert heading is not None
    assert abs(heading) < math.radians(45)
    assert T[34:36, 13:16].min() < T[28:33, 10:19].min()  # the goal's corridor is lower, and within reach
    assert max(x for x, _ in way) > 35


@pytest.mark.parametrize("by", [(40, 0), (0, 30), (45, 29)])
def test_it_wraps_around(by: tuple[int, int]) -> None:
    """The same drive elsewhere on the torus gives the same times."""
    corners: list[Place] = [(20, 34), (40, 34), (40, 40)]
    here, there = GoalMemory(None, SHAPE, CELL_M), GoalMemory(None, SHAPE, CELL_M)
    drive(here, corners, 0.5)
    drive(there, [(x + by[0], y + by[1]) for x, y in corners], 0.5)
    goal = (40 + by[0]) % 64, (38 + by[1]) % 64
    T = here.times_to(40, 38)
    assert there.times_to(*goal) == pytest.approx(np.roll(T, (by[1], by[0]), (0, 1)), rel=1e-4)
    heading = here.direction(T, Packet(30.0, 34.0, 0.0, 1.0))
    moved = Packet((30.0 + by[0]) % 64, (34.0 + by[1]) % 64, 0.0, 1.0)
    assert there.direction(there.times_to(*goal), moved) == pytest.approx(heading)


def test_wrong_input_is_named() -> None:
    with pytest.raises(ValueError, match=r"shape must be .*got \(64, 64\)"):
        GoalMemory(None, (64, 64), 0.25)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="shape must be"):
        GoalMemory(None, (36, 0, 64), 0.25)
    with pytest.raises(ValueError, match="at most 1048576 cells in the plane"):
        GoalMemory(None, (1, 1025, 1024), 0.25)
    for cell_m in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match=f"cell_m must be a positive number of metres, got {cell_m!r}"):
            GoalMemory(None, SHAPE, cell_m)
    memory = GoalMemory(None, SHAPE, CELL_M)
    cells, activity = packet_cells(10, 10)
    with pytest.raises(ValueError, match="time_s must be a finite number, got nan"):
        memory.learn(cells, activity, math.nan)
    for wrong in (cells[:, :3], cells[0]):
        with pytest.raises(ValueError, match=r"cells must have shape \(n, 4\) and activity \(n,\)"):
            memory.learn(wrong, activity, 1.0)
    with pytest.raises(ValueError, match="cells must have shape"):
        memory.learn(cells, activity[1:], 1.0)
    for none in (activity * 0, activity * np.nan):
        with pytest.raises(ValueError, match="activity must be positive somewhere"):
            memory.learn(cells, none, 1.0)
    with pytest.raises(ValueError, match="activity must be positive somewhere"):
        memory.learn(cells[:0], activity[:0], 1.0)
    for axis, value in ((0, 64), (0, -1), (1, 64), (1, -1)):
        outside = cells.copy()
        outside[5, axis] = value
        with pytest.raises(ValueError, match=rf"cells must lie in 0..63, 0..63, got .*{value}"):
            memory.learn(outside, activity, 1.0)
    memory.learn(cells, activity, 1.0)
    for late in (1.0, 0.5):
        with pytest.raises(ValueError, match=f"time_s must be later than the time before, 1.0, got {late}"):
            memory.learn(cells, activity, late)
    memory.learn(cells, activity, 2.0)
    with pytest.raises(ValueError, match=r"later than the time before, 2\.0, got 1\.5"):
        memory.learn(cells, activity, 1.5)
    for x, y, name in ((64, 0, "x"), (-1, 0, "x"), (0, 64, "y"), (0.5, 0, "x"), (0, "1", "y")):
        with pytest.raises(ValueError, match=f"{name} must be a whole cell from 0 to 63, got "):
            memory.times_to(x, y)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"T must have shape \(64, 64\).*got \(3, 3\)"):
        memory.direction(np.zeros((3, 3)), Packet(1.0, 1.0, 0.0, 1.0))
    with pytest.raises(ValueError, match=r"packet\.y must be a finite number, got nan"):
        memory.direction(memory.times_to(10, 10), Packet(1.0, math.nan, 0.0, 1.0))
    with pytest.raises(ValueError, match="rate must be between"):
        GoalMemoryParams(rate=0.0)
