"""People: they walk their paths, are solid, and stop for the robot and for doors."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim2d import Box, Drive, OfficeParams, Person, Simulator

from .living_room import DOOR, EXACT, FORWARD, STAY, living, run
from .rooms import room


def test_a_person_walks_its_path_and_stops_for_the_robot() -> None:
    path = ((0.5, 0.5), (0.5, 3.5))
    world = replace(room(), people=(Person("Ada", path, (0.0, 0.0), speed=1.0),))
    simulator = Simulator(world, EXACT)
    ys = []
    for _ in range(100):
        simulator.step(STAY)
        x, y = simulator.actors.walkers.xy[0]
        assert x == 0.5
        ys.append(y)
    assert min(ys) == 0.5
    assert max(ys) == 3.5
    assert np.abs(np.diff(ys)).max() == pytest.approx(0.1)
    simulator.teleport(0.5, 2.0, 0.0)
    for _ in range(150):  # it comes, waits, and turns back
        simulator.step(STAY)
        assert math.dist(simulator.actors.walkers.xy[0], (0.5, 2.0)) >= 0.44
    assert (simulator.truth.x, simulator.truth.y) == pytest.approx((0.5, 2.0), abs=1e-9)


def test_a_person_is_solid_and_sensed() -> None:
    person = Person("Ada", ((3.0, 2.0),), (1.0,))
    simulator = Simulator(replace(room(), people=(person,)), EXACT)
    empty = Simulator(room(), EXACT).observe()
    frame = simulator.observe()
    assert 0.78 <= frame.laser_m[90] <= 0.8
    assert 0.77 <= frame.ranges_m[3] <= 0.82
    assert np.abs(frame.image.astype(int) - empty.image).mean() > 3
    frame = run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(3.0 - 0.44, abs=0.01)
    assert frame.bumped
    nobody = Simulator(replace(room(), people=(person,)), EXACT, office=OfficeParams(people=False))
    assert run(nobody, STAY, 2).laser_m[90] == pytest.approx(2.0)


def test_a_person_stops_at_a_shut_door_and_turns_back() -> None:
    person = Person("Ada", ((2.0, 2.0), (3.6, 2.0)), (0.0, 0.0), speed=1.0)
    simulator = Simulator(living(doors=(DOOR,), people=(person,)), EXACT)
    simulator.teleport(0.5, 0.5, 0.0)
    xs = []
    for _ in range(200):
        simulator.step(STAY)
        xs.append(simulator.actors.walkers.xy[0, 0])
    assert 2.65 < max(xs) <= 3.0 - 0.22 + 1e-9
    turned = np.diff(np.sign(np.diff(xs)))
    assert (turned < 0).any()
    simulator.set_door("lab", True)
    xs = [float(simulator.actors.walkers.xy[0, 0]) for _ in range(200) if simulator.step(STAY)]
    assert max(xs) == pytest.approx(3.6)


def test_people_have_a_seed_of_their_own() -> None:
    people = (Person("Ada", ((0.6, 0.6), (0.6, 3.4)), (2.0, 2.0)),)

    def path(seed: int, own: int) -> np.ndarray:
        simulator = Simulator(living(people=people), EXACT, seed, OfficeParams(seed=own))
        run(simulator, STAY, 200)
        return simulator.actors.walkers.xy.copy()

    assert np.array_equal(path(1, 7), path(2, 7))
    assert not np.array_equal(path(1, 7), path(1, 8))
    assert not np.array_equal(path(1, 0), path(2, 0))


def test_same_seed_same_office() -> None:
    people = tuple(Person(f"p{i}", ((0.5, 0.5 + i), (2.5, 0.6 + i)), (1.0, 0.5)) for i in range(3))
    world = living(doors=(replace(DOOR, period_s=7.0, open_s=3.0),), people=people)
    one, two, other = (Simulator(world, seed=s) for s in (4, 4, 5))
    for k in range(200):
        drive = Drive(0.3 if k % 30 < 20 else -0.3, math.sin(k))
        for simulator in (one, two, other):
            simulator.step(drive)
    assert one.digest() == two.digest()
    assert not np.array_equal(one.actors.walkers.xy, other.actors.walkers.xy)
    state = one.digest()
    one.actors.walkers.xy[0, 0] += 1e-9
    assert one.digest() != state


@pytest.mark.slow
def test_never_a_centimetre_into_anybody() -> None:
    """Six minutes of wild driving in a crowd, through a door that keeps opening and shutting."""
    people = tuple(
        Person(
            f"p{i}",
            ((0.6, 0.6 + 0.7 * i), (2.4, 0.6 + 0.7 * ((i * 3) % 5)), (1.5, 3.4)),
            (0.2,) * 3,
            speed=0.5 + 0.3 * i,
        )
        for i in range(5)
    )
    world = living(
        doors=(replace(DOOR, period_s=5.0, open_s=2.5),), people=people, boxes=(Box("b", 3.5, 3.4, 0.4, 0.4),)
    )
    simulator = Simulator(world, EXACT, seed=2)
    rng = np.random.default_rng(3)
    for k in range(3600):
        if k % 12 == 0:
            drive = Drive(rng.choice([-0.5, 0.5]), rng.uniform(-1, 1))
        simulator.step(drive)
        x, y = simulator.truth.x, simulator.truth.y
        assert simulator.free_space.clearance(x, y) > 0.22 - 0.01
        assert simulator.fit.covering(x, y) is None
        away = np.hypot(*(simulator.actors.walkers.xy[simulator.actors.walkers.present] - (x, y)).T)
        assert away.min(initial=9.0) > 0.44 - 0.01
