"""Wandering: along walls, across the room, looking back now and then. The maps made by hand do not grow, so it seeks nothing."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from disk import encode
from sim2d import Simulator, load_world

from .pilots import EXPLORING, FAR, STILL, Run, a_pilot
from .worlds import EXACT, HandMadeMap, room


def test_exploring_follows_walls_crosses_and_looks_back() -> None:
    run = Run(
        Simulator(room(side=6.0, start=(3.0, 3.0, 0.0)), EXACT),
        a_pilot(look_back_after_m=8.0, cross_after_s=8.0, seek=False),
    )
    run.run(240)
    for doing in EXPLORING:
        assert run.doing[doing] > 50
    assert run.doing["following the wall"] > 500
    cells = {(int(x / 1.5), int(y / 1.5)) for x, y in run.track}
    assert len(cells) >= 11  # of 16


@pytest.mark.parametrize("seed", range(3))
def test_the_wall_on_the_left_is_kept_at_its_distance(seed: int) -> None:
    pilot = a_pilot(seed, look_back_after_m=1000.0, cross_after_s=1e6, seek=False)
    run = Run(Simulator(room(start=(2.0, 3.2 + 0.15 * seed, 0.0)), EXACT), pilot)
    run.run(10)
    left, walls = [], []
    for _ in range(600):
        run.tick()
        left.append(float(run.frame.ranges_m[0]))
        walls.append(min(*run.truth, 4 - run.truth[0], 4 - run.truth[1]))
    assert np.median(left) == pytest.approx(0.55, abs=0.15)
    assert min(walls) > 0.25
    angles = np.unwrap([math.atan2(y - 2, x - 2) for x, y in run.track[300:]])
    assert angles[-1] - angles[0] < -2 * math.pi  # clockwise around the room, the wall on its left


@pytest.mark.parametrize("seed", range(3))
def test_it_seldom_touches_anything(seed: int) -> None:
    run = Run(Simulator(load_world("office"), seed=seed), a_pilot(seed))
    run.run(150)
    assert run.bumps < 0.02 * 1500
    assert len({(int(x), int(y)) for x, y in run.track}) > 10  # of 80 square metres


def test_equal_pilots_do_the_same() -> None:
    runs = [Run(Simulator(room(start=(2.0, 2.0, 0.0)), EXACT, 3), a_pilot(3, seek=False)) for _ in range(2)]
    other = Run(Simulator(room(start=(2.0, 2.0, 0.0)), EXACT, 3), a_pilot(4, seek=False))
    for run in (*runs, other):
        run.run(60)
    assert runs[0].track == runs[1].track != other.track
    assert encode(runs[0].pilot).digest() == encode(runs[1].pilot).digest() != encode(other.pilot).digest()


def test_a_crossing_that_cannot_be_turned_to_ends() -> None:
    """Wheels that report no turn do not keep it turning for ever."""
    pilot = a_pilot(cross_after_s=2.0, stuck_s=60.0)
    map_ = HandMadeMap([(0.0, 0.0)], [])
    seen = Counter()
    for _ in range(400):
        pilot.step(FAR, False, STILL, map_)  # type: ignore[arg-type]
        seen[pilot.doing] += 1
    assert seen["crossing"] > 20
    assert seen["following the wall"] > 20
