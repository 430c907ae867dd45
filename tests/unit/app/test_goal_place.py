"""One click, one goal: all experiences of the clicked place count. ACRA 2005 3.6."""

from __future__ import annotations

import numpy as np

from app.pilot.params import PilotParams
from app.pilot.route_following import RouteFollower, nearest_to, of_its_place
from ratslam_core import Pose2
from sim2d import Simulator

from .pilots import Run, a_pilot, follow
from .sessions import a_session
from .worlds import EXACT, HandMadeMap, chain, room


def twice_along(y: float = 0.65) -> HandMadeMap:
    """A corridor of 3 m along which the robot made places twice, 5 cm apart. The two rows are linked at the far end only,
    over 60 s. Places 0 to 12 are the first row, 13 to 25 the second, at y."""
    places, links = chain((0.5, 0.6), (3.5, 0.6))
    n = len(places)
    both = [*links, *((i + n, j + n) for i, j in links), (n - 1, 2 * n - 1)]
    map_ = HandMadeMap([*places, *((x, y) for x, _ in places)], both)
    map_.link_times[-1] = 60.0
    return map_


def goals_at(map_: HandMadeMap, x: float, y: float, goal_place_m: float = 0.1) -> tuple[int, ...]:
    return of_its_place(map_, nearest_to(map_, x, y), PilotParams(goal_place_m=goal_place_m))  # type: ignore[arg-type]


def test_whichever_way_they_face() -> None:
    map_ = twice_along()
    map_.poses[13:, 2] = np.pi
    assert goals_at(map_, 1.02, 0.5) == (2, 15)
    assert goals_at(map_, 1.02, 0.8) == (15, 2)
    assert set(goals_at(map_, 1.0, 0.6, 0.27)) == {1, 2, 3, 14, 15, 16}
    assert goals_at(map_, 1.02, 0.5, 0.0) == (2,)
    assert goals_at(map_, 1.0, 0.0) == (2, 15), "around the nearest, not around the click beside the map"


def test_what_can_be_reached_comes_first() -> None:
    """The second row is a submap: a click nearest to it means the row on which the robot is, unless none is near."""
    map_ = twice_along()
    map_.landed = 13
    for robot_x in (0.5, 3.5):
        map_.robot = Pose2(robot_x, 0.6, 0.0)
        assert goals_at(map_, 1.0, 0.65) == (2,)
    map_.poses[13:, 1] = 2.0
    assert goals_at(map_, 1.0, 2.1, 0.26) == (15, 14, 16)


def test_who_is_asked_for_comes_first_also_among_those_at_exactly_the_same_place() -> None:
    map_, p = twice_along(0.6), PilotParams(goal_place_m=0.1)
    assert [of_its_place(map_, goal, p) for goal in (15, 2)] == [(15, 2), (2, 15)]  # type: ignore[arg-type]


def test_the_route_leads_to_the_quickest() -> None:
    """By the links the second row is a minute farther than the first, on which the robot is."""
    map_ = twice_along(2.0)  # too far apart for an imagined link
    routes = [RouteFollower(24), RouteFollower(24, None, [11])]
    for follower in routes:
        follow(follower, map_)
    to_one, to_either = (follower.progress(map_) for follower in routes)  # type: ignore[arg-type]
    assert (to_one.route[-1], to_either.route[-1], to_either.experience) == (24, 11, 24)  # it is still called 24
    assert to_one.eta_s is not None
    assert to_either.eta_s is not None
    assert to_one.eta_s > to_either.eta_s + 55


def test_to_come_to_one_of_them_is_to_arrive() -> None:
    map_ = HandMadeMap(*chain((0.5, 0.6), (3.5, 0.6)))
    map_.robot = Pose2(3.25, 0.58, 0.0)  # beside experience 11
    for others, state in (((), "tracking"), ((11,), "arrived")):
        follower = RouteFollower(6, None, others)
        follow(follower, map_)
        assert follower.state == state


def test_a_robot_goes_to_the_quickest_and_says_so() -> None:
    run = Run(Simulator(room(start=(0.5, 0.6, 0.0)), EXACT, 1), a_pilot(1), twice_along())
    run.pilot.set_goal(24, [11])
    assert run.pilot.goals == (24, 11)
    run.run(30.0)
    assert run.pilot.goal_state == (24, "arrived")


def test_a_click_takes_all_of_the_place_unless_it_is_switched_off() -> None:
    session = a_session(100)
    x, y = session.brain.experience_map.poses[3, :2].tolist()
    assert session.set_goal(x, y) == session.pilot.goals[0]
    assert len(session.pilot.goals) > 1
    session.set_parameter("pilot.goal_place_m", 0.0)
    assert (session.set_goal(x, y),) == session.pilot.goals
    session.cancel_goal()
    assert session.pilot.goals == ()
