"""What a map says when it is asked for what it does not have."""

from __future__ import annotations

import pytest

from ratslam_core import ExperienceMap, Pose2

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
