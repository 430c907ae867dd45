"""What the robot remembers of the ground: times, sonar ranges, and where open floor was never driven on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot.known_ground import (
    LOOKS,
    MISSED_M,
    OLD_AFTER_S,
    OPENING_MOST_M,
    PLACE_REACH_M,
    THIN_M,
    UNSEEN_M2,
    KnownGround,
)
from ratslam_core import Pose2

from .pilots import ANGLES, DT, FAR
from .worlds import HandMadeMap

NEAR = np.full(8, 1.0, np.float32)
OPEN_LEFT = np.array([4.0, *NEAR[1:]], np.float32)  # a corridor of which one side is open
Places = list[tuple[float, float]]


def along(count: int, y: float = 0.0) -> Places:
    return [(0.1 * k, y) for k in range(count)]


def driven(places: Places, ranges: np.ndarray = OPEN_LEFT) -> tuple[KnownGround, HandMadeMap]:
    """A robot that made experiences at these places, one after the other, and heard these ranges."""
    ground = KnownGround(ANGLES)
    for n in range(1, len(places) + 1):
        map_ = HandMadeMap(places[:n], [])
        map_.robot = Pose2(*places[n - 1], 0.0)
        ground.step(map_, ranges, 0.3, DT)  # type: ignore[arg-type]
    return ground, HandMadeMap(places, [])


def openings(ground: KnownGround, map_: HandMadeMap) -> tuple[np.ndarray, np.ndarray]:
    rows, places, area = ground.openings(map_)  # type: ignore[arg-type]
    assert len(rows) == len(places) == len(area)
    assert (area > 0).all()
    return rows, places


def test_open_floor_that_was_never_driven_on_is_an_opening() -> None:
    """On the open side only, within reach, and as far as the sonars saw; one that was tried moves with the map."""
    ground, map_ = driven(along(60))
    rows, places = openings(ground, map_)
    assert len(rows) == len(places) > 10
    assert places[:, 1] == pytest.approx(OPENING_MOST_M)
    assert places[:, 0] == pytest.approx(0.1 * rows)
    ground.tried.add(map_, 10, 0.5, OPENING_MOST_M, ground.now_s)  # type: ignore[arg-type]  # that is at x = 1.5 m
    for x, y in ((0.0, 0.0), (7.0, 5.0)):
        map_.poses[:, :2] += (x, y)
        _, left = openings(ground, map_)
        assert 0 < len(left) < len(places)
        assert np.hypot(left[:, 0] - 1.5 - x, left[:, 1] - OPENING_MOST_M - y).min() > THIN_M


def test_what_it_sees_ahead_look_after_look_is_an_opening() -> None:
    """In a corridor a single beam looks ahead. An echo that goes and comes, as of somebody who passes, makes none."""
    ahead = np.array([*NEAR[:3], 4.0, *NEAR[4:]], np.float32)
    for looks, found in ((1, False), (LOOKS - 1, False), (LOOKS, True)):
        ground, map_ = driven([(0.0, 0.0)], NEAR)
        map_.robot = Pose2(1.0, 0.0, 0.5)
        for ranges in (ahead, ahead, NEAR, *looks * [ahead]):
            ground.step(map_, ranges, 0.0, DT)  # type: ignore[arg-type]
        rows, places = openings(ground, map_)
        bearing = 0.5 + ANGLES[3]
        there = (1.0 + OPENING_MOST_M * math.cos(bearing), OPENING_MOST_M * math.sin(bearing))
        assert rows.tolist() == found * [0]
        assert places == pytest.approx(np.array(found * [there]).reshape(-1, 2))


def test_how_much_new_ground_lies_about_an_opening_is_known() -> None:
    """A hall that was seen along 6 m, and a niche along half a metre."""
    ground, map_ = driven(along(80))
    ground._seen_m[60:75, 0] = 1.0
    rows, _, area = ground.openings(map_)  # type: ignore[arg-type]
    area -= UNSEEN_M2
    assert area[rows == 30].min() > 2 * area[rows >= 75].max()


def test_a_way_that_led_nowhere_counts_for_what_lies_near() -> None:
    """What was seen from about where a trip did not get to is left alone, too."""
    ground, map_ = driven(along(100))
    ground.missed.add(map_, 20, 0.0, 0.0, ground.now_s)  # type: ignore[arg-type]
    rows, _ = openings(ground, map_)
    assert set(rows.tolist()) == {k for k in range(100) if 0.1 * abs(k - 20) >= MISSED_M - 1e-9}


def test_what_lies_on_another_submap_hides_no_opening() -> None:
    """The robot was carried to where, for all it knows, the rest of its map might be."""
    ground, map_ = driven(along(30, y=2.5) + along(30))
    map_.robot = Pose2(1.0, 0.0, 0.0)
    assert map_.active >= 30
    rows, _ = openings(ground, map_)
    assert (rows < 30).all()
    map_.landed = 30
    rows, _ = openings(ground, map_)
    assert len(rows)
    assert (rows >= 30).all()


def test_what_was_driven_on_is_no_opening() -> None:
    square = [(0.4 * i, 0.4 * j) for i in range(15) for j in range(15)]
    ground, map_ = driven(square, FAR)
    _, places = openings(ground, map_)
    assert len(places)
    for place in places:  # outside of the square only
        assert min(math.dist(place, known) for known in square) > THIN_M
    ground, map_ = driven(square, NEAR)
    assert not len(openings(ground, map_)[0])


def test_new_ground_is_counted_until_old_ground_is_met() -> None:
    places = [(1.0 * k, 0.0) for k in range(10)]
    ground, map_ = driven(places, FAR)
    assert ground.new_m == pytest.approx(3.0)
    map_.robot = Pose2(0.0, 0.0, 0.0)
    ground.step(map_, FAR, 0.3, DT)  # type: ignore[arg-type]
    assert ground.new_m == pytest.approx(3.3)  # it was made only a moment ago
    ground.step(map_, FAR, 0.0, OLD_AFTER_S)  # type: ignore[arg-type]
    assert ground.new_m == 0.0
    assert ground.last_s[0] == ground.now_s
    assert ground.last_s[1] < 2.0
    ground.been_at(2.0, 0.0, map_.poses)
    assert (ground.last_s == ground.now_s).tolist() == [abs(x - 2) < PLACE_REACH_M or x == 0 for x, _ in places]


def test_another_map_is_learnt_afresh() -> None:
    ground, _ = driven(along(1500), FAR)  # more than the first rows hold
    assert ground.count == 1500
    ground.step(HandMadeMap([(0.0, 0.0)], []), FAR, 0.0, DT)  # type: ignore[arg-type]
    assert ground.count == 1
