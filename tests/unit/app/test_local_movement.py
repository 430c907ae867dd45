"""The chosen arc keeps clear of the sonars' echoes of the last seconds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot import PilotParams, local_movement
from app.pilot.local_movement import LocalMovement
from ratslam_core import Odometry, Pose2
from tests.unit.ratslam_core import literal

from .pilots import DT, NEAR, STILL, USUAL


@pytest.fixture(params=[False, True], ids=["compiled", "interpreted"])
def interpreted(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Each law holds for the machine code and for the Python that it is made of."""
    if request.param:
        literal.interpret(local_movement, monkeypatch)
    return request.param


def sensed(*echoes: tuple[float, float]) -> LocalMovement:
    """Obstacles at these places: bearing and distance."""
    local = LocalMovement(np.array([bearing for bearing, _ in echoes]), USUAL.echo_s)
    local.sense(np.array([distance for _, distance in echoes], np.float32), STILL)
    return local


def arc(speed: float, yaw_rate: float, seconds: float) -> list[tuple[float, float]]:
    pose, places = Pose2(0.0, 0.0, 0.0), []
    for _ in range(round(seconds / 0.02)):
        pose = pose.compose(Pose2(speed * 0.02, 0.0, yaw_rate * 0.02))
        places.append((pose.x, pose.y))
    return places


@pytest.mark.usefixtures("interpreted")
def test_free_floor_is_crossed_towards_the_target() -> None:
    local = sensed((0.0, 5.0))
    for bearing in (0.0, 0.5, -0.5, 1.2, -1.2, 3.0):
        speed, yaw_rate = local.towards(1.5 * math.cos(bearing), 1.5 * math.sin(bearing), USUAL)
        assert 0 <= speed <= (0.11 if bearing == 3.0 else 0.36), bearing  # to go back, it turns first
        assert abs(yaw_rate) <= 1.0
        if bearing == 0.0:
            assert (speed, yaw_rate) == (0.36, 0.0)
        else:
            assert math.copysign(1.0, yaw_rate) == math.copysign(1.0, bearing)


@pytest.mark.parametrize("seed", range(6))
def test_the_chosen_arc_keeps_clear_of_all_echoes(seed: int, interpreted: bool) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(6 if interpreted else 60):
        echoes = [(float(b), float(d)) for b, d in zip(rng.uniform(-2, 2, 8), rng.uniform(0.3, 1.5, 8), strict=True)]
        local = sensed(*echoes)
        speed, yaw_rate = local.towards(*rng.uniform(-1, 1, 2), USUAL)
        places = arc(speed, yaw_rate, 1.2)
        nearest = min(math.dist(p, (d * math.cos(b), d * math.sin(b))) for p in places for b, d in echoes)
        assert nearest > 0.27 - 0.03


def test_a_wall_close_ahead_is_turned_from() -> None:
    wall = sensed(*[(b, 0.3 / math.cos(b)) for b in (-1.2, -0.8, -0.4, 0.0, 0.4, 0.8, 1.2)])
    speed, yaw_rate = wall.towards(1.0, 0.0, USUAL)
    assert speed == 0.0
    assert abs(yaw_rate) >= 0.5


@pytest.mark.usefixtures("interpreted")
def test_the_free_way_is_the_distance_less_the_clearance() -> None:
    local = sensed((0.0, 1.0), (math.pi / 2, 0.5), (3.0, 2.0))
    clear = USUAL.clearance
    ways = [(0.0, 1.0 - clear), (math.pi / 2, 0.5 - clear), (-math.pi / 2, 1.6), (3.0, 1.6)]  # 3: farther than it looks
    for bearing, way in ways:
        assert local.free_way(bearing, USUAL) == pytest.approx(way)
    assert sensed((0.0, 0.1)).free_way(0.0, USUAL) == 0.0


@pytest.mark.usefixtures("interpreted")
def test_echoes_are_carried_along_and_forgotten() -> None:
    local = LocalMovement(np.array([0.0, 0.7]), USUAL.echo_s)
    local.sense(np.array([1.2, 5.0], np.float32), STILL)
    nothing = np.array([5.0, 5.0], np.float32)
    for _ in range(10):  # half a metre ahead
        local.sense(nothing, Odometry(0.5, 0.0, DT))
    assert local.free_way(0.0, NEAR) == pytest.approx(0.5, abs=1e-6)
    for _ in range(10):  # a quarter turn to the left: now it is on the right
        local.sense(nothing, Odometry(0.0, math.pi / 2, DT))
    assert local.free_way(-math.pi / 2, NEAR) == pytest.approx(0.5, abs=1e-6)
    assert local.free_way(0.0, NEAR) == pytest.approx(1.6)
    for _ in range(30):  # three seconds later
        local.sense(nothing, STILL)
    assert local.free_way(-math.pi / 2, NEAR) == pytest.approx(1.6)
    local.sense(np.array([0.4, 5.0], np.float32), STILL)
    assert local.free_way(0.0, NEAR) < 1.0
    local.forget()
    assert local.free_way(0.0, NEAR) == pytest.approx(1.6)


@pytest.mark.parametrize("rate", [1, 2, 5, 10, 20, 60])
def test_echoes_are_remembered_for_as_long_at_every_rate(rate: int) -> None:
    local = LocalMovement(np.array([0.0]), 3.0)
    near, nothing, still = np.array([0.8], np.float32), np.array([5.0], np.float32), Odometry(0.0, 0.0, 1 / rate)
    for _ in range(rate):
        local.sense(near, still)
    known = []
    for _ in range(4 * rate):
        local.sense(nothing, still)
        known.append(local.free_way(0.0, USUAL) < 1.0)
    assert sum(known) / rate == pytest.approx(3.0, abs=0.11 + 1 / rate)
    assert known == sorted(known, reverse=True)


@pytest.mark.usefixtures("interpreted")
def test_the_gap_beside_the_point_is_headed_for() -> None:
    """The map has the point half a metre beside a door: the robot heads for the door, not for the jamb."""
    jamb = [(math.atan2(y, 0.6), math.hypot(0.6, y)) for y in (-0.3, -0.2, -0.1, 0.0, 0.1, 0.9, 1.0)]
    local = sensed(*jamb)  # the gap is between 0.1 and 0.9
    x, y = local.gap_towards(1.2, 0.0, USUAL)
    at = y / x * 0.6
    assert 0.3 < at < 0.7
    assert local.free_way(math.atan2(y, x), USUAL) >= USUAL.gap_m
    assert sensed((0.0, 1.5)).gap_towards(1.2, 0.1, USUAL) == (1.2, 0.1)  # free: nothing is changed
    assert local.gap_towards(-1.0, 0.0, USUAL) == (-1.0, 0.0)
    assert local.gap_towards(1.2, 0.0, PilotParams(gap_m=0.0)) == (1.2, 0.0)
