from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from sim2d import Drive, SimParams, Simulator, load_world
from sim2d.sensors import scene_number


def number(x: float, y: float, heading_deg: float, sector_deg: float = 30.0) -> int:
    return scene_number(x, y, math.radians(heading_deg), (-1.0, 2.0, 3.2, 5.0), 0.5, math.radians(sector_deg))


def test_equal_in_one_square_and_sector_different_in_any_other() -> None:
    """There are as many numbers as squares times sectors, 9 x 6 x 12, counted from 0, one for each square and sector."""
    meant: dict[int, tuple[int, int, int]] = {}
    rng = np.random.default_rng(0)
    for x, y, heading in rng.uniform((-1, 2, -360), (3.2, 5, 360), (20_000, 3)).tolist():
        place = math.floor((x + 1) / 0.5), math.floor((y - 2) / 0.5), math.floor(heading % 360 / 30)
        assert meant.setdefault(number(x, y, heading), place) == place
    assert sorted(meant) == list(range(9 * 6 * 12))
    for x, y in ((-1.0, 2.0), (3.2, 5.0), (-1.01, 5.01)):  # the very edge
        assert all(0 <= number(x, y, heading) < 9 * 6 * 12 for heading in (0.0, 180.0, -180.0, 360.0, -1e-12))


def test_sectors_that_do_not_fit_become_narrower() -> None:
    assert [len({number(0, 3, heading, sector) for heading in range(360)}) for sector in (100.0, 360.0)] == [4, 1]


def test_a_robot_that_turns_sees_one_number_after_the_other() -> None:
    simulator = Simulator(load_world("office"), SimParams(), 0)
    seen = [simulator.observe().scene, *(simulator.step(Drive(0.0, 1.0)).scene for _ in range(90))]
    assert len(set(seen)) == 36
    assert sum(a != b for a, b in pairwise(seen)) == 51  # in 9 rad
