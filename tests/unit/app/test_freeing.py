"""A robot that is stuck notices it and gets free; one that is merely slow does not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core import Odometry
from sim2d import Drive, SimParams, Simulator
from sim2d.world.world import SlowZone

from .pilots import DT, FAR, STILL, Run, a_pilot
from .worlds import EXACT, HandMadeMap, chain, room


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("heading", [math.pi, -2.4, -math.pi / 2])
@pytest.mark.slow
def test_a_cornered_robot_frees_itself(heading: float, seed: int) -> None:
    """Driven into a corner by hand, then left alone, it is a metre away within 20 s, of which a first look behind itself
    takes 7 s."""
    simulator = Simulator(room(start=(0.5, 0.5, heading)), EXACT, seed)
    for _ in range(20):
        simulator.step(Drive(0.3, 0.0))
    run = Run(simulator, a_pilot(seed))
    begin = run.truth
    run.run(20)
    assert max(math.dist(begin, place) for place in run.track) > 1.0


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.slow
def test_a_slow_floor_is_no_reason_to_back_off(seed: int) -> None:
    """On a slow floor exploring takes long, but the robot hardly ever frees itself without being stuck."""
    world = room(start=(3.0, 2.0, 0.0))
    x, y, right, top = world.bounds
    zone = SlowZone("slippery", ((x, y), (right, y), (right, top), (x, top)), 0.3)
    run = Run(Simulator(replace(world, slow_zones=(zone,)), EXACT, seed), a_pilot(seed))
    run.run(240)
    assert run.doing["freeing itself"] < 0.1 * sum(run.doing.values())
    assert len({(int(x), int(y)) for x, y in run.track}) > 5


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("gap_m", [0.52, 0.56])
@pytest.mark.slow
def test_it_gets_out_of_a_pocket_hardly_wider_than_itself(gap_m: float, seed: int) -> None:
    """As in a real plan, where it stood for the rest of the hour: 0.44 m wide, it keeps 0.24 m clear of echoes that are
    centimetres off."""
    low, high = 2.0 - gap_m / 2, 2.0 + gap_m / 2
    pocket = room(
        (2.9, 0.0, 2.9, low), (2.9, high, 2.9, 4.0), (2.9, 1.4, 4.0, 1.4), (2.9, 2.6, 4.0, 2.6),
        start=(3.4, 2.1, 0.3 * seed),
    )  # fmt: skip
    way = HandMadeMap(*chain((3.4, 2.0), (2.9, 2.0), (1.5, 2.0), (1.0, 1.0)))
    run = Run(Simulator(pocket, SimParams(), seed), a_pilot(seed), way)
    run.pilot.set_goal(len(way) - 1)
    run.run(120)
    assert run.truth[0] < 2.5


NOWHERE = HandMadeMap([(0.0, 0.0)], [])


@pytest.mark.parametrize(("ahead", "turning"), [(0.6, 14), (1.5, 5)])
def test_bumped_and_getting_nowhere_it_backs_off_and_turns_until_it_is_free_ahead(ahead: float, turning: int) -> None:
    pilot, ranges = a_pilot(), np.full_like(FAR, ahead)
    drives = [pilot.step(ranges, True, STILL, NOWHERE) for _ in range(45)]  # type: ignore[arg-type]
    begin = next(k for k, (speed, _) in enumerate(drives) if speed < 0)
    assert begin == pytest.approx(10, abs=1)  # a second of grace
    assert all(speed == -0.2 for speed, _ in drives[begin : begin + 10])
    turn = drives[begin][1]
    assert 0.5 <= abs(turn) <= 1.0
    turned = next(k for k in range(begin, 45) if drives[k] not in ((-0.2, turn), (0.0, turn)))
    assert turned - begin == pytest.approx(10 + turning, abs=2)


def test_after_getting_free_it_may_drive_for_a_second_though_it_still_touches_something() -> None:
    """It had turned to open floor, touched the wall beside it, and backed off again: a minute in a corner."""
    pilot, near = a_pilot(), np.full_like(FAR, 0.6)
    backing = [pilot.step(near, True, STILL, NOWHERE)[0] < 0 for _ in range(80)]  # type: ignore[arg-type]
    begins = [k for k in range(1, 80) if backing[k] and not backing[k - 1]]
    assert begins[1] - begins[0] >= 25 + 10


def test_getting_nowhere_without_a_bump_takes_longer_and_getting_ahead_is_not_being_stuck() -> None:
    stuck, ahead, frees = a_pilot(stuck_s=3.0), a_pilot(stuck_s=3.0), list[bool]()
    for _ in range(300):
        stuck.step(FAR, False, STILL, NOWHERE)  # type: ignore[arg-type]
        frees.append(stuck.doing == "freeing itself")
        ahead.step(FAR, False, Odometry(0.3, 0.0, DT), NOWHERE)  # type: ignore[arg-type]
        assert ahead.doing != "freeing itself"
    assert frees.index(True) * DT == pytest.approx(3.0, abs=0.15)
