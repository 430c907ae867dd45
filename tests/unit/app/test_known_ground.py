"""What the robot remembers of the ground: times, sonar ranges, and where open floor was never driven on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot.known_ground import KnownGround
from app.pilot.params import PilotParams
from ratslam_core import Pose2

from .pilots import ANGLES, DT, FAR, OUTWARD
from .worlds import HandMadeMap

USUAL = PilotParams(**OUTWARD)

NEAR = np.full(8, 1.0, np.float32)


def driven(places: list[tuple[float, float]], ranges: np.ndarray) -> tuple[KnownGround, HandMadeMap]:
    """A robot that made experiences at these places, one after the other, and heard these ranges."""
    ground = KnownGround(ANGLES)
    for n in range(1, len(places) + 1):
        map_ = HandMadeMap(places[:n], [])
        map_.robot = Pose2(*places[-1], 0.0)
        map_.robot = Pose2(*places[n - 1], 0.0)
        ground.step(map_, ranges, 0.3, DT, USUAL)  # type: ignore[arg-type]
    return ground, HandMadeMap(places, [])


def test_open_floor_that_was_never_driven_on_is_an_opening() -> None:
    """Along a corridor with one side open: openings lie on that side only, within reach, and as far as the sonars saw."""
    ranges = NEAR.copy()
    ranges[0] = 4.0  # the sonar to the left
    ground, map_ = driven([(0.1 * k, 0.0) for k in range(30)], ranges)
    rows, places = ground.openings(map_, USUAL, 3)  # type: ignore[arg-type]
    assert len(rows) == len(places) > 10
    assert places[:, 1] == pytest.approx(USUAL.opening_most_m)
    assert places[:, 0] == pytest.approx(0.1 * rows)
    ground.tried(10, 0.5, USUAL.opening_most_m, map_.poses, USUAL)  # that is at x = 1.5 m
    _, left = ground.openings(map_, USUAL, 3)  # type: ignore[arg-type]
    assert 0 < len(left) < len(places)
    assert np.hypot(left[:, 0] - 1.5, left[:, 1] - USUAL.opening_most_m).min() > USUAL.thin_m


def test_a_tried_opening_moves_with_the_map() -> None:
    ranges = NEAR.copy()
    ranges[0] = 4.0
    ground, map_ = driven([(0.1 * k, 0.0) for k in range(60)], ranges)
    ground.tried(10, 0.5, USUAL.opening_most_m, map_.poses, USUAL)
    map_.poses[:, :2] += (7.0, 5.0)
    _, left = ground.openings(map_, USUAL, 3)  # type: ignore[arg-type]
    assert len(left)
    assert np.hypot(left[:, 0] - 8.5, left[:, 1] - USUAL.opening_most_m - 5.0).min() > USUAL.thin_m


def test_an_opening_is_tried_again_later() -> None:
    """Somebody stood in the way, perhaps. After each trial it is left alone for twice as long."""
    ranges = NEAR.copy()
    ranges[0] = 4.0
    ground, map_ = driven([(0.1 * k, 0.0) for k in range(30)], ranges)

    def seen() -> int:
        return len(ground.openings(map_, USUAL, 3)[0])  # type: ignore[arg-type]

    before = seen()
    for wait_s in (USUAL.opening_again_s, 2 * USUAL.opening_again_s, 4 * USUAL.opening_again_s):
        ground.tried(10, 0.5, USUAL.opening_most_m, map_.poses, USUAL)
        ground.now_s += wait_s - 1.0
        assert seen() < before
        ground.now_s += 2.0
        assert seen() == before


def test_what_lies_on_another_island_hides_no_opening() -> None:
    """The robot was carried to where, for all it knows, the rest of its map might be."""
    ranges = NEAR.copy()
    ranges[0] = 4.0
    ground, map_ = driven([(0.1 * k, 2.5) for k in range(30)] + [(0.1 * k, 0.0) for k in range(30)], ranges)
    map_.robot = Pose2(1.0, 0.0, 0.0)
    assert map_.active >= 30
    rows, _ = ground.openings(map_, USUAL, 3)  # type: ignore[arg-type]
    assert (rows < 30).all()
    map_.landed = 30
    rows, _ = ground.openings(map_, USUAL, 3)  # type: ignore[arg-type]
    assert len(rows)
    assert (rows >= 30).all()


def test_a_far_opening_is_far_from_all_that_is_known() -> None:
    """Driven along a wall of a hall: what the sonar to the left saw of the hall is far, what it saw of a corridor is not."""
    for reach, is_far in ((5.0, True), (3.0, False)):
        ranges = NEAR.copy()
        ranges[0] = reach
        ground, map_ = driven([(0.1 * k, 0.0) for k in range(60)], ranges)
        rows, places = ground.far_openings(map_, USUAL)  # type: ignore[arg-type]
        assert bool(len(rows)) == is_far
        assert (places[:, 1] > USUAL.far_m).all()


def test_what_was_driven_on_is_no_opening() -> None:
    square = [(0.4 * i, 0.4 * j) for i in range(15) for j in range(15)]
    ground, map_ = driven(square, FAR)
    _, places = ground.openings(map_, USUAL, 3)  # type: ignore[arg-type]
    assert len(places)
    for place in places:  # outside of the square only
        assert min(math.dist(place, known) for known in square) > USUAL.thin_m
    ground, map_ = driven(square, NEAR)
    assert not len(ground.openings(map_, USUAL, 3)[0])  # type: ignore[arg-type]


def test_new_ground_is_counted_until_old_ground_is_met() -> None:
    places = [(1.0 * k, 0.0) for k in range(10)]
    ground, map_ = driven(places, FAR)
    assert ground.new_m == pytest.approx(3.0)
    map_.robot = Pose2(0.0, 0.0, 0.0)
    ground.step(map_, FAR, 0.3, DT, USUAL)  # type: ignore[arg-type]
    assert ground.new_m == pytest.approx(3.3)  # it was made only a moment ago
    ground.step(map_, FAR, 0.0, USUAL.old_after_s, USUAL)  # type: ignore[arg-type]
    assert ground.new_m == 0.0
    assert ground.last_s[0] == ground.now_s
    assert ground.last_s[1] < 2.0
    ground.been_at(2.0, 0.0, map_.poses, USUAL)
    assert (ground.last_s == ground.now_s).tolist() == [abs(x - 2) < USUAL.place_reach_m or x == 0 for x, _ in places]


def test_another_map_is_learnt_afresh() -> None:
    ground, _ = driven([(0.1 * k, 0.0) for k in range(1500)], FAR)  # more than the first rows hold
    assert ground.count == 1500
    ground.step(HandMadeMap([(0.0, 0.0)], []), FAR, 0.0, DT, USUAL)  # type: ignore[arg-type]
    assert ground.count == 1
