"""IROS 2005 IV.D: the robot follows the wall on its left, retraces its recent path, returns, and goes on."""

from __future__ import annotations

import math
from itertools import groupby, pairwise

import pytest

from app.pilot.looking_back import LOOK_BACK_RAD
from sim2d import Simulator

from .pilots import Run, a_pilot
from .worlds import EXACT, room

LOOKS = "turning back to look"


def _stretches(seconds: float, **params: float) -> list[tuple[str, list[tuple[float, float, float]]]]:
    """What the robot did, one after the other, and where it was then (m, m, rad)."""
    simulator = Simulator(room(side=8.0, start=(2.0, 7.2, 0.0)), EXACT)
    run = Run(simulator, a_pilot(seek=False, retrace=True, look_back_after_m=3.0, **params))
    did: list[tuple[str, tuple[float, float, float]]] = []
    for _ in range(round(seconds / 0.1)):
        run.tick()
        truth = simulator.truth
        did.append((run.pilot.doing, (truth.x, truth.y, truth.heading_rad)))
    return [(doing, [pose for _, pose in poses]) for doing, poses in groupby(did, key=lambda one: one[0])]


def _nearest(path: list[tuple[float, float, float]], to: tuple[float, float, float]) -> float:
    return min(math.dist(pose[:2], to[:2]) for pose in path)


def _way(path: list[tuple[float, float, float]]) -> float:
    return sum(math.dist(a[:2], b[:2]) for a, b in pairwise(path))


def test_it_retraces_its_path_and_returns_to_where_it_turned_back() -> None:
    stretches = _stretches(300)
    assert {doing for doing, _ in stretches} == {"following the wall", LOOKS}
    looks = [(before, look) for (_, before), (doing, look) in pairwise(stretches[:-1]) if doing == LOOKS]
    assert len(looks) > 8
    for before, look in looks:
        assert _nearest(look, before[0]) < 0.4
        assert math.dist(look[-1][:2], before[-1][:2]) < 0.4
        assert all(_nearest(before, pose) < 0.4 for pose in look)  # nowhere but along its path


def test_it_looks_back_after_three_metres_and_round_a_corner_and_not_before() -> None:
    stretches = _stretches(300)
    ways = [path for doing, path in stretches[1:-1] if doing != LOOKS]
    turned = [abs(math.remainder(path[-1][2] - path[0][2], 2 * math.pi)) for path in ways]
    for path, turn in zip(ways, turned, strict=True):
        assert _way(path) == pytest.approx(3.0, abs=0.3) or turn > LOOK_BACK_RAD
    assert sum(turn > LOOK_BACK_RAD and _way(path) < 2.7 for path, turn in zip(ways, turned, strict=True)) >= 2
    assert max(map(_way, ways)) < 3.3


def test_who_was_elsewhere_since_does_not_go_back_for_its_path() -> None:
    """It drove by hand for two metres: what it looks back along begins there."""
    simulator = Simulator(room(side=8.0, start=(2.0, 7.2, 0.0)), EXACT)
    run = Run(simulator, a_pilot(seek=False, retrace=True, look_back_after_m=3.0))
    run.run(4)
    run.pilot.drive(0.3, -0.3)
    run.run(10)
    run.pilot.set_mode("explore")
    began = run.truth
    while run.pilot.doing != LOOKS:
        run.tick()
    back = len(run.track)
    while run.pilot.doing == LOOKS:
        run.tick()
    assert min(math.dist(place, began) for place in run.track[back:]) < 0.5
    assert all(min(math.dist(place, past) for past in run.track[140:back]) < 0.4 for place in run.track[back:])
