"""People: they walk their paths, are solid, stop for the robot and for doors, and wait as patiently as is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2d import Box, Drive, OfficeParams, Person, SimParams, Simulator

from .rooms import DOOR, EXACT, FORWARD, STAY, living, room, run

TICK_S = SimParams().tick_s
SLACK_S = 1.5 * TICK_S  # she turns round in one tick and goes in the next
ADA = Person("Ada", ((0.5, 0.5), (0.5, 3.5)), (0.0, 0.0), speed=1.0)  # up and down one side of the room


def walked(simulator: Simulator, ticks: int) -> np.ndarray:
    """Where the first person was after each tick, (ticks, 2)."""
    return np.array([simulator.actors.walkers.xy[0].copy() for _ in range(ticks) if simulator.step(STAY)])


def test_a_person_walks_its_path_and_stops_for_the_robot() -> None:
    simulator = Simulator(room(people=(ADA,)), EXACT)
    x, y = walked(simulator, 100).T
    assert set(x) == {0.5}
    assert (y.min(), y.max(), np.abs(np.diff(y)).max()) == (0.5, 3.5, pytest.approx(0.1))
    simulator.teleport(0.5, 2.0, 0.0)
    away = np.hypot(*(walked(simulator, 150) - (0.5, 2.0)).T)  # it comes, waits, and turns back
    assert away.min() >= 0.44
    assert (simulator.truth.x, simulator.truth.y) == pytest.approx((0.5, 2.0), abs=1e-9)


def test_a_person_is_solid_and_sensed() -> None:
    world = room(people=(Person("Ada", ((3.0, 2.0),), (1.0,)),))
    simulator = Simulator(world, EXACT)
    frame, empty = simulator.observe(), Simulator(room(), EXACT).observe()
    assert 0.78 <= frame.laser_m[90] <= 0.8
    assert 0.77 <= frame.ranges_m[3] <= 0.82
    assert np.abs(frame.image.astype(int) - empty.image).mean() > 3
    assert run(simulator, FORWARD, 60).bumped
    assert simulator.truth.x == pytest.approx(3.0 - 0.44, abs=0.01)
    nobody = Simulator(world, EXACT, office=OfficeParams(people=False))
    assert run(nobody, STAY, 2).laser_m[90] == pytest.approx(2.0)


def test_a_person_stops_at_a_shut_door_and_turns_back() -> None:
    person = Person("Ada", ((2.0, 2.0), (3.6, 2.0)), (0.0, 0.0), speed=1.0)
    simulator = Simulator(living(doors=(DOOR,), people=(person,)), EXACT)
    simulator.teleport(0.5, 0.5, 0.0)
    x, _ = walked(simulator, 200).T
    assert 2.65 < x.max() <= 3.0 - 0.22 + 1e-9
    assert (np.diff(np.sign(np.diff(x))) < 0).any()
    simulator.set_door("lab", True)
    assert walked(simulator, 200)[:, 0].max() == pytest.approx(3.6)


def test_people_have_a_seed_of_their_own() -> None:
    world = living(people=(Person("Ada", ((0.6, 0.6), (0.6, 3.4)), (2.0, 2.0)),))

    def after(seed: int, own: int) -> list[float]:
        return walked(Simulator(world, EXACT, seed, OfficeParams(seed=own)), 200)[-1].tolist()

    assert after(1, 7) == after(2, 7) != after(1, 8)
    assert after(1, 0) != after(2, 0)


@pytest.mark.slow
def test_never_a_centimetre_into_anybody() -> None:
    """Six minutes of wild driving in a crowd, through a door that keeps opening and shutting."""
    people = tuple(
        Person(
            f"p{i}", ((0.6, 0.6 + 0.7 * i), (2.4, 0.6 + 0.7 * (i * 3 % 5)), (1.5, 3.4)), (0.2,) * 3, speed=0.5 + 0.3 * i
        )
        for i in range(5)
    )
    door, box = replace(DOOR, period_s=5.0, open_s=2.5), Box("b", 3.5, 3.4, 0.4, 0.4)
    simulator = Simulator(living(doors=(door,), people=people, boxes=(box,)), EXACT, seed=2)
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


# ------------------------------------------------------------ patience


def a_passage(least: float, most: float) -> Simulator:
    """The robot stands in Ada's way."""
    few_pixels = SimParams(image_width=8, image_height=8)
    simulator = Simulator(room(people=(ADA,)), few_pixels, office=patient(least, most))
    simulator.teleport(0.5, 2.6, 0.0)
    return simulator


def patient(least: float, most: float) -> OfficeParams:
    return OfficeParams(patience_least_s=least, patience_most_s=most)


def stands(simulator: Simulator, seconds: float) -> list[float]:
    """The times (s) for which she has stood before the robot, each until she went on."""
    times, ticks, y = list[float](), 0, simulator.actors.walkers.xy[0, 1]
    for _, now in walked(simulator, round(seconds / TICK_S)):
        if now == y > 1.5:
            ticks += 1
        elif ticks:
            times.append(ticks * TICK_S)
            ticks = 0
        y = now
    return times


def walk_away(simulator: Simulator) -> None:
    while simulator.actors.walkers.xy[0, 1] > 1.0:
        simulator.step(STAY)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("least", "most"),
    [
        (3.0, 8.0),
        *(pytest.param(*each, marks=pytest.mark.long) for each in ((0.5, 1.0), (0.0, 4.0), (2.0, 2.0), (6.0, 10.0))),
    ],
)
def test_a_person_is_as_patient_as_is_said(least: float, most: float) -> None:
    """The first time the least, then at random."""
    times = np.array(stands(a_passage(least, most), 40 * (most + 4)))
    assert len(times) > 30
    assert least - 1e-9 <= times[0] <= least + SLACK_S
    assert least - 1e-9 <= times[1:].min() <= least + SLACK_S + 0.1 * (most - least)
    assert most - 0.1 * (most - least) - 1e-9 <= times.max() <= most + SLACK_S


def test_patience_is_lost_and_found_while_people_stand_and_walk() -> None:
    assert set(stands(a_passage(0.0, 0.0), 60)) == {TICK_S}  # she turns back at once
    simulator = a_passage(300.0, 400.0)
    assert stands(simulator, 20) == []  # she still stands
    simulator.office = patient(1.0, 1.5)
    assert max(stands(simulator, 60)) <= 1.5 + SLACK_S
    walk_away(simulator)
    simulator.office = patient(5.0, 6.0)
    assert min(stands(simulator, 60)) >= 5.0 - 1e-9
    walk_away(simulator)
    simulator.office = patient(0.5, 1.0)
    assert max(stands(simulator, 60)) <= 1.0 + SLACK_S


def test_who_could_go_on_in_time_is_patient_again() -> None:
    simulator = a_passage(3.0, 3.0)
    for _ in range(3):
        assert stands(simulator, 4.3) == []  # 1.7 s of walking, and most of her patience
        simulator.teleport(3.0, 3.0, 0.0)
        walk_away(simulator)
        simulator.teleport(0.5, 2.6, 0.0)
    assert stands(simulator, 10)[0] >= 3.0 - 1e-9


def test_patience_holds_after_a_reset_and_an_edit() -> None:
    simulator = a_passage(0.5, 0.5)
    for change in (lambda: simulator.reset(1), lambda: simulator.set_world(replace(simulator.world, title="Edited"))):
        change()
        simulator.teleport(0.5, 2.6, 0.0)
        assert 0.5 - 1e-9 <= stands(simulator, 10)[0] <= 0.5 + SLACK_S
