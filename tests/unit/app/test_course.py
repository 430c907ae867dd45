"""A session is taken through its protocol, and the experimenter writes down what truly happens."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest
from pydantic import TypeAdapter

from app.config import Config
from app.protocol.course import Course, Tagged
from app.protocol.steps import Step, looking_back
from sim2d import Place, load_world

from .sessions import a_session

pytestmark = pytest.mark.slow

LOOP, LIVING = load_world("loop"), load_world("living")
HOME = LOOP.starts[0]
ROUND = [f"{corner} corner" for corner in ("south-east", "north-east", "north-west", "south-west")]
IDEAL = Config().with_values({"robot.odometry_noise": 0.0, "robot.gyro_bias": 0.0, "robot.odometry_scale_error": 0.0})
READER: TypeAdapter[Step] = TypeAdapter(Step)


def to(do: str, **fields: object) -> Step:
    """A step of a protocol."""
    return READER.validate_python({"do": do, **fields})


def taken(*steps: Step, world=LOOP, seed: int = 3) -> Course:
    """A course that has been taken to its end."""
    course = Course(a_session(0, seed, world, IDEAL), steps)
    for _ in course.ticks():
        course.session.tick()
    return course


def true_pose(course: Course) -> tuple[float, float, float]:
    truth = course.session.simulator.truth
    return truth.x, truth.y, truth.heading_rad


def words(course: Course) -> list[str]:
    return [moment.words for moment in course.moments]


def test_each_step_takes_its_time_and_the_wheels_are_given_what_a_move_says() -> None:
    for step, seconds in (
        (to("explore", minutes=0.1), 6.0),
        (to("wait", seconds=2.0), 2.0),
        (to("move", moves=[(0.1, 0, 1.0), (0, 30, 0.5)], times=2), 3.0),
        (to("repeat", times=2, steps=[to("wait", seconds=1.0), to("wait", seconds=0.5)]), 3.0),
    ):
        course = taken(step)
        assert course.session.time_s == pytest.approx(seconds)
        assert (course.deciding.words, course.deciding.time_s, course.deciding.ok) == ("the end", seconds, None)
    x, y, heading = true_pose(taken(to("move", moves=[(0.2, 0, 5.0), (0.0, 45, 2.0)])))
    assert (x, y) == pytest.approx((HOME.x + 1.0, HOME.y), abs=0.05)
    assert heading == pytest.approx(math.pi / 2, abs=0.1)


def test_a_driven_robot_comes_to_every_point_lap_by_lap() -> None:
    course = taken(to("drive", path=["south-east corner", (5.3, 3.0), "south-east corner", "home"], laps=2))
    assert course.session.evaluation.path_m > 2 * 2 * (2.3 + 2.2) - 2.5
    assert math.dist(true_pose(course)[:2], (3.0, 0.8)) < 0.3
    assert course.session.pilot.mode == "manual"


def test_who_looks_back_drives_each_stretch_three_times() -> None:
    """Every stretch is cut to its length, round corners too, and the last one to what is left."""
    path = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.5)]
    a, b, (c, d, e) = (0.0, 0.0), (1.5, 0.0), ((2.0, 0.0), (2.0, 1.0), (2.0, 2.5))
    assert list(looking_back(path, 1.5)) == [a, b, a, b, c, d, c, b, c, d, e, d, e]
    assert list(looking_back(path, 9.0)) == [*path, *path[1::-1], *path[1:]]
    course = taken(to("drive", path=["home", (5.3, 0.8)], look_back_m=1.0))
    assert course.session.evaluation.path_m > 1.5 * (5.3 - HOME.x)  # a stop is reached a little before it
    assert math.dist(true_pose(course)[:2], (5.3, 0.8)) < 0.3


def test_a_point_that_cannot_be_driven_to_is_left_out() -> None:
    course = taken(to("drive", path=[(3.0, 3.0)]))  # inside the block that the loop goes round
    assert "left out" in words(course)[0]
    assert course.session.time_s == pytest.approx(60.0, abs=1.0)


def test_kidnaps() -> None:
    assert true_pose(taken(to("kidnap", turn_deg=90))) == pytest.approx((HOME.x, HOME.y, math.pi / 2))
    placed = taken(to("kidnap", place="north-east corner", heading_deg=-90))
    assert true_pose(placed) == pytest.approx((5.3, 5.3, -math.pi / 2))
    for seed in range(5):
        far = taken(to("kidnap", least_m=3.0), seed=seed)
        assert math.dist(true_pose(far)[:2], (HOME.x, HOME.y)) >= 3.0
        assert len(far.session.evaluation.kidnaps) == 1
    with pytest.raises(ValueError, match=r"least_m = 100: no free place so far"):
        taken(to("kidnap", least_m=100.0))


def test_exploring_until_recovered_ends_then() -> None:
    explore = to("explore", minutes=3)
    course = taken(explore, to("kidnap", turn_deg=90), to("explore", minutes=3, until="recovered"))
    kidnap = course.session.evaluation.kidnaps[0]
    assert kidnap.after_s is not None
    assert course.session.time_s == pytest.approx(kidnap.at_s + kidnap.after_s + 0.5, abs=0.3)
    assert course.deciding.ok is True
    assert course.deciding.words.startswith("recovered")


def test_parameters_and_doors_change_on_the_way() -> None:
    door = LIVING.doors[0].name
    change = to("set", values={"local_view.match_threshold": 7.0})
    course = taken(change, to("door", name=door, open=True), world=LIVING)
    assert course.session.config.local_view.match_threshold == 7.0
    assert words(course)[:2] == ["local_view.match_threshold = 7.0", f"{door} opens"]


# ------------------------------------------------------------ goals


def followed(tag: Tagged, away: Sequence[float]) -> list[bool]:
    """What a tag at (0, 0) says of a robot that is so far away, tick by tick; experiences are numbered by tick."""
    return [tag.note((metres, 0.0), number) for number, metres in enumerate(away)]


def test_the_nearest_point_of_the_first_good_approach_is_tagged() -> None:
    """A poor approach counts if there is no better."""
    tag, poor = Tagged(0.0, 0.0, 1.0), Tagged(0.0, 0.0, 1.0)
    assert poor.experience is None
    said = followed(tag, [2.0, 0.9, 0.8, 1.5, 0.6, 0.3, 0.4, 1.2, 0.1, 1.5])
    assert (tag.experience, tag.away_m) == (5, 0.3)  # not 2: too far off; not 8: that was another approach
    assert said == [False] * 7 + [True, False, False]
    followed(poor, [2.0, 0.9, 0.8, 1.5, 1.1, 3.0])
    assert (poor.experience, poor.passed) == (2, False)


def test_goals_are_tagged_visited_in_order_and_judged_by_truth() -> None:
    tag, drive = to("tag", places=["south-east corner", "north-east corner"]), to("drive", path=ROUND, laps=2)
    course = taken(tag, drive, to("visit", places=["north-east corner", "south-east corner"], timeout_s=120))
    assert [visit.name for visit in course.visits] == ["north-east corner", "south-east corner"]
    assert course.visits[-1].miss_m == pytest.approx(math.dist(true_pose(course)[:2], (5.3, 0.8)))
    assert all(visit.reached == (visit.why == "") for visit in course.visits)
    assert all(visit.miss_m <= 1.0 for visit in course.visits if visit.reached)
    assert any(visit.reached for visit in course.visits)
    assert sum(visit.time_s for visit in course.visits) < course.session.time_s


def test_what_stands_for_a_place_does_not_change_on_the_way_to_it() -> None:
    steps = to("tag", places=["south-east corner"]), to("drive", path=["south-east corner", "home"])
    visit = to("visit", places=["south-east corner"], timeout_s=60)
    before, after = taken(*steps), taken(*steps, visit, visit)
    assert before.tags["south-east corner"].experience == after.tags["south-east corner"].experience


def test_a_goal_that_was_never_approached_or_not_reached_is_a_failure_and_decides() -> None:
    place = to("tag", places=["north-west corner"])
    never = taken(place, to("wait", seconds=1), to("visit", places=["north-west corner"]))
    assert never.visits[0].why == "never approached while exploring"
    assert never.deciding.ok is False
    near = to("tag", places=["home"]), to("drive", path=["south-east corner", (5.3, 3.0)])
    late = taken(*near, to("visit", places=["home"], timeout_s=0.5), to("wait", seconds=5))
    assert late.visits[0].why.startswith("not reached in 0.5 s: it is ")
    assert late.deciding.time_s == pytest.approx(late.session.time_s - 5.0, abs=0.15)


def test_a_tour_visits_every_goal_in_each_round() -> None:
    course = taken(to("explore", minutes=3), to("tour", goals=3, visits=6, timeout_s=90))
    assert len(course.visits) == 6
    assert sum(visit.reached for visit in course.visits) >= 4
    with pytest.raises(ValueError, match="knows only"):
        taken(to("tour", goals=500, visits=500))


def test_the_robot_is_told_that_this_is_a_goal_and_called_back_on_the_way_to_it() -> None:
    course = taken(
        to("tag here", name="begin"),
        to("drive", path=ROUND[:2], speed=0.3),
        to("tag here", name="corner"),
        to("drive", path=["south-east corner"], speed=0.3),
        to("send", place="corner", seconds=3.0),
        to("visit", places=["begin"], near_m=0.6),
    )
    assert (course.tags["begin"].x, course.tags["begin"].y) == pytest.approx((HOME.x, HOME.y), abs=0.01)
    said = words(course)
    called = said.index("called back from the way to corner")
    assert called < said.index("begin: reached")
    assert [visit.name for visit in course.visits] == ["begin"]  # who is called back has not failed
    assert course.visits[0].began_s == course.moments[called].time_s


def test_who_has_arrived_is_not_called_back() -> None:
    here = to("tag here", name="here")
    course = taken(here, to("send", place="here", seconds=60.0), to("wait", seconds=0.1))
    assert course.session.time_s < 10.0
    assert "arrived at here before it was called back" in words(course)
    assert "called back from the way to here" not in words(course)


# ------------------------------------------------------------ before it begins


def test_a_step_that_does_not_fit_is_refused_before_the_first_tick(subtests: pytest.Subtests) -> None:
    for step, message in (
        (to("drive", path=["nowhere"]), "loop has no place 'nowhere'; expected one of: south-east corner"),
        (to("tag", places=["nowhere"]), "loop has no place 'nowhere'"),
        (to("kidnap", place="nowhere"), "loop has no place 'nowhere'"),
        (to("visit", places=["home"]), "visit 'home': nothing is tagged so before; tag it first"),
        (to("door", name="front", open=True), "no door 'front' in loop; expected one of: there are none"),
        (to("set", values={"pose_cells.snap": 1.0}), "unknown parameter 'pose_cells.snap'"),
        (to("repeat", times=2, steps=[to("drive", path=["x"])]), "loop has no place 'x'"),
    ):
        with subtests.test(msg=step.do), pytest.raises(ValueError, match=message):
            Course(a_session(0, 1, LOOP, IDEAL), [step])
    world = replace(LOOP, places=(*LOOP.places, Place("desk", 3.0, 0.8)))
    assert "desk" in taken(to("tag", places=["desk"]), to("wait", seconds=0.2), world=world).tags
