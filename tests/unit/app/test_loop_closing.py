"""Closing a loop: known ground that is near, but far by the links."""

from __future__ import annotations

import math

import numpy as np

from app.pilot.loop_closing import FAR_M, LOOP_AGAIN_S, LOOP_S, MIDDLE_M, LoopCloser
from app.pilot.params import PilotParams
from ratslam_core import Pose2

from .pilots import ANGLES, FAR
from .worlds import HandMadeMap, chain

USUAL = PilotParams()


class Unrecognised(HandMadeMap):
    """The robot is at the end of its way, and does not know the place again."""

    active = property(lambda self: len(self) - 1)  # type: ignore[assignment]


def almost_round() -> HandMadeMap:
    """Along the x axis, and back to 5 m before its beginning over a way round, headed along x again."""
    places, links = chain((0.0, 0.0), (25.0, 0.0), (25.0, 15.0), (-15.0, 15.0), (-15.0, 0.0), (-5.0, 0.0), every=0.5)
    map_ = Unrecognised(places, links)
    moves = np.diff(map_.poses[:, :2], axis=0)
    map_.poses[:-1, 2] = np.arctan2(moves[:, 1], moves[:, 0])
    map_.robot = Pose2(-5.0, 0.0, 0.0)
    return map_


def chooses(map_: HandMadeMap, closer: LoopCloser, ranges: np.ndarray = FAR, now_s: float = 1000.0) -> bool:
    times = map_.temporal_map.times_to(map_.active)
    return closer.choose(map_, ranges, times, now_s, USUAL) is not None  # type: ignore[arg-type]


def closing() -> tuple[HandMadeMap, LoopCloser]:
    """A robot that has chosen to close its loop."""
    map_, closer = almost_round(), LoopCloser(ANGLES)
    assert chooses(map_, closer)
    return map_, closer


def aim_of(closer: LoopCloser, map_: HandMadeMap) -> tuple[float, float] | None:
    return closer.aim(map_, 0.1, USUAL)  # type: ignore[arg-type]


def test_known_ground_that_is_far_by_the_links_is_driven_along() -> None:
    map_, closer = closing()
    while map_.robot.x < 20.0:
        aim = aim_of(closer, map_)
        assert aim is not None
        assert abs(math.atan2(aim[1], aim[0])) < 0.01  # straight on
        map_.robot = Pose2(map_.robot.x + 0.5, 0.0, 0.0)
    map_.robot = Pose2(80.0, -40.0, 0.0)
    assert aim_of(closer, map_) is None


def test_on_old_ground_the_direction_counts_more_than_the_place() -> None:
    """The map is off by 2 m: the robot drives beside the way, and only leans towards it."""
    map_, closer = closing()
    map_.robot = Pose2(0.0, 2.0, 0.0)
    aim = aim_of(closer, map_)
    assert aim is not None
    assert aim[0] > 0.5
    assert -MIDDLE_M - 1e-9 <= aim[1] < 0.0


def test_where_no_links_lead_is_no_loop() -> None:
    """As on another submap: where that lies, the map does not say."""
    map_ = almost_round()
    map_.links = map_.links[:-20]
    map_.link_times = map_.link_times[:-20]
    assert np.isinf(map_.temporal_map.times_to(map_.active)).any()
    assert not chooses(map_, LoopCloser(ANGLES))


def test_a_closed_loop_ends_it() -> None:
    map_, closer = closing()
    map_.links = np.concatenate([map_.links, [(0, len(map_) - 1)]])  # recognised
    map_.link_times = np.append(map_.link_times, 15.0)
    map_.robot = Pose2(0.0, 0.0, 0.0)
    assert aim_of(closer, map_) is None


def test_what_closes_no_loop_is_given_up() -> None:
    map_, closer = closing()
    aims = [aim_of(closer, map_) is not None for _ in range(round(LOOP_S / 0.1) + 2)]
    assert aims[:-4] == [True] * len(aims[:-4])
    assert not aims[-1]


def test_what_the_sonars_do_not_see_is_no_loop() -> None:
    """A wall stands between. Nor is known ground one that is near by the links."""
    assert not chooses(almost_round(), LoopCloser(ANGLES), np.full(8, 2.0, np.float32))
    map_ = HandMadeMap(*chain((0.0, 0.0), (25.0, 0.0)))
    map_.robot = Pose2(20.0, 0.0, math.pi)
    assert not chooses(map_, LoopCloser(ANGLES))


def test_it_is_not_tried_again_at_once() -> None:
    """Neither from there nor to there; after each trial it is left alone for twice as long."""
    map_, closer = closing()
    now_s, goal = 1000.0, closer._goal
    for wait_s in (LOOP_AGAIN_S, 2 * LOOP_AGAIN_S, 4 * LOOP_AGAIN_S):
        assert not chooses(map_, closer, now_s=now_s + wait_s - 1.0)
        now_s += wait_s
        assert chooses(map_, closer, now_s=now_s)
        assert closer._goal == goal


def test_from_elsewhere_it_does_not_head_for_the_same() -> None:
    map_, closer = closing()
    first = map_.poses[closer._goal, :2]
    map_.robot = Pose2(-5.0, FAR_M + 0.1, 0.0)
    afresh = LoopCloser(ANGLES)
    assert chooses(map_, afresh)
    assert math.dist(map_.poses[afresh._goal, :2], first) < FAR_M
    assert chooses(map_, closer)
    assert math.dist(map_.poses[closer._goal, :2], first) >= FAR_M
