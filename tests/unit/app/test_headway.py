"""Headway is judged by what the robot's own wheels did."""

from __future__ import annotations

import math

import pytest

from app.pilot.route_following import NO_HEADWAY_S, Headway
from app.pilot.stay import PLACE_M
from ratslam_core import Odometry

from .pilots import DT


def headed(aim: tuple[float, float] = (0.6, 0.0)) -> Headway:
    headway = Headway()
    headway.head_for(aim)
    return headway


def moved(headway: Headway, seconds: float, speed: float, yaw_rate: float = 0.0, trying: bool = True) -> None:
    for _ in range(round(seconds / DT)):
        headway.move(Odometry(speed, yaw_rate, DT), trying)


@pytest.mark.parametrize("speed", [0.07, 0.3])
def test_slow_is_not_blocked(speed: float) -> None:
    """On a fifth of the usual speed the robot still gets on."""
    headway = Headway()
    for _ in range(60):
        headway.head_for((0.6, 0.0))
        moved(headway, 1.0, speed)
        assert not headway.blocked()
        assert not headway.astray()


@pytest.mark.parametrize(("aim", "speed"), [((0.6, 0.0), 0.0), ((0.0, 0.6), 0.005), ((-0.6, 0.0), 0.3)])
def test_a_robot_that_comes_no_nearer_fails(aim: tuple[float, float], speed: float) -> None:
    headway = Headway()
    for _ in range(3):
        headway.head_for(aim)
        moved(headway, 1.0, speed)
    assert headway.blocked()
    headway.begin()
    assert not headway.blocked()


def test_forwards_and_back_is_no_headway_and_backing_out_is_no_standing_still() -> None:
    headway, backing = headed(), headed()
    for _ in range(4):
        moved(headway, 1.0, 0.2)
        moved(headway, 1.0, -0.2)
    assert headway.blocked()
    moved(backing, 10.0, 0.0, trying=False)
    assert not backing.blocked()


def test_turning_towards_the_way_is_headway_but_not_for_ever() -> None:
    headway = headed((-0.6, 0.01))
    moved(headway, 10.0, 0.0, yaw_rate=0.3)  # on a slow floor, half a turn
    assert not headway.blocked()
    for _ in range(4):
        moved(headway, 1.0, 0.0, yaw_rate=1.0)
        moved(headway, 1.0, 0.0, yaw_rate=-1.0)
    assert headway.blocked()


def test_a_robot_that_stays_at_one_place_goes_astray() -> None:
    """Driving in circles comes nearer to a point that moves along, and leads nowhere."""
    headway = Headway()
    for _ in range(round(NO_HEADWAY_S) + 1):
        headway.head_for((0.6, 0.0))
        moved(headway, 1.0, 0.3, yaw_rate=1.0)
        assert not headway.blocked()
    assert headway.astray()
    headway.leave()
    assert not headway.astray()
    moved(headway, 1.2 * PLACE_M / 0.3, 0.3)
    moved(headway, NO_HEADWAY_S - 1, 0.3, yaw_rate=math.pi / 3)
    assert not headway.astray()
