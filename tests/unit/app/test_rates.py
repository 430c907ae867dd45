"""The rate changes, the result does not: one drive of exact moves at 1 to 60 Hz ends at one place with one map.

ACRA 2004 section 4 asks it of path integration; here it holds for the whole engine from 10 Hz on. Below, it has fewer
images: in the office its map is a little coarser, and where much looks alike it may be another. docs/findings.md has the
figures.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from app.config import Config
from app.config.presets import ROBOTS
from app.protocol.course import Course
from app.protocol.steps import Move
from app.session import Session
from ratslam_core.params.presets import PRESETS
from sim2d import load_world

pytestmark = pytest.mark.slow

# Two laps of the office, and of the loop. Between a straight stretch and a turn on the spot the robot stands for a second,
# since a wheel report of one second knows one speed and one yaw rate.
SIDES = {"office": (27.0, 11.0, 27.0, 11.0), "loop": (7.0, 14.0, 14.0, 14.0, 7.0)}
TURN = [(0.0, 0.0, 1.0), (0.0, 30.0, 3.0), (0.0, 0.0, 1.0)]


class End(NamedTuple):
    """Where the winning packet ended (cells, rad), the error of the map (m), and its experiences and links."""

    packet: tuple[float, float, float]
    map_m: float
    experiences: int
    links: int


@cache
def end(world: str, preset: str, front_end: str, rate: int) -> End:
    sides = SIDES[world]
    moves = [move for k, s in enumerate(sides) for move in ([(0.3, 0.0, s)] + TURN * (k < 4))]
    values = {**PRESETS[preset], **ROBOTS["ideal"], "robot.sensor_rate_hz": rate, "office.people": False}
    if front_end:
        values["local_view.front_end"] = front_end
    session = Session(load_world(world), 1, Config().with_values(values))
    for _ in Course(session, [Move(do="move", moves=moves, times=2)]).ticks():
        session.tick()
    map_, packet = session.brain.experience_map, session.estimate.packet
    error, _ = session.evaluation.errors(map_)
    return End((packet.x, packet.y, packet.heading_rad), error, len(map_), len(map_.links))


def apart(a: End, b: End) -> tuple[float, float]:
    """Between the ends of two drives, in metres and rad; the pose cells wrap after 64 cells of 0.25 m."""
    dx, dy = (math.remainder(a.packet[k] - b.packet[k], 64) for k in (0, 1))
    return 0.25 * math.hypot(dx, dy), abs(math.remainder(a.packet[2] - b.packet[2], math.tau))


@pytest.mark.parametrize(
    ("world", "preset", "front_end", "rate"),
    [("office", "ours", "", 60), ("office", "paper-2006", "", 20),
     *(pytest.param(*each, marks=pytest.mark.long) for each in (
         ("office", "ours", "", 20), ("office", "ours", "", 30), ("loop", "ours", "", 60),
         ("office", "paper-2006", "scene numbers", 30)))],
)  # fmt: skip
def test_at_a_faster_rate_the_engine_does_the_same(world: str, preset: str, front_end: str, rate: int) -> None:
    usual, fast = end(world, preset, front_end, 10), end(world, preset, front_end, rate)
    metres, turned = apart(usual, fast)
    assert metres < 0.01
    assert turned < 0.01
    assert (fast.experiences, fast.links) == (usual.experiences, usual.links)
    assert fast.map_m == pytest.approx(usual.map_m, abs=0.02)


def test_at_a_slower_rate_it_comes_to_the_same_place_with_a_coarser_map() -> None:
    usual = end("office", "ours", "", 10)
    for slow in (end("office", "ours", "", rate) for rate in (1, 2, 5)):
        metres, turned = apart(usual, slow)
        assert metres < 0.1
        assert turned < math.radians(10)
        assert slow.map_m < usual.map_m + 0.15
        assert 0.5 * usual.experiences < slow.experiences <= 1.2 * usual.experiences


def test_the_rate_may_change_on_the_way() -> None:
    session = Session(load_world("office"), 1, Config().with_values(dict(ROBOTS["ideal"])))
    session.pilot.drive(0.3, 0.0)
    for rate in (10, 60, 1, 30, 10):
        session.set_parameter("robot.sensor_rate_hz", rate)
        for _ in range(2 * rate):
            session.tick()
    truth = session.simulator.truth
    robot = session.brain.experience_map.robot
    assert np.hypot(truth.x - 1.0 - robot.x, truth.y - 1.0 - robot.y) < 0.1
