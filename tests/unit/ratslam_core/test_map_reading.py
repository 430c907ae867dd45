"""What a map answers when it is asked for something that it does not have."""

from __future__ import annotations

import math

import pytest

from ratslam_core import ExperienceMap, Pose2
from ratslam_core.types import wrap_angle

from .drives import CELL_M, SHAPE, Robot


def test_what_each_experience_stands_for_can_be_read_as_arrays() -> None:
    robot = Robot(start=Pose2(1.0, 0.0, 0.3))
    robot.see(4, new=True)
    robot.go(1.0, 0.2, 9, new=True)
    map_ = robot.map
    assert map_.views.tolist() == [4, 9]
    for i in range(2):
        assert map_.cell_state(i) == (*map_.cell_states[i], map_.views[i])
        assert map_.pose(i) == Pose2(*map_.poses[i])


@pytest.mark.parametrize("experience", [-1, 2, 100])
def test_an_experience_that_is_none_is_refused(experience: int) -> None:
    robot = Robot()
    robot.see(0, new=True)
    robot.go(1.0, 0.0, 1, new=True)
    for ask in (robot.map.pose, robot.map.cell_state, lambda i: robot.map.energy(i, robot.packet(), 0)):
        with pytest.raises(ValueError, match=f"experience must be from 0 to 1, got {experience}"):
            ask(experience)


def test_a_map_without_experiences_says_so() -> None:
    empty = ExperienceMap(SHAPE, CELL_M)
    assert (len(empty), empty.link_count, empty.active) == (0, 0, -1)
    with pytest.raises(ValueError, match="there is no experience yet"):
        empty.robot  # noqa: B018


def test_the_residual_is_how_far_links_and_map_disagree() -> None:
    robot = Robot(start=Pose2(1.0, 0.0, 0.3))
    robot.see(4, new=True)
    assert robot.map.residual == (0.0, 0.0)
    for view, turn in ((9, 0.2), (11, -0.4), (12, 1.0)):
        robot.go(1.0, turn, view, new=True)
    map_ = robot.map
    assert map_.residual == pytest.approx((0.0, 0.0), abs=1e-9)
    map_.poses[2] += (0.3, -0.4, 0.1)
    t = map_.transitions
    squares = angles = weights = 0.0
    for row in range(t.count):
        if not t.travelled[row]:
            continue
        i, j = t.ends[row].tolist()
        said = map_.pose(i).compose(Pose2(*t.move[row].tolist()))
        has, weight = map_.pose(j), float(t.believed[row])
        squares += weight * ((said.x - has.x) ** 2 + (said.y - has.y) ** 2)
        angles += weight * wrap_angle(said.heading_rad - has.heading_rad) ** 2
        weights += weight
    assert map_.residual == pytest.approx((math.sqrt(squares / weights), math.sqrt(angles / weights)))
    assert map_.residual[0] > 0.1
