"""A robot that was carried away maps an island, which is joined as a whole when looks agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratslam_core import ExperienceMapParams, Odometry, Packet, Pose2, PoseFilterParams
from ratslam_core.extensions.islands import Islands, move
from ratslam_core.pose_graph.experiences import Experiences
from ratslam_core.types import Recognition, nothing_seen

from .drives import Robot, relative

NEEDED = 4
PLAIN = ExperienceMapParams(odometry_drift=0.03, sweeps=0, solve_every=0, join_sights=NEEDED, join_views=1)
poses = st.builds(Pose2, st.floats(-9, 9), st.floats(-9, 9), st.floats(-3, 3))


@given(poses, poses, st.lists(poses, min_size=1, max_size=6))
def test_what_is_moved_keeps_its_shape(robot: Pose2, claimed: Pose2, made: list[Pose2]) -> None:
    rows = np.array([[p.x, p.y, p.heading_rad] for p in [*made, robot]])
    before = rows.copy()
    move(np.arange(len(made) + 1), rows, robot, claimed)
    assert rows[-1, :2] == pytest.approx([claimed.x, claimed.y], abs=1e-9)
    for k in range(len(made)):
        was, now = relative(before[-1], before[k]), relative(rows[-1], rows[k])
        assert (now.x, now.y) == pytest.approx((was.x, was.y), abs=1e-9)


def test_a_joined_island_takes_the_number_of_the_other() -> None:
    islands, of = Islands(), np.array([0, 0, 1, 2, 2], np.int32)
    rows = np.zeros((5, 3))
    for experiences in (2, 3):
        islands.begin(experiences)
    assert (islands.current, islands.landed) == (2, 3)
    islands.join(1, of, rows, Pose2(0.0, 0.0, 0.0), Pose2(1.0, 2.0, 0.0))
    assert of.tolist() == [0, 0, 1, 1, 1]
    assert rows[:, :2].tolist() == [[0.0, 0.0]] * 3 + [[1.0, 2.0]] * 2
    assert (islands.current, islands.begun, islands.joined) == (1, 2, 1)


# ---------------------------------------------------------------- in the map


def carried(islands: bool = True, to: Pose2 | None = None, sure: bool = True) -> Robot:
    """A walk along x past the views 0 to 5, after which the robot is carried to the place of view 2, or to another one."""
    robot = Robot(replace(PLAIN, islands=islands, doubtful_sights=3 * NEEDED), filter_params=PoseFilterParams())
    robot.see(0, new=True)
    for view in range(1, 6):
        robot.go(1.0, 0.0, view, new=True)
    robot.map.declare_kidnapped(sure=sure)
    robot.pose = to or Pose2(2.0, 0.0, 0.0)
    return robot


def test_nothing_is_glued_on_a_guess() -> None:
    robot = carried()
    for _ in range(NEEDED - 1):
        robot.see(2)
        assert robot.map.islands.current == 1
        assert robot.map.closures == 0
    assert len(robot.map) == 7  # one on the island
    robot.see(2)
    assert robot.map.islands.current == 0
    assert robot.map.active == 2
    assert robot.map.robot.x == pytest.approx(2.0)


def test_without_islands_the_first_look_is_believed() -> None:
    robot = carried(islands=False)
    robot.see(2)
    assert (robot.map.active, len(robot.map)) == (2, 6)
    assert robot.map.robot.x == pytest.approx(2.0)


@settings(max_examples=20, deadline=None)
@given(st.floats(-2.5, 2.5), st.integers(1, 4))
def test_an_island_is_moved_as_a_whole(heading: float, ways: int) -> None:
    """The robot maps new ground that lies before a known place. When it comes there, all of it is where it belongs."""
    start = Pose2(2.0, 0.0, heading).compose(Pose2(-float(ways), 0.0, 0.0))
    robot = carried(to=start)
    robot.see(10, new=True)
    made = {6: robot.pose}
    for view in range(11, 10 + ways):
        robot.go(1.0, 0.0, view, new=True)
        made[len(robot.map) - 1] = robot.pose
    robot.pose = robot.pose.compose(Pose2(1.0, 0.0, 0.0))
    robot.see(2, odometry=Odometry(10.0, 0.0, 0.1), packet=robot.packet(Pose2(2.0, 0.0, 0.0)), facing=heading)
    for _ in range(NEEDED - 1):
        robot.see(2, packet=robot.packet(Pose2(2.0, 0.0, 0.0)), facing=heading)
    assert robot.map.islands.joined == 1
    assert robot.map.active == 2
    for experience, pose in made.items():
        assert robot.map.poses[experience, :2] == pytest.approx([pose.x, pose.y], abs=1e-6)
    assert robot.map.poses[:6, 0] == pytest.approx(np.arange(6.0), abs=1e-6)  # what was known stays


def test_a_wrong_guess_is_taken_back() -> None:
    """Carried to the place of view 4, the robot first sees 2, which looks like it, then 4 and again 4: the island is moved
    again, and the closure to 2 no longer counts."""
    robot = carried(to=Pose2(4.0, 0.0, 0.0))
    for _ in range(NEEDED):
        robot.see(2, packet=robot.packet(Pose2(2.0, 0.0, 0.0)))
    assert robot.map.robot.x == pytest.approx(2.0)
    t = robot.map.transitions
    wrong = t.row_of.get((6, 2), -1)
    for _ in range(NEEDED):
        robot.see(4)
    assert robot.map.robot.x == pytest.approx(4.0)
    assert robot.map.poses[6, 0] == pytest.approx(4.0)
    assert wrong >= 0
    assert t.weight[wrong] == 0.0
    assert (6, 2) not in t.row_of


def test_a_robot_that_has_found_itself_is_gated_again() -> None:
    robot = carried()
    assert robot.map.lost
    for _ in range(NEEDED):
        robot.see(2)
    robot.map.declare_found()
    for _ in range(2 * NEEDED):
        robot.see(5, packet=robot.packet(Pose2(5.0, 0.0, 0.0)))
    assert robot.map.robot.x == pytest.approx(2.0)
    assert robot.map.gate.sights == 2 * NEEDED


def test_a_robot_that_was_not_carried_after_all_is_found_where_it_was() -> None:
    """Of two places that look alike, the one where it would be anyway comes first, wherever its packet is."""
    robot = carried(to=Pose2(5.0, 0.0, 0.0))
    elsewhere = robot.packet(Pose2(-8.0, 5.0, 0.0))
    for _ in range(NEEDED):
        robot.see(5, packet=elsewhere)
    assert robot.map.active == 5
    assert robot.map.robot.x == pytest.approx(5.0)


@pytest.mark.parametrize(("view", "needed"), [(2, 3 * NEEDED), (5, NEEDED)])
def test_who_was_perhaps_not_carried_asks_for_more(view: int, needed: int) -> None:
    """Where odometry leads to, at view 5, it is believed as soon as ever; at view 2, which may only look alike, later."""
    robot = carried(sure=False)
    place = Pose2(float(view), 0.0, 0.0)
    for sights in range(1, needed + 1):
        robot.see(view, packet=robot.packet(place))
        assert robot.map.islands.joined == (sights == needed)
    assert robot.map.robot.x == pytest.approx(view)


def test_a_doubtful_jump_after_a_sure_one_makes_nothing_doubtful() -> None:
    robot = carried()
    robot.map.declare_kidnapped(sure=False)
    assert robot.map.islands.sure
    robot.map.declare_found()
    robot.map.declare_kidnapped(sure=False)
    assert not robot.map.islands.sure


@given(st.lists(st.integers(0, 3), max_size=40), st.integers(0, 4))
def test_the_experiences_of_a_view_are_found_newest_first(views: list[int], asked: int) -> None:
    known = Experiences((36, 64, 64))
    for view in views:
        known.add(Packet(1.0, 2.0, 0.0, 1.0), view, Pose2(0.0, 0.0, 0.0))
    assert known.of_view(asked).tolist() == [i for i in reversed(range(len(views))) if views[i] == asked]


@pytest.mark.parametrize("hidden", [True, False])
def test_an_own_view_does_not_hide_that_of_another_island(hidden: bool) -> None:
    """Before it can be sure, the robot makes view 20 of what it saw as view 2; from then on that is what it recognises."""
    robot = carried()
    assert robot.map.foreign_views.tolist() == [0, 1, 2, 3, 4, 5]
    robot.see(20, new=True)
    for _ in range(NEEDED):
        assert robot.map.islands.joined == 0
        robot.views.sees = Recognition(2, False, 2, 1.0, 0.0) if hidden else nothing_seen()
        robot.see(20)
    assert robot.map.islands.joined == hidden
    assert robot.map.active == (2 if hidden else 6)
    assert robot.map.foreign_views.tolist() == ([] if hidden else [0, 1, 2, 3, 4, 5])


def test_what_is_seen_elsewhere_counts_for_where_it_is_and_not_for_here() -> None:
    """Another island's view 4 is seen beside its own view 20: the claim is that of view 4."""
    robot = carried(to=Pose2(4.0, 0.0, 1.0))
    robot.see(20, new=True)
    for _ in range(NEEDED):
        robot.views.sees = Recognition(4, False, 4, 1.0, 1.0)
        robot.see(20)
    assert robot.map.active == 4
    assert robot.map.robot.heading_rad == pytest.approx(1.0)
