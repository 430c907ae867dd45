"""Who was carried drives along a way that it drove before, if it is where it believes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.pilot.active_localisation import active_aim
from app.pilot.params import PilotParams
from ratslam_core import Pose2
from ratslam_core.extensions.evidence import PRIOR, SUBMAP

from .worlds import HandMadeMap

USUAL = PilotParams()
STEP_M, MOST_TURN = 0.05, 0.15  # of a robot that heads for the aim


def a_map(*legs: tuple[float, float, float]) -> HandMadeMap:
    """Straight ways of 6 m, each from a place in one direction, driven one after the other."""
    poses = [(x + 0.2 * i * math.cos(h), y + 0.2 * i * math.sin(h), h) for x, y, h in legs for i in range(31)]
    map_ = HandMadeMap([(x, y) for x, y, _ in poses], [(i, i + 1) for i in range(len(poses) - 1)])
    map_.poses[:, 2] = [h for _, _, h in poses]
    map_.carried = True
    return map_


def suppose(map_: HandMadeMap, *hypotheses: tuple[float, float, float, float]) -> None:
    """x, y, heading, log odds of each."""
    evidence = map_.evidence
    evidence.known, evidence._count = len(map_), len(hypotheses)
    evidence._rows[: len(hypotheses), :4] = hypotheses


def aim(map_: HandMadeMap) -> tuple[float, float] | None:
    return active_aim(map_, USUAL)  # type: ignore[arg-type]


def drive(map_: HandMadeMap, x: float, y: float, heading: float, way_m: float) -> Pose2:
    """Where the robot ends that truly is where it supposes, and drives so far."""
    pose = Pose2(x, y, heading)
    for _ in range(round(way_m / STEP_M)):
        suppose(map_, (pose.x, pose.y, pose.heading_rad, 0.0))
        point = aim(map_)
        assert point is not None
        turn = max(-MOST_TURN, min(MOST_TURN, math.atan2(point[1], point[0])))
        pose = pose.compose(Pose2(0.0, 0.0, turn)).compose(Pose2(STEP_M, 0.0, 0.0))
    return pose


@pytest.mark.parametrize(("aside", "heading"), [(0.0, 0.0), (1.0, -0.4), (-1.5, 0.0), (0.8, 1.2)])
def test_it_comes_to_an_old_way_and_faces_along_it(aside: float, heading: float) -> None:
    """There it sees what it saw before, from the same side: within the innermost ring of the law of evidence."""
    end = drive(a_map((0.0, 0.0, 0.0)), 0.5, aside, heading, 3.5)
    assert abs(end.y) < 0.2
    assert abs(end.heading_rad) < 0.3


def test_of_two_ways_it_takes_the_one_that_it_faces() -> None:
    crossing = a_map((0.0, 0.0, 0.0), (3.0, -3.0, math.pi / 2))
    assert abs(drive(crossing, 2.8, 0.3, 0.1, 2.0).heading_rad) < 0.3
    assert abs(drive(crossing, 2.8, 0.3, math.pi / 2 - 0.1, 2.0).heading_rad - math.pi / 2) < 0.3


def test_on_a_submap_where_nothing_was_mapped_is_no_way() -> None:
    """It was carried twice, the second time at once: the place between the two lies on a submap without an experience."""
    map_ = a_map((0.0, 0.0, 0.0))
    suppose(map_, (1.0, 0.0, 0.0, 0.0))
    assert aim(map_) is not None
    map_.evidence.hypotheses[:, SUBMAP] = 1
    assert aim(map_) is None


def test_what_was_made_next_but_elsewhere_is_not_where_the_way_goes_on() -> None:
    """From the end of the first way the robot drove on over known ground, where it made nothing, and then far away."""
    map_ = a_map((0.0, 0.0, 0.0), (6.0, 40.0, 0.0))
    suppose(map_, (5.8, 0.0, 0.0, 0.0))
    ahead = aim(map_)
    assert ahead is not None
    assert np.allclose(ahead, (0.8, 0.0), atol=0.21)


def test_it_acts_on_the_likeliest_hypothesis_whose_submap_alone_counts() -> None:
    map_ = a_map((0.0, 0.0, 0.0), (0.0, 1.0, math.pi))
    suppose(map_, (1.0, 0.5, math.pi, -1.0), (1.0, 0.5, 0.0, -2.0))
    assert drive(map_, 0.0, 1.0, math.pi, 1.0).y == pytest.approx(1.0, abs=0.05)
    map_.landed = 31  # the second way lies on another submap than the hypothesis
    suppose(map_, (3.0, 0.5, math.pi, 0.0))
    aside = aim(map_)
    assert aside is not None
    assert aside[1] > 0.0  # to the left, where the first way is


def test_who_was_not_carried_or_may_be_anywhere_goes_on_exploring() -> None:
    """And whose likeliest hypothesis has lost by what was seen: else, on new ground, it drove along ways that are not there."""
    map_ = a_map((0.0, 0.0, 0.0))
    assert aim(map_) is None
    suppose(map_, (1.0, 0.5, 0.0, PRIOR - 0.1))
    assert aim(map_) is None
    suppose(map_, (1.0, 0.5, 0.0, 0.0))
    assert aim(map_) is not None
    map_.carried = False
    assert aim(map_) is None
