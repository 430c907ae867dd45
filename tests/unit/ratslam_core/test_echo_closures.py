"""Loop closures by echoes: a robot that drives round in a room, and then back the other way, where no view is known."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import pytest

from ratslam_core import ExperienceMap, ExperienceMapParams, Odometry, Packet, Pose2, Recognition
from ratslam_core.extensions.echo_closures import LEAST, MOST, OPEN_M, POINTS, EchoClosures
from ratslam_core.extensions.scan_matching import ScanMatching
from ratslam_core.parts import Matched
from ratslam_core.pose_graph.transitions import moved_by
from tests.unit.ratslam_core.test_scan_matching import ANGLES, ROOM, ranges

RADIUS_M, STEP_M = 0.8, 0.1


class Robot:
    """Each 0.2 m it makes an experience of a view that it never saw before. Its gyro turns too little."""

    def __init__(self) -> None:
        self.map = ExperienceMap((36, 64, 64), 0.25, ExperienceMapParams(sweeps=0, solve_every=0))
        self.scans, self.closures = ScanMatching(ANGLES), EchoClosures()
        self.true, self.births, self.steps = Pose2(0.3, -0.9, 0.0), list[Pose2](), 0
        self.step(Odometry(0.0, 0.0, 1.0))

    def step(self, moved: Odometry) -> None:
        self.true = self.true.compose(moved_by(moved))
        told = Odometry(moved.speed, 0.97 * moved.yaw_rate, moved.dt)
        view, self.steps = self.steps // 2, self.steps + 1
        new = self.steps % 2 == 1
        self.scans.sense(ranges(ROOM, self.true), told, 1)
        at = Packet(0.31 * view % 64, 0.17 * view % 64, 0.0, 1.0)
        if self.map.step(at, Recognition(view, new, view, 1.0, 0.0), told):
            self.births.append(self.true)
            self.scans.made(self.map.here)
            self.closures.made(self.map, self.scans)

    def circle(self, left: float, way_m: float) -> None:
        for _ in range(round(way_m / STEP_M)):
            self.step(Odometry(STEP_M, left * STEP_M / RADIUS_M, 1.0))

    def ties(self) -> list[int]:
        """Rows from one experience to another that is not the next."""
        t = self.map.transitions
        return [row for row in range(t.count) if abs(int(t.ends[row, 1] - t.ends[row, 0])) != 1]


@pytest.fixture(scope="module")
def back() -> Robot:
    """Round in the room, about, and round again."""
    robot = Robot()
    robot.circle(1.0, 7.0)
    for _ in range(4):
        robot.step(Odometry(0.0, math.pi / 4, 1.0))
    robot.circle(-1.0, 9.0)
    return robot


def test_who_comes_back_the_other_way_closes_the_loop(back: Robot) -> None:
    """The ties are as the robot truly was, and ways that it can drive."""
    ties, t = back.ties(), back.map.transitions
    assert ties
    assert back.map.closures == len(ties)
    for row in ties:
        old, new = t.ends[row].tolist()
        off = Pose2(*t.move[row].tolist()).inverse().compose(back.births[old].inverse().compose(back.births[new]))
        assert (off.x, off.y, off.heading_rad) == pytest.approx((0.0, 0.0, 0.0), abs=0.12)
        turned = abs(math.remainder(back.births[new].heading_rad - back.births[old].heading_rad, math.tau))
        assert (old, new) in t.row_of
        assert turned > 1.5 or old > 35, "from the other side, or on the second round back"


def test_what_is_tied_already_is_not_tied_again(back: Robot) -> None:
    made = np.array([back.map.transitions.ends[row, 1] for row in back.ties()])
    assert np.all(np.diff(made) * 2 * STEP_M >= OPEN_M - 0.5)


class _Says:
    """Scans that say of each new experience where it is to the first."""

    def __init__(self) -> None:
        self.count, self.found = 0, Matched(Pose2(0.0, 0.0, 0.0), 0.05, 0.1, POINTS)

    def before(self, experiences: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
        return np.arange(experiences) == 0

    def match(self, *_: object) -> Matched:
        return self.found


class _Map:
    """Two experiences, one old, one where the robot is, far apart by odometry."""

    def __init__(self) -> None:
        full = Robot()
        full.circle(1.0, 5.0)
        self.map, self.robot_here, self.here, self.carried = full.map, Pose2(0.4, 0.0, 0.0), len(full.map) - 1, False
        self.tied = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.map, name)

    def __len__(self) -> int:
        return len(self.map)

    def tie(self, *_: object, way: bool) -> None:
        self.tied += way


@pytest.mark.parametrize(
    ("later", "second", "ties"),
    [
        (LEAST, Pose2(0.1, 0.0, 0.0), 1),
        (LEAST - 1, Pose2(0.1, 0.0, 0.0), 0),
        (MOST + 1, Pose2(0.1, 0.0, 0.0), 0),
        (LEAST, Pose2(0.4, 0.0, 0.0), 0),
        (LEAST, Pose2(0.1, 0.0, 0.2), 0),
    ],
    ids=["some way on", "at once", "long after", "elsewhere", "turned"],
)
def test_one_match_is_no_closure(later: int, second: Pose2, ties: int) -> None:
    """Two are, if some way lies between them and they say the same."""
    map_, scans, closures = _Map(), _Says(), EchoClosures()
    closures.made(map_, cast(Any, scans))
    assert map_.tied == 0
    scans.count, scans.found = later, Matched(second, 0.05, 0.1, POINTS)
    closures.made(map_, cast(Any, scans))
    assert map_.tied == ties


@pytest.mark.parametrize(
    "poor",
    [
        Matched(Pose2(0.0, 0.0, 0.0), 0.5, 0.1, POINTS),
        Matched(Pose2(0.0, 0.0, 0.0), 0.05, 0.2, POINTS),
        Matched(Pose2(0.0, 0.0, 0.0), 0.05, 0.1, POINTS - 1),
    ],
    ids=["not precise", "not alike", "few echoes"],
)
def test_a_poor_match_counts_for_nothing(poor: Matched) -> None:
    map_, scans, closures = _Map(), _Says(), EchoClosures()
    closures.made(map_, cast(Any, scans))
    scans.count, good, scans.found = LEAST, scans.found, poor
    closures.made(map_, cast(Any, scans))
    assert map_.tied == 0
    scans.found = good
    closures.made(map_, cast(Any, scans))
    assert map_.tied == 1


def test_a_robot_that_was_carried_closes_nothing_and_forgets() -> None:
    map_, scans, closures = _Map(), _Says(), EchoClosures()
    closures.made(map_, cast(Any, scans))
    scans.count, map_.carried = LEAST, True
    closures.made(map_, cast(Any, scans))
    map_.carried = False
    closures.made(map_, cast(Any, scans))
    assert map_.tied == 0
