"""A lesson in the engine: its states, and that it is the same run, bit for bit, as without a page."""

from __future__ import annotations

import pytest

from app.engine.engine import Engine
from app.engine.lesson_supervisor import MOST_FROM_ONE, Teaching
from app.protocol.lesson import Lesson, find_lesson
from app.protocol.lesson_round import run_lesson, run_round, set_scene
from web import messages as m

from .engines import an_engine, run_for, tell
from .lessons_to_give import drawn_lesson, short_lesson, two_rounds
from .sessions import OFFICE

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def alone() -> str:
    """The state hash at the end of the short lesson by itself."""
    return run_round(short_lesson(), 0).session.state_hash()


def begun(lesson: Lesson) -> Engine:
    engine = an_engine(OFFICE)
    engine.begin_lesson(Teaching(lesson, lesson.scene.seed, engine.next_config))
    return engine


def asked(lesson: Lesson) -> Engine:
    """Its scene is over, and it asks what will come."""
    engine = begun(lesson)
    assert play(engine).state == "predict"
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


def shown(engine: Engine) -> m.LessonView:
    tell(engine, type="show_lesson")
    return play(engine)


def vote(engine: Engine, voter: str, choice: int, **more: str) -> None:
    tell(engine, **{"type": "vote", "lesson": "short", "voter": voter, "choice": choice} | more)


def test_its_states_follow_one_another_and_it_pauses_where_somebody_has_to_think() -> None:
    engine = begun(short_lesson())
    assert (view(engine).state, engine.runs_ahead) == ("scene", True)
    assert play(engine).state == "predict"
    assert (engine.runs_ahead, engine.run.session.tick_count) == (False, 10)
    assert engine.run.session.state_hash() == set_scene(short_lesson()).session.state_hash()
    tell(engine, type="predict", choice=1)
    tell(engine, type="show_lesson")
    assert view(engine).state == "showing"
    over = play(engine)
    assert (over.state, over.prediction) == ("compared", m.LessonPrediction(choice=1))
    assert over.outcome == m.LessonOutcome("It drove 0.4 m.", "The wheels turned.", True, choice=1)
    assert {(mark.plate, mark.words, mark.tick) for mark in over.marks} == {
        ("office", "it ended here", 30),
        ("map", "it ended here", 30),
    }
    tell(engine, type="resume")
    run_for(engine, 1)
    assert (view(engine).state, engine.run.session.pilot.mode) == ("sandbox", "explore")
    tell(engine, type="end_lesson")
    assert (engine.snapshot().lesson, engine.run.session.tick_count) == (None, 31)


@pytest.mark.parametrize("lesson", [short_lesson(), two_rounds()], ids=["one round", "two rounds"])
def test_it_is_the_lesson_by_itself_bit_for_bit(lesson: Lesson) -> None:
    engine = begun(lesson)
    for round_ in run_lesson(lesson):
        assert play(engine).state == "predict"
        if round_.number == 0:
            engine.snapshot()
            vote(engine, "somebody", 0)
        shown(engine)
        assert engine.run.session.state_hash() == round_.session.state_hash()
    assert view(engine).state == "compared"


def test_what_was_predicted_is_compared_with_what_came() -> None:
    for choice, right in ((0, False), (None, None)):
        engine = asked(short_lesson())
        if choice is not None:
            tell(engine, type="predict", choice=choice)
        outcome = shown(engine).outcome
        assert outcome is not None
        assert (outcome.right, outcome.choice) == (right, 1)
    engine, truth = asked(drawn_lesson()), run_round(drawn_lesson(), 0).session.simulator.truth
    tell(engine, type="predict", x=truth.x + 3.0, y=truth.y + 4.0)
    outcome = shown(engine).outcome
    assert outcome is not None
    assert (outcome.right, outcome.x, outcome.y) == (False, truth.x, truth.y)
    assert outcome.distance_m == pytest.approx(5.0)


def test_votes_count_once_for_each_voter_and_only_before_it_is_shown() -> None:
    engine = asked(short_lesson())
    for voter, choice in (("voter one", 0), ("voter two", 1), ("voter one", 1)):
        vote(engine, voter, choice)
    assert view(engine).votes.counts == (0, 2)
    with pytest.raises(ValueError, match="the lesson is 'short' now"):
        vote(engine, "voter one", 1, lesson="loop")
    with pytest.raises(ValueError, match="asks for a choice, from 0 to 1"):
        tell(engine, type="predict", choice=2)
    with pytest.raises(ValueError, match="either a choice or x and y"):
        tell(engine, type="predict", choice=1, x=1.0, y=1.0)
    tell(engine, type="show_lesson")
    with pytest.raises(ValueError, match="predictions come first"):
        vote(engine, "voter one", 1)


def test_one_phone_cannot_take_the_places_of_all() -> None:
    engine, phone = asked(short_lesson()), "192.168.1.66"
    for number in range(MOST_FROM_ONE):
        vote(engine, f"made up {number}", 0, sender=phone)
    with pytest.raises(ValueError, match="60 have voted from this address already"):
        vote(engine, "made up again", 0, sender=phone)
    vote(engine, "made up 0", 1, sender=phone)  # it changes its mind
    for number in range(2, 32):
        vote(engine, f"pupil {number:02}", 1, sender=f"192.168.1.{number}")
    assert view(engine).votes.counts == (MOST_FROM_ONE - 1, 31)


def test_play_lets_it_happen_too_and_goes_on_to_the_next_round_which_is_a_run_of_its_own() -> None:
    engine = asked(two_rounds())
    first = engine.run.number
    tell(engine, type="resume")
    run_for(engine, 1)
    assert view(engine).state == "showing"
    between = play(engine)
    assert (between.state, between.round, between.label, between.outcome) == ("predict", 1, "slow", None)
    assert between.doing == "slow is over; next: fast"
    tell(engine, type="resume")
    after = play(engine)
    assert engine.run.number == first + 1
    assert (after.state, after.round, after.label) == ("compared", 2, "fast")
    assert after.outcome is not None
    assert after.outcome.words == "0.4 m, then 0.7 m."


def test_an_order_of_ones_own_breaks_it_off_and_a_setting_alters_it() -> None:
    engine = asked(short_lesson())
    tell(engine, type="set_parameter", name="pilot.cruise_speed", value=0.2)
    assert (view(engine).state, view(engine).altered) == ("predict", True)
    tell(engine, type="show_lesson")
    run_for(engine, 1)
    tell(engine, type="drive", speed=0.1, yaw_rate=0.0)
    assert view(engine).state == "sandbox"
    assert "drove the robot by hand" in view(engine).doing
    tell(engine, type="lesson_again")
    assert (play(engine).state, view(engine).altered, view(engine).prediction) == ("predict", False, None)


def test_going_back_in_time_does_not_break_it_and_a_branch_is_played_freely(alone: str) -> None:
    engine = asked(short_lesson())
    tell(engine, type="seek", tick=4)
    tell(engine, type="predict", choice=0)
    assert engine.snapshot().tick == 4
    tell(engine, type="show_lesson")  # from the present
    run_for(engine, 5)
    tell(engine, type="seek", tick=7)
    assert view(engine).state == "showing"
    tell(engine, type="go_on_from_here")
    assert (view(engine).state, view(engine).altered, view(engine).marks) == ("sandbox", True, ())
    tell(engine, type="change_branch", number=1)
    assert (view(engine).state, view(engine).altered) == ("showing", False), "it is still there on the old one"
    tell(engine, type="seek", tick=7)
    tell(engine, type="back_to_now")
    tell(engine, type="resume")
    play(engine)
    assert engine.run.session.state_hash() == alone


def test_what_a_lesson_set_goes_with_it_and_what_somebody_set_stays() -> None:
    engine = an_engine(OFFICE)
    plain = engine.run.session.config
    lesson = short_lesson(scene={"world": "loop", "set": {"pilot.cruise_speed": 0.2}})
    engine.begin_lesson(Teaching(lesson, 1, engine.next_config))
    play(engine)
    tell(engine, type="lesson_again")
    play(engine)
    assert engine.run.session.config.pilot.cruise_speed == 0.2
    tell(engine, type="reset", world="office")
    assert (engine.run.session.config, engine.snapshot().lesson) == (plain, None)
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


def test_the_run_before_waits_through_lessons_and_branches_and_goes_on_where_it_was() -> None:
    engine = an_engine(OFFICE)
    run_for(engine, 5)
    own, known = engine.run, engine.run.session.state_hash()
    engine.running, engine.pace.speed = True, 2.0
    for name in ("packet", "merge"):  # one lesson after the other
        tell(engine, type="begin_lesson", name=name)
        play(engine)
        assert engine.snapshot().back
    tell(engine, type="seek", tick=4)
    tell(engine, type="go_on_from_here")
    tell(engine, type="go_back")
    assert (engine.run, engine.running, engine.pace.speed, engine.snapshot().lesson) == (own, True, 2.0, None)
    assert (engine.run.session.tick_count, engine.run.session.state_hash()) == (5, known)
    tell(engine, type="step", ticks=2)
    run_for(engine, 2)
    assert own.session.tick_count == 7
    tell(engine, type="begin_lesson", name="packet")
    tell(engine, type="end_lesson")  # whose run stays: there is none to go back to
    tell(engine, type="begin_lesson", name="merge")
    assert engine.run.before is not None
    assert engine.run.before.run is not own


def test_one_of_the_catalogue_begins_by_its_name_with_another_seed_and_what_there_is_not_leaves_the_run() -> None:
    engine = an_engine(OFFICE)
    with pytest.raises(ValueError, match=r"there is no lesson .castle.; expected one of: .*kidnapped"):
        tell(engine, type="begin_lesson", name="castle")
    for command in ("show_lesson", "lesson_again", "end_lesson"):
        with pytest.raises(ValueError, match="no lesson was begun"):
            tell(engine, type=command)
    assert engine.run.number == 1
    tell(engine, type="begin_lesson", name="packet", seed=7)
    asks = play(engine)
    assert (asks.name, asks.seed, asks.state, engine.run.session.seed) == ("packet", 7, "predict", 7)


def test_when_it_is_over_the_snap_that_it_shows_is_explained_and_marked_from_packet_to_packet() -> None:
    engine = asked(find_lesson("snap"))
    over, last, why = shown(engine), engine.run.history.events.last_snap, engine.snapshot().inspected
    assert isinstance(why, m.WhyReport)
    assert (over.state, why.kind) == ("compared", "snap")
    (snap,) = (mark for mark in over.marks if (mark.plate, mark.words) == ("cells", "snap"))
    assert last is not None
    assert snap.start is not None
    assert (snap.x, snap.y) == pytest.approx((last.end.x, last.end.y), abs=1e-3)
    assert snap.start == pytest.approx((last.start.x, last.start.y, last.start.heading_rad), abs=1e-3)
    assert engine.run.session.brain.pose_cells.cells_apart(*snap.start[:2], snap.x, snap.y) >= 3
