"""What was tried in vain."""

from __future__ import annotations

import numpy as np

from app.pilot.tried import Tried
from ratslam_core import Pose2

from .worlds import HandMadeMap

ABOUT_M, AGAIN_S = 1.0, 100.0


def along(count: int) -> HandMadeMap:
    map_ = HandMadeMap([(0.5 * k, 0.0) for k in range(count)], [])
    map_.robot = Pose2(0.0, 0.0, 0.0)
    return map_


def near(tried: Tried, map_: HandMadeMap, now_s: float, *places: tuple[float, float]) -> list[bool]:
    return tried.near(map_, np.array(places), now_s).tolist()  # type: ignore[arg-type]


def add(tried: Tried, map_: HandMadeMap, experience: int, now_s: float, x: float = 0.0, y: float = 0.0) -> None:
    tried.add(map_, experience, x, y, now_s)  # type: ignore[arg-type]


def test_what_lies_about_it_is_left_alone_and_moves_with_the_map() -> None:
    tried, map_ = Tried(ABOUT_M, AGAIN_S), along(10)
    assert near(tried, map_, 0.0, (2.0, 0.0)) == [False]
    add(tried, map_, 4, 0.0, y=1.0)
    map_.poses[4] = 7.0, 5.0, np.pi / 2  # turned to the left: what lay beside it lies behind
    there = (6.0, 5.0), (6.0, 5.9), (6.0, 6.1), (2.0, 1.0)
    assert near(tried, map_, 0.0, *there) == [True, True, False, False]


def test_after_each_trial_for_twice_as_long() -> None:
    """Trials a little beside it count, those elsewhere do not."""
    tried, map_, now_s = Tried(ABOUT_M, AGAIN_S), along(10), 0.0
    for wait_s, at in ((AGAIN_S, 4), (2 * AGAIN_S, 5), (4 * AGAIN_S, 4)):
        add(tried, map_, at, now_s)
        add(tried, map_, 9, now_s)
        assert near(tried, map_, now_s + wait_s - 0.1, (2.2, 0.0)) == [True]
        assert near(tried, map_, now_s + wait_s, (2.2, 0.0)) == [False]
        now_s += wait_s


def test_what_lies_on_another_submap_is_not_left_alone() -> None:
    """Where that lies to the robot nobody knows."""
    tried, map_ = Tried(ABOUT_M, AGAIN_S), along(10)
    add(tried, map_, 4, 0.0)
    map_.landed, map_.robot = 5, Pose2(4.5, 0.0, 0.0)
    assert near(tried, map_, 0.0, (2.0, 0.0)) == [False]


def test_on_another_map_nothing_was_tried() -> None:
    tried, map_ = Tried(ABOUT_M, AGAIN_S), along(10)
    add(tried, map_, 9, 0.0)
    shorter = along(5)
    assert near(tried, shorter, 0.0, (4.5, 0.0)) == [False]
    assert near(tried, map_, 0.0, (4.5, 0.0)) == [False]
