from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from sim2d import Drive, SimParams, Simulator, load_world
from sim2d.sensors.scene_numbers import scene_number

BOUNDS = (-1.0, 2.0, 3.2, 5.0)


def number(x: float, y: float, heading_deg: float, cell_m: float = 0.5, sector_deg: float = 30.0) -> int:
    return scene_number(x, y, math.radians(heading_deg), BOUNDS, cell_m, math.radians(sector_deg))


def test_equal_in_one_square_and_sector_different_in_any_other() -> None:
    """There are as many numbers as squares times sectors, 9 x 6 x 12, counted from 0, one for each square and sector."""
    meant: dict[int, tuple[int, int, int]] = {}
    rng = np.random.default_rng(0)
    for _ in range(20_000):
        x, y, heading = rng.uniform(-1, 3.2), rng.uniform(2, 5), rng.uniform(-360, 360)
        place = math.floor((x + 1) / 0.5), math.floor((y - 2) / 0.5), math.floor(heading % 360 / 30)
        assert meant.setdefault(number(x, y, heading), place) == place
    assert sorted(meant) == list(range(9 * 6 * 12))


@pytest.mark.parametrize(("x", "y"), [(-1.0, 2.0), (3.2, 5.0), (-1.01, 5.01)])
@pytest.mark.parametrize("heading", [0.0, 180.0, -180.0, 360.0, -1e-12])
def test_the_very_edge_has_a_number_too(x: float, y: float, heading: float) -> None:
    assert 0 <= number(x, y, heading) < 9 * 6 * 12


def test_sectors_that_do_not_fit_become_narrower() -> None:
    assert len({number(0, 3, heading, sector_deg=100.0) for heading in range(360)}) == 4
    assert len({number(0, 3, heading, sector_deg=360.0) for heading in range(360)}) == 1


def test_a_robot_that_turns_sees_one_number_after_the_other() -> None:
    simulator = Simulator(load_world("office"), SimParams(), 0)
    seen = [simulator.observe().scene]
    for _ in range(90):
        seen.append(simulator.step(Drive(0.0, 1.0)).scene)
    assert len(set(seen)) == 12
    assert sum(a != b for a, b in pairwise(seen)) == 17  # in 9 rad
