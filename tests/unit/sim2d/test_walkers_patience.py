"""How long people stand before the robot until they turn back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2d import Drive, OfficeParams, Person, SimParams, Simulator

from .rooms import room

STAY, TICK_S = Drive(0.0, 0.0), SimParams().tick_s
SLACK_S = 1.5 * TICK_S  # she turns round in one tick and goes in the next


def a_passage(office: OfficeParams) -> Simulator:
    """Ada walks up and down one side of the room at 1 m/s, and the robot stands in her way."""
    ada = Person("Ada", ((0.5, 0.5), (0.5, 3.5)), (0.0, 0.0), speed=1.0)
    few_pixels = SimParams(image_width=8, image_height=8)
    simulator = Simulator(replace(room(), people=(ada,)), few_pixels, office=office)
    simulator.teleport(0.5, 2.6, 0.0)
    return simulator


def patient(least: float, most: float) -> OfficeParams:
    return OfficeParams(patience_least_s=least, patience_most_s=most)


def stands(simulator: Simulator, seconds: float) -> list[float]:
    """The times (s) for which she has stood before the robot, each until she went on."""
    times, ticks, y = list[float](), 0, simulator.actors.walkers.xy[0, 1]
    for _ in range(round(seconds / TICK_S)):
        simulator.step(STAY)
        before, y = y, simulator.actors.walkers.xy[0, 1]
        if y == before > 1.5:
            ticks += 1
        elif ticks:
            times.append(ticks * TICK_S)
            ticks = 0
    return times


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
    times = np.array(stands(a_passage(patient(least, most)), 40 * (most + 4)))
    assert len(times) > 30
    assert least - 1e-9 <= times[0] <= least + SLACK_S
    assert least - 1e-9 <= times[1:].min() <= least + SLACK_S + 0.1 * (most - least)
    assert most - 0.1 * (most - least) - 1e-9 <= times.max() <= most + SLACK_S


def test_who_has_no_patience_turns_back_at_once() -> None:
    assert set(stands(a_passage(patient(0.0, 0.0)), 60)) == {TICK_S}


def test_patience_is_lost_and_found_while_people_stand_and_walk() -> None:
    simulator = a_passage(patient(300.0, 400.0))
    assert stands(simulator, 20) == []  # she still stands
    simulator.office = patient(1.0, 1.5)
    assert max(stands(simulator, 60)) <= 1.5 + SLACK_S
    walk_away(simulator)
    simulator.office = patient(5.0, 6.0)
    assert min(stands(simulator, 60)) >= 5.0 - 1e-9
    walk_away(simulator)
    simulator.office = patient(0.5, 1.0)
    assert max(stands(simulator, 60)) <= 1.0 + SLACK_S


def walk_away(simulator: Simulator) -> None:
    while simulator.actors.walkers.xy[0, 1] > 1.0:
        simulator.step(STAY)


def test_who_could_go_on_in_time_is_patient_again() -> None:
    simulator = a_passage(patient(3.0, 3.0))
    for _ in range(3):
        assert stands(simulator, 4.3) == []  # 1.7 s of walking, and most of her patience
        simulator.teleport(3.0, 3.0, 0.0)
        walk_away(simulator)
        simulator.teleport(0.5, 2.6, 0.0)
    assert stands(simulator, 10)[0] >= 3.0 - 1e-9


def test_patience_holds_after_a_reset_and_an_edit() -> None:
    simulator = a_passage(patient(0.5, 0.5))
    for change in (lambda: simulator.reset(1), lambda: simulator.set_world(replace(simulator.world, title="Edited"))):
        change()
        simulator.teleport(0.5, 2.6, 0.0)
        assert 0.5 - 1e-9 <= stands(simulator, 10)[0] <= 0.5 + SLACK_S
