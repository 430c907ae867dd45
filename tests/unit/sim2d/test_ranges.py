"""What laser, sonars and bumper tell of glass, thin posts and walls that are near."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim2d import Simulator, Start, Wall

from .living_room import EXACT, FORWARD, STAY, run
from .rooms import GREY, room


def test_laser_passes_glass_and_sonar_and_robot_do_not() -> None:
    simulator = Simulator(room(Wall(3.0, 0.0, 3.0, 4.0, "glass", 2.6, GREY)), EXACT)
    frame = simulator.observe()
    assert frame.laser_m[90] == pytest.approx(2.0)
    assert frame.ranges_m[3] == pytest.approx(1.0, abs=0.02)
    run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(3.0 - 0.22, abs=0.003)


def test_false_echoes_are_seeded_and_as_many_as_asked_for() -> None:
    params = replace(EXACT, sonar_false_echo=0.3)

    def echoes() -> np.ndarray:
        simulator = Simulator(room(), params, seed=5)
        return np.array([simulator.step(STAY).ranges_m for _ in range(300)])

    got = echoes()
    assert np.array_equal(got, echoes())
    wrong = np.abs(got - Simulator(room(), EXACT).observe().ranges_m) > 0.02
    assert wrong.mean() == pytest.approx(0.3, abs=0.04)


def test_a_bumper_and_the_rays_of_a_cone_are_as_many_and_as_long_as_they_are_said_to_be() -> None:
    """A robot 0.03 m from a wall; and a thin post between two of five rays, which sixty-one do not miss."""
    near = replace(room(), starts=(Start("home", 0.25, 2.0, math.pi),))
    touches = {reach: Simulator(near, replace(EXACT, bumper_m=reach)).step(STAY).bumped for reach in (0.005, 0.05)}
    assert touches == {0.005: False, 0.05: True}
    post = room(Wall(3.0, 2.05, 3.0, 2.06, "wall", 2.6, GREY))
    post = replace(post, starts=(Start("home", 1.0, 2.0, math.radians(-10)),))
    echoes = [float(Simulator(post, replace(EXACT, sonar_rays=n)).step(STAY).ranges_m[3]) for n in (5, 61)]
    assert echoes == pytest.approx([3.0, 2.0], abs=0.03)
