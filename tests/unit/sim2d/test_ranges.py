"""What sonars, laser and bumper tell of walls, things, glass, thin posts and what is near."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ratslam_core.occupancy_grid import FARTHEST_M
from sim2d import SONAR_ANGLES_RAD, Simulator, Start
from sim2d.geometry.wall_index import build_index
from sim2d.sensors import NO_ECHO_M, laser_ranges, sonar_ranges

from .rooms import EXACT, FORWARD, STAY, room, run, wall

SQUARE, NONE = room().segments(), np.zeros((0, 4))


def sonar(
    walls: np.ndarray,
    angles: np.ndarray,
    farthest: float,
    error: float = 0.0,
    things: np.ndarray = NONE,
    touch: float = 0.1,
) -> tuple[np.ndarray, bool]:
    """From (1, 2), looking along +x."""
    errors = np.full(len(angles), error)
    cone = math.radians(15)
    return sonar_ranges(build_index(walls), things, 1.0, 2.0, 0.0, angles, cone, 5, farthest, errors, touch)


def test_echoes_are_as_far_as_walls_within_reach_and_errors() -> None:
    angles = np.array(SONAR_ANGLES_RAD)
    got, touches = sonar(SQUARE, angles, 2.5, 0.01)
    assert (got.dtype, touches) == (np.float32, False)
    assert got[[0, 7]] == pytest.approx([2.01, 2.01], abs=1e-6)
    assert got[[3, 4]].tolist() == [NO_ECHO_M, NO_ECHO_M]  # no echo within reach, no error either
    assert sonar(SQUARE, angles, 7.5)[0].max() < NO_ECHO_M < sonar(NONE, angles, 7.5)[0].min()
    assert NO_ECHO_M >= FARTHEST_M  # or who maps would take it for a wall
    assert sonar(SQUARE, angles, 5.0, -9.0)[0].tolist() == [0.0] * 8


def test_a_cone_sees_its_nearest_wall() -> None:
    """Towards a wall the middle ray is the shortest; past an edge, the nearest ray that still hits it counts."""
    post = np.array([[4.0, 2.15, 4.0, 2.3]])
    assert sonar(post, np.array([0.0, math.radians(-30)]), 5.0)[0] == pytest.approx([3.0, 5.0], abs=0.03)


def test_things_echo_and_touch_as_walls_do() -> None:
    things = np.array([[1.5, 1.5, 1.5, 2.5], [3.5, 1.5, 3.5, 2.5]])
    got, touches = sonar(SQUARE, np.array([0.0]), 5.0, 0.0, things, touch=0.51)
    assert (got[0], touches) == (pytest.approx(0.5), True)
    assert not sonar(SQUARE, np.array([0.0]), 5.0, 0.0, things, touch=0.49)[1]


def test_a_laser_looks_from_right_to_left_and_in_no_direction_twice() -> None:
    index = build_index(SQUARE)
    scan = laser_ranges(index, NONE, 1.0, 2.0, 0.0, math.pi, 2.5, np.full(5, 0.01))
    assert scan == pytest.approx([2.01, 2.5, 2.5, 2.5, 2.01], abs=1e-6)
    around = laser_ranges(index, NONE, 1.0, 2.0, 0.0, 2 * math.pi, 9.0, np.zeros(4))
    assert around == pytest.approx([1.0, 2.0, 3.0, 2.0])  # from behind, left first


def test_laser_passes_glass_and_sonar_and_robot_do_not() -> None:
    simulator = Simulator(room(wall(3.0, 0.0, 3.0, 4.0, kind="glass")), EXACT)
    frame = simulator.observe()
    assert frame.laser_m[90] == pytest.approx(2.0)
    assert frame.ranges_m[3] == pytest.approx(1.0, abs=0.02)
    run(simulator, FORWARD, 60)
    assert simulator.truth.x == pytest.approx(3.0 - 0.22, abs=0.003)


def test_false_echoes_are_seeded_and_as_many_as_asked_for() -> None:
    def echoes() -> np.ndarray:
        simulator = Simulator(room(), replace(EXACT, sonar_false_echo=0.3), seed=5)
        return np.array([simulator.step(STAY).ranges_m for _ in range(300)])

    got = echoes()
    assert np.array_equal(got, echoes())
    wrong = np.abs(got - Simulator(room(), EXACT).observe().ranges_m) > 0.02
    assert wrong.mean() == pytest.approx(0.3, abs=0.04)


def test_a_bumper_and_the_rays_of_a_cone_are_as_long_and_as_many_as_they_are_said_to_be() -> None:
    """A robot so far from a wall; and a thin post between two of five rays, which sixty-one do not miss."""
    for away, touches in ((0.004, True), (0.006, False)):
        near = room(starts=(Start("home", 0.22 + away, 2.0, math.pi),))
        assert Simulator(near, EXACT).step(STAY).bumped is touches
    post = room(wall(3.0, 2.05, 3.0, 2.06), starts=(Start("home", 1.0, 2.0, math.radians(-10)),))
    echoes = [float(Simulator(post, replace(EXACT, sonar_rays=n)).step(STAY).ranges_m[3]) for n in (5, 61)]
    assert echoes == pytest.approx([3.0, 2.0], abs=0.03)
