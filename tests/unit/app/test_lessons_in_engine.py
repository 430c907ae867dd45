"""A lesson in the engine: its states, and that it is the same run, bit for bit, as without a page."""

from __future__ import annotations

import pytest

from app.engine.engine import Engine
from app.engine.teaching import MOST_FROM_ONE, Teaching
from app.lessons.files import find_lesson
from app.lessons.performance import perform, perform_round, set_scene
from app.lessons.schema import Lesson
from web import messages as m

from .engines import an_engine, tell
from .lessons_to_give import drawn_lesson, short_lesson, two_rounds
from .sessions import OFFICE

pytestmark = pytest.mark.slow


def begun(lesson: Lesson) -> Engine:
    engine = an_engine(OFFICE)
    engine.begin_lesson(Teaching(lesson, lesson.scene.seed, engine.next_config))
    return engine


def play(engine: Engine, most: int = 3000) -> m.LessonView:
    """Run ticks, as the engine's thread does, until it pauses."""
    while engine.running and most > 0:
        engine.tick()
        most -= 1
    assert most > 0
    return view(engine)


def view(engine: Engine) -> m.LessonView:
    found = engine.snapshot().lesson
    assert found is not None
    return found


def test_its_states_follow_one_another_and_it_pauses_where_somebody_has_to_think() -> None:
    engine = begun(short_lesson())
    assert (view(engine).state, engine.runs_ahead) == ("scene", True)
    assert play(engine).state == "predict"
    assert (engine.runs_ahead, engine.run.session.tick_count) == (False, 10)
    tell(engine, type="predict", choice=1)
    tell(engine, type="show_lesson")
    assert view(engine).state == "showing"
    shown = play(engine)
    assert (shown.state, shown.prediction) == ("compared", m.LessonPrediction(choice=1))
    assert shown.outcome == m.LessonOutcome("It drove 0.4 m.", "The wheels turned.", True, choice=1)
    assert {(mark.plate, mark.words, mark.tick) for mark in shown.marks} == {
        ("office", "it ended here", 30),
        ("map", "it ended here", 30),
    }
    tell(engine, type="resume")
    engine.tick()
    assert view(engine).state == "sandbox"
    assert engine.run.session.pilot.mode == "explore"
    tell(engine, type="end_lesson")
    assert (engine.snapshot().lesson, engine.run.session.tick_count) == (None, 31)


@pytest.mark.parametrize("lesson", [short_lesson(), two_rounds()], ids=["one round", "two rounds"])
def test_it_is_the_lesson_by_itself_bit_for_bit(lesson: Lesson) -> None:
    engine = begun(lesson)
    for performance in perform(lesson):
        assert play(engine).state == "predict"
        if performance.number == 0:
            engine.snapshot()
            tell(engine, type="vote", lesson="short", voter="somebody", choice=0)
        tell(engine, type="show_lesson")
        play(engine)
        assert engine.run.session.state_hash() == performance.session.state_hash()
    assert view(engine).state == "compared"


def test_a_right_and_a_wrong_prediction_and_none() -> None:
    for choice, right in ((0, False), (1, True), (None, None)):
        engine = begun(short_lesson())
        play(engine)
        if choice is not None:
            tell(engine, type="predict", choice=choice)
        tell(engine, type="show_lesson")
        outcome = play(engine).outcome
        assert outcome is not None
        assert (outcome.right, outcome.choice) == (right, 1)


def test_a_drawn_prediction_is_told_how_far_off_it_was() -> None:
    engine = begun(drawn_lesson())
    play(engine)
    truth = perform_round(drawn_lesson(), 0).session.simulator.truth
    tell(engine, type="predict", x=truth.x + 3.0, y=truth.y + 4.0)
    tell(engine, type="show_lesson")
    outcome = play(engine).outcome
    assert outcome is not None
    assert (outcome.right, outcome.x, outcome.y) == (False, truth.x, truth.y)
    assert outcome.distance_m == pytest.approx(5.0)


def test_votes_count_once_for_each_voter_and_only_before_it_is_shown() -> None:
    engine = begun(short_lesson())
    play(engine)
    for voter, choice in (("voter one", 0), ("voter two", 1), ("voter one", 1)):
        tell(engine, type="vote", lesson="short", voter=voter, choice=choice)
    assert view(engine).votes.counts == (0, 2)
    with pytest.raises(ValueError, match="the lesson is 'short' now"):
        tell(engine, type="vote", lesson="loop", voter="voter one", choice=1)
    with pytest.raises(ValueError, match="asks for a choice, from 0 to 1"):
        tell(engine, type="predict", choice=2)
    with pytest.raises(ValueError, match="either a choice or x and y"):
        tell(engine, type="predict", choice=1, x=1.0, y=1.0)
    tell(engine, type="show_lesson")
    with pytest.raises(ValueError, match="predictions come first"):
        tell(engine, type="vote", lesson="short", voter="voter one", choice=1)


def test_one_phone_cannot_take_the_places_of_all() -> None:
    engine = begun(short_lesson())
    play(engine)
    for number in range(MOST_FROM_ONE):
        tell(engine, type="vote", lesson="short", voter=f"made up {number}", sender="192.168.1.66", choice=0)
    with pytest.raises(ValueError, match="60 have voted from this address already"):
        tell(engine, type="vote", lesson="short", voter="made up again", sender="192.168.1.66", choice=0)
    tell(engine, type="vote", lesson="short", voter="made up 0", sender="192.168.1.66", choice=1)  # it changes its mind
    for number in range(2, 32):
        tell(engine, type="vote", lesson="short", voter=f"pupil {number:02}", sender=f"192.168.1.{number}", choice=1)
    assert view(engine).votes.counts == (MOST_FROM_ONE - 1, 31)


def test_play_lets_it_happen_too() -> None:
    engine = begun(short_lesson())
    play(engine)
    tell(engine, type="resume")
    engine.tick()
    assert view(engine).state == "showing"
    play(engine)
    assert engine.run.session.state_hash() == perform_round(short_lesson(), 0).session.state_hash()


def test_an_order_of_ones_own_breaks_it_off_and_a_setting_alters_it() -> None:
    engine = begun(short_lesson())
    play(engine)
    tell(engine, type="set_parameter", name="pilot.cruise_speed", value=0.2)
    assert (view(engine).state, view(engine).altered) == ("predict", True)
    tell(engine, type="show_lesson")
    engine.tick()
    tell(engine, type="drive", speed=0.1, yaw_rate=0.0)
    assert view(engine).state == "sandbox"
    assert "drove the robot by hand" in view(engine).doing
    tell(engine, type="lesson_again")
    assert (play(engine).state, view(engine).altered, view(engine).prediction) == ("predict", False, None)


def test_the_rounds_are_runs_of_their_own_and_play_goes_on_to_the_next() -> None:
    engine = begun(two_rounds())
    first = engine.run.number
    play(engine)
    tell(engine, type="show_lesson")
    between = play(engine)
    assert (between.state, between.round, between.label, between.outcome) == ("predict", 1, "slow", None)
    assert between.doing == "slow is over; next: fast"
    tell(engine, type="resume")
    after = play(engine)
    assert engine.run.number == first + 1
    assert (after.state, after.round, after.label) == ("compared", 2, "fast")
    assert after.outcome is not None
    assert after.outcome.words == "0.4 m, then 0.7 m."


def test_going_back_in_time_does_not_break_it() -> None:
    lesson = short_lesson()
    engine = begun(lesson)
    play(engine)
    tell(engine, type="seek", tick=4)
    tell(engine, type="predict", choice=0)
    assert engine.snapshot().tick == 4
    tell(engine, type="show_lesson")  # from the present
    for _ in range(5):
        engine.tick()
    tell(engine, type="seek", tick=7)
    assert view(engine).state == "showing"
    tell(engine, type="back_to_now")
    tell(engine, type="resume")
    play(engine)
    assert engine.run.session.state_hash() == perform_round(lesson, 0).session.state_hash()


def test_a_branch_is_played_freely_and_the_lesson_is_still_there_on_the_old_one() -> None:
    engine = begun(short_lesson())
    play(engine)
    tell(engine, type="show_lesson")
    for _ in range(5):
        engine.tick()
    tell(engine, type="seek", tick=8)
    tell(engine, type="go_on_from_here")
    assert (view(engine).state, view(engine).altered, view(engine).marks) == ("sandbox", True, ())
    tell(engine, type="change_branch", number=1)
    assert (view(engine).state, view(engine).altered) == ("showing", False)
    tell(engine, type="resume")
    play(engine)
    assert engine.run.session.state_hash() == perform_round(short_lesson(), 0).session.state_hash()


def test_a_reset_brings_back_the_parameters_of_before() -> None:
    engine = an_engine(OFFICE)
    before = engine.run.session.config
    lesson = short_lesson(scene={"world": "loop", "set": {"pilot.cruise_speed": 0.2}})
    engine.begin_lesson(Teaching(lesson, 1, engine.next_config))
    play(engine)
    tell(engine, type="lesson_again")
    play(engine)
    assert engine.run.session.config.pilot.cruise_speed == 0.2
    tell(engine, type="reset", world="office")
    assert (engine.run.session.config, engine.snapshot().lesson) == (before, None)


def test_a_lesson_that_does_not_fit_leaves_the_old_run() -> None:
    engine = an_engine(OFFICE)
    with pytest.raises(ValueError, match=r"there is no lesson .castle.; expected one of: .*kidnapped"):
        tell(engine, type="begin_lesson", name="castle")
    assert engine.run.number == 1
    for command in ("show_lesson", "lesson_again", "end_lesson"):
        with pytest.raises(ValueError, match="no lesson was begun"):
            tell(engine, type=command)


def test_one_of_the_catalogue_begins_by_its_name_with_another_seed() -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="begin_lesson", name="packet", seed=7)
    shown = play(engine)
    assert (shown.name, shown.seed, shown.state, engine.run.session.seed) == ("packet", 7, "predict", 7)


def test_the_scene_alone_is_the_same_as_without_a_page() -> None:
    engine = begun(short_lesson())
    play(engine)
    assert engine.run.session.state_hash() == set_scene(short_lesson()).session.state_hash()


def test_when_it_is_over_the_snap_that_it_shows_is_explained() -> None:
    lesson = find_lesson("snap")
    engine = begun(lesson)
    play(engine)
    tell(engine, type="show_lesson")
    play(engine)
    why = engine.snapshot().inspected
    assert isinstance(why, m.WhyReport)
    assert (why.kind, view(engine).state) == ("snap", "compared")


def test_marks_lie_where_it_happened_and_go_with_the_map() -> None:
    lesson = find_lesson("loop")
    performance = perform_round(lesson, 0)
    assert performance.marks is not None
    marks = {(mark.plate, mark.words): mark for mark in performance.marks.view()}
    closure, end = marks["office", "a loop closes"], marks["office", "it ended here"]
    x, y = performance.session.evaluation.path[closure.tick].tolist()
    assert (closure.x, closure.y) == pytest.approx((x, y), abs=1e-3)
    truth, robot = performance.session.simulator.truth, performance.session.brain.experience_map.robot
    assert (end.x, end.y) == pytest.approx((truth.x, truth.y), abs=1e-3)
    on_map = marks["map", "it ended here"]
    assert (on_map.x, on_map.y) == pytest.approx((robot.x, robot.y), abs=1e-3)


def test_what_a_lesson_set_goes_with_it_and_what_somebody_set_stays() -> None:
    engine = an_engine(OFFICE)
    plain = engine.run.session.config
    lesson = find_lesson("twins")
    assert lesson.scene.engine == "paper-2005"
    engine.begin_lesson(Teaching(lesson, 1, engine.next_config))
    assert engine.run.session.config != plain
    tell(engine, type="set_parameter", name="local_view.learning_rate", value=0.3)
    tell(engine, type="end_lesson")
    tell(engine, type="set_parameter", name="robot.light", value=0.8)
    tell(engine, type="reset", world=OFFICE.name)
    wanted = plain.with_values({"local_view.learning_rate": 0.3, "robot.light": 0.8})
    assert engine.run.session.config == wanted
