"""A session is taken through its protocol, and the experimenter writes down what truly happens."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest

from app.config import Config
from app.session import Session
from app.trials.course import Course
from app.trials.notes import Tagged
from app.trials.steps import (
    Door,
    Drive,
    Explore,
    Kidnap,
    Move,
    Repeat,
    Send,
    Set,
    Step,
    Tag,
    TagHere,
    Tour,
    Visit,
    Wait,
)
from sim2d import Place, load_world

pytestmark = pytest.mark.slow

LOOP, LIVING = load_world("loop"), load_world("living")
ROUND = [f"{corner} corner" for corner in ("south-east", "north-east", "north-west", "south-west")]
IDEAL = Config().with_values({"robot.odometry_noise": 0.0, "robot.gyro_bias": 0.0, "robot.odometry_scale_error": 0.0})


def taken(*steps: Step, world=LOOP, seed: int = 3) -> Course:
    """A course that has been taken to its end."""
    course = Course(Session(world, seed, IDEAL), steps)
    for _ in course.ticks():
        course.session.tick()
    return course


def true_pose(course: Course) -> tuple[float, float, float]:
    truth = course.session.simulator.truth
    return truth.x, truth.y, truth.heading_rad


def words(course: Course) -> list[str]:
    return [moment.words for moment in course.moments]


def test_each_step_takes_its_time() -> None:
    assert taken(Explore(do="explore", minutes=0.1)).session.time_s == pytest.approx(6.0)
    assert taken(Wait(do="wait", seconds=2.0)).session.time_s == pytest.approx(2.0)
    assert taken(Move(do="move", moves=[(0.1, 0, 1.0), (0, 30, 0.5)], times=2)).session.time_s == pytest.approx(3.0)
    twice = Repeat(do="repeat", times=2, steps=[Wait(do="wait", seconds=1.0), Wait(do="wait", seconds=0.5)])
    assert taken(twice).session.time_s == pytest.approx(3.0)


def test_the_wheels_are_given_what_a_move_says() -> None:
    course = taken(Move(do="move", moves=[(0.2, 0, 5.0), (0.0, 45, 2.0)]))
    x, y, heading = true_pose(course)
    start = LOOP.starts[0]
    assert (x, y) == pytest.approx((start.x + 1.0, start.y), abs=0.05)
    assert heading == pytest.approx(math.pi / 2, abs=0.1)


def test_a_driven_robot_comes_to_every_point_lap_by_lap() -> None:
    path = ["south-east corner", (5.3, 3.0)]
    course = taken(Drive(do="drive", path=[*path, "south-east corner", "home"], laps=2))
    assert course.session.evaluation.path_m > 2 * 2 * (2.3 + 2.2) - 2.5
    assert math.dist(true_pose(course)[:2], (3.0, 0.8)) < 0.3
    assert course.session.pilot.mode == "manual"


def test_a_point_that_cannot_be_driven_to_is_left_out() -> None:
    course = taken(Drive(do="drive", path=[(3.0, 3.0)]))  # inside the block that the loop goes round
    assert "left out" in words(course)[0]
    assert course.session.time_s == pytest.approx(60.0, abs=1.0)


def test_kidnaps() -> None:
    start = LOOP.starts[0]
    turned = taken(Kidnap(do="kidnap", turn_deg=90))
    assert true_pose(turned) == pytest.approx((start.x, start.y, math.pi / 2))
    placed = taken(Kidnap(do="kidnap", place="north-east corner", heading_deg=-90))
    assert true_pose(placed) == pytest.approx((5.3, 5.3, -math.pi / 2))
    for seed in range(5):
        far = taken(Kidnap(do="kidnap", least_m=3.0), seed=seed)
        assert math.dist(true_pose(far)[:2], (start.x, start.y)) >= 3.0
        assert len(far.session.evaluation.kidnaps) == 1
    with pytest.raises(ValueError, match=r"least_m = 100: no free place so far"):
        taken(Kidnap(do="kidnap", least_m=100.0))


def test_exploring_until_recovered_ends_then() -> None:
    explore = Explore(do="explore", minutes=3)
    course = taken(explore, Kidnap(do="kidnap", turn_deg=90), Explore(do="explore", minutes=3, until="recovered"))
    kidnap = course.session.evaluation.kidnaps[0]
    assert kidnap.after_s is not None
    assert course.session.time_s == pytest.approx(kidnap.at_s + kidnap.after_s + 0.5, abs=0.3)
    assert course.deciding.ok is True
    assert course.deciding.words.startswith("recovered")


def test_parameters_and_doors_change_on_the_way() -> None:
    door = LIVING.doors[0].name
    change = Set(do="set", values={"local_view.match_threshold": 7.0})
    course = taken(change, Door(do="door", name=door, open=True), world=LIVING)
    assert course.session.config.local_view.match_threshold == 7.0
    assert words(course)[:2] == ["local_view.match_threshold = 7.0", f"{door} opens"]


# ------------------------------------------------------------ goals


def followed(tag: Tagged, away: Sequence[float]) -> list[bool]:
    """What a tag at (0, 0) says of a robot that is so far away, tick by tick; experiences are numbered by tick."""
    return [tag.note((metres, 0.0), number) for number, metres in enumerate(away)]


def test_the_nearest_point_of_the_first_good_approach_is_tagged() -> None:
    tag = Tagged(0.0, 0.0, 1.0)
    said = followed(tag, [2.0, 0.9, 0.8, 1.5, 0.6, 0.3, 0.4, 1.2, 0.1, 1.5])
    assert (tag.experience, tag.away_m) == (5, 0.3)  # not 2: too far off; not 8: that was another approach
    assert said == [False] * 7 + [True, False, False]


def test_a_poor_approach_counts_if_there_is_no_better() -> None:
    tag = Tagged(0.0, 0.0, 1.0)
    followed(tag, [2.0, 0.9, 0.8, 1.5, 1.1, 3.0])
    assert (tag.experience, tag.passed) == (2, False)
    assert Tagged(0.0, 0.0, 1.0).experience is None


def test_goals_are_tagged_visited_in_order_and_judged_by_truth() -> None:
    course = taken(
        Tag(do="tag", places=["south-east corner", "north-east corner"]),
        Drive(do="drive", path=ROUND, laps=2),
        Visit(do="visit", places=["north-east corner", "south-east corner"], timeout_s=120),
    )
    assert [visit.name for visit in course.visits] == ["north-east corner", "south-east corner"]
    x, y, _ = true_pose(course)
    last = course.visits[-1]
    assert last.miss_m == pytest.approx(math.dist((x, y), (5.3, 0.8)))
    assert all(visit.reached == (visit.why == "") for visit in course.visits)
    assert all(visit.miss_m <= 1.0 for visit in course.visits if visit.reached)
    assert any(visit.reached for visit in course.visits)
    assert sum(visit.time_s for visit in course.visits) < course.session.time_s


def test_what_stands_for_a_place_does_not_change_on_the_way_to_it() -> None:
    steps = Tag(do="tag", places=["south-east corner"]), Drive(do="drive", path=["south-east corner", "home"])
    visit = Visit(do="visit", places=["south-east corner"], timeout_s=60)
    before, after = taken(*steps), taken(*steps, visit, visit)
    assert before.tags["south-east corner"].experience == after.tags["south-east corner"].experience


def test_a_goal_that_was_never_approached_or_not_reached_is_a_failure_and_decides() -> None:
    place = Tag(do="tag", places=["north-west corner"])
    never = taken(place, Wait(do="wait", seconds=1), Visit(do="visit", places=["north-west corner"]))
    assert never.visits[0].why == "never approached while exploring"
    assert never.deciding.ok is False
    near = Tag(do="tag", places=["home"]), Drive(do="drive", path=["south-east corner", (5.3, 3.0)])
    late = taken(*near, Visit(do="visit", places=["home"], timeout_s=0.5), Wait(do="wait", seconds=5))
    assert late.visits[0].why == "not reached in 0.5 s"
    assert late.deciding.time_s == pytest.approx(late.session.time_s - 5.0, abs=0.15)


def test_the_end_decides_where_nothing_was_to_succeed() -> None:
    course = taken(Wait(do="wait", seconds=1))
    assert (course.deciding.words, course.deciding.time_s, course.deciding.ok) == ("the end", 1.0, None)


def test_a_tour_visits_every_goal_in_each_round() -> None:
    course = taken(Explore(do="explore", minutes=3), Tour(do="tour", goals=3, visits=6, timeout_s=90))
    assert len(course.visits) == 6
    assert sum(visit.reached for visit in course.visits) >= 4
    with pytest.raises(ValueError, match="knows only"):
        taken(Tour(do="tour", goals=500, visits=500))


# ------------------------------------------------------------ before it begins


@pytest.mark.parametrize(
    ("step", "message"),
    [
        (Drive(do="drive", path=["nowhere"]), "loop has no place 'nowhere'; expected one of: south-east corner"),
        (Tag(do="tag", places=["nowhere"]), "loop has no place 'nowhere'"),
        (Kidnap(do="kidnap", place="nowhere"), "loop has no place 'nowhere'"),
        (Visit(do="visit", places=["home"]), "visit 'home': nothing is tagged so before; tag it first"),
        (Door(do="door", name="front", open=True), "no door 'front' in loop; expected one of: there are none"),
        (Set(do="set", values={"pose_cells.snap": 1.0}), "unknown parameter 'pose_cells.snap'"),
        (Repeat(do="repeat", times=2, steps=[Drive(do="drive", path=["x"])]), "loop has no place 'x'"),
    ],
)
def test_a_step_that_does_not_fit_is_refused_before_the_first_tick(step: Step, message: str) -> None:
    with pytest.raises(ValueError, match=message.replace("(", r"\(")):
        Course(Session(LOOP, 1, IDEAL), [step])


def test_places_of_the_world_can_be_tagged_by_name_only_once_they_exist() -> None:
    world = replace(LOOP, places=(*LOOP.places, Place("desk", 3.0, 0.8)))
    assert "desk" in taken(Tag(do="tag", places=["desk"]), Wait(do="wait", seconds=0.2), world=world).tags


def test_the_robot_is_told_that_this_is_a_goal_and_called_back_on_the_way_to_it() -> None:
    course = taken(
        TagHere(do="tag here", name="begin"),
        Drive(do="drive", path=ROUND[:2], speed=0.3),
        TagHere(do="tag here", name="corner"),
        Drive(do="drive", path=["south-east corner"], speed=0.3),
        Send(do="send", place="corner", seconds=3.0),
        Visit(do="visit", places=["begin"], near_m=0.6),
    )
    home = LOOP.starts[0]
    assert (course.tags["begin"].x, course.tags["begin"].y) == pytest.approx((home.x, home.y), abs=0.01)
    said = words(course)
    assert said.index("called back from the way to corner") < said.index("begin: reached")
    assert [visit.name for visit in course.visits] == ["begin"]  # who is called back has not failed
    assert course.visits[0].began_s - course.moments[said.index("called back from the way to corner")].time_s == 0.0


def test_who_has_arrived_is_not_called_back() -> None:
    course = taken(
        TagHere(do="tag here", name="here"), Send(do="send", place="here", seconds=60.0), Wait(do="wait", seconds=0.1)
    )
    assert course.session.time_s < 10.0
    assert "arrived at here before it was called back" in words(course)
    assert "called back from the way to here" not in words(course)
