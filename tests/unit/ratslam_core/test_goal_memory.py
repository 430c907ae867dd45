"""Times to a goal and directions to it, by what the goal memory has learnt, and what it refuses."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import GoalMemory, GoalMemoryParams, Packet, PoseCells, goal_memory
from ratslam_core.goal_memory import ARRIVED

from .goal_drives import CELL_M, DT, SHAPE, SHORT_AND_SLOW, Place, drive, packet_cells
from .literal import also_interpreted

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


def test_there_are_no_local_minima() -> None:
    """After a real packet's winding way: from wherever a way is known, the direction leads to within one cell of the goal."""
    pose_cells, rng = PoseCells(), np.random.default_rng(3)
    memory = GoalMemory(None, pose_cells.shape, CELL_M)
    for k in range(1500):
        turn = math.sin(k / 40) + float(rng.normal(0, 0.3))
        pose_cells.step(speed=float(rng.uniform(0.2, 0.6)), yaw_rate=turn, dt=DT)
        memory.learn(*pose_cells.active, DT * (k + 1))
    goal_x, goal_y = round(pose_cells.winner.x) % 64, round(pose_cells.winner.y) % 64
    T = memory.times_to(goal_x, goal_y)
    assert len(memory) > 1000
    assert np.isfinite(T).sum() > 200
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


@pytest.mark.slow
def test_small_changes_of_the_parameters_keep_the_route(subtests: pytest.Subtests) -> None:
    """C IV.C: insensitive to small changes."""
    params = GoalMemoryParams()
    for name in (item.name for item in fields(GoalMemoryParams) if isinstance(item.default, float)):
        for factor in (0.8, 1.2):
            with subtests.test(name, factor=factor):
                memory = two_ways(replace(params, **{name: factor * getattr(params, name)}))
                way = follow(memory, memory.times_to(40, 30), 10, 30)
                assert max(y for _, y in way) > 42
                assert math.dist(way[-1], (40, 30)) <= ARRIVED


@also_interpreted(goal_memory)
def test_it_does_not_point_through_a_wall(monkeypatch: pytest.MonkeyPatch) -> None:
    """Down one corridor and back up the next, 1.5 m away. The goal's corridor is in reach, but its cells are not linked."""
    monkeypatch.setattr(goal_memory, "REACH", 4)
    memory = GoalMemory(None, SHAPE, CELL_M)
    drive(memory, [(10, 30), (40, 30), (40, 36), (10, 36)], 0.4)
    T = memory.times_to(12, 36)
    heading = memory.direction(T, Packet(14.0, 31.0, 0.0, 1.0))
    assert heading is not None
    assert abs(heading) < math.radians(45)
    assert T[34:36, 13:16].min() < T[28:33, 10:19].min()  # the goal's corridor is lower, and within reach
    assert max(x for x, _ in follow(memory, T, 14, 31)) > 35


def test_it_wraps_around() -> None:
    """The same drive elsewhere on the torus gives the same times."""
    corners: list[Place] = [(20, 34), (40, 34), (40, 40)]
    here = GoalMemory(None, SHAPE, CELL_M)
    drive(here, corners, 0.5)
    T = here.times_to(40, 38)
    heading = here.direction(T, Packet(30.0, 34.0, 0.0, 1.0))
    for dx, dy in ((40, 0), (0, 30), (45, 29)):
        there = GoalMemory(None, SHAPE, CELL_M)
        drive(there, [(x + dx, y + dy) for x, y in corners], 0.5)
        moved = there.times_to((40 + dx) % 64, (38 + dy) % 64)
        assert moved == pytest.approx(np.roll(T, (dy, dx), (0, 1)), rel=1e-4)
        at = Packet((30.0 + dx) % 64, (34.0 + dy) % 64, 0.0, 1.0)
        assert there.direction(moved, at) == pytest.approx(heading)


def test_wrong_input_is_named(subtests: pytest.Subtests) -> None:
    for shape in ((1, 1024, 1024), (1, 1, 1)):
        assert len(GoalMemory(None, shape, CELL_M)) == 0
    memory = GoalMemory(None, SHAPE, CELL_M)
    cells, activity = packet_cells(10, 10)
    memory.learn(cells, activity, 1.0)
    memory.learn(cells, activity, 2.0)
    T = memory.times_to(10, 10)

    def outside(axis: int, value: int) -> np.ndarray:
        return np.vstack([cells[:5], np.where(np.arange(4) == axis, value, cells[5]), cells[6:]]).astype(np.int32)

    for message, call in (
        (r"shape must be .*got \(64, 64\)", lambda: GoalMemory(None, (64, 64), 0.25)),  # type: ignore[arg-type]
        ("shape must be", lambda: GoalMemory(None, (36, 0, 64), 0.25)),
        ("at most 1048576 cells in the plane", lambda: GoalMemory(None, (1, 1025, 1024), 0.25)),
        *(
            (f"cell_m must be a positive number of metres, got {cell_m!r}", partial(GoalMemory, None, SHAPE, cell_m))
            for cell_m in (0.0, -1.0, math.nan, math.inf)
        ),
        ("time_s must be a finite number, got nan", partial(memory.learn, cells, activity, math.nan)),
        *(
            (r"cells must have shape \(n, 4\) and activity \(n,\)", partial(memory.learn, wrong, active, 3.0))
            for wrong, active in ((cells[:, :3], activity), (cells[0], activity), (cells, activity[1:]))
        ),
        *(
            ("activity must be positive somewhere", partial(memory.learn, some, none, 3.0))
            for some, none in ((cells, activity * 0), (cells, activity * np.nan), (cells[:0], activity[:0]))
        ),
        *(
            (rf"cells must lie in 0..63, 0..63, got .*{at}", partial(memory.learn, outside(axis, at), activity, 3.0))
            for axis, at in ((0, 64), (0, -1), (1, 64), (1, -1))
        ),
        *(
            (
                rf"time_s must be later than the time before, 2\.0, got {late}",
                partial(memory.learn, cells, activity, late),
            )
            for late in (2.0, 1.5)
        ),
        *(
            (f"{name} must be a whole cell from 0 to 63, got ", partial(memory.times_to, x, y))  # type: ignore[arg-type]
            for x, y, name in ((64, 0, "x"), (-1, 0, "x"), (0, 64, "y"), (0.5, 0, "x"), (0, "1", "y"))
        ),
        (
            r"T must have shape \(64, 64\).*got \(3, 3\)",
            lambda: memory.direction(np.zeros((3, 3)), Packet(1.0, 1.0, 0.0, 1.0)),
        ),
        ("packet.y must be a finite number, got nan", lambda: memory.direction(T, Packet(1.0, math.nan, 0.0, 1.0))),
        ("rate must be between", lambda: GoalMemoryParams(rate=0.0)),
    ):
        with subtests.test(message), pytest.raises(ValueError, match=message):
            call()
