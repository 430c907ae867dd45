"""Lessons with two brains on one stage: how the second begins, what is measured of it, what cannot be asked of it."""

from __future__ import annotations

import pytest

from app.config import Config
from app.engine.lesson_supervisor import Teaching
from app.protocol.lesson import Lesson
from app.protocol.lesson_round import measured_in, report_of, run_lesson
from app.protocol.measures import MEASURES

from .engines import an_engine, tell
from .lessons_to_give import SHORT, short_lesson
from .sessions import OFFICE

OF_SECOND = {name for kind in MEASURES if kind.of_any_brain for name in kind.readings}
SCENE, SHOW = SHORT["scene"], SHORT["show"]
TWO = {**SCENE, "compare": "papers"}


def from_the_beginning() -> Lesson:
    words = "{experiences of ours} and {experiences of paper-2006} after {path_m}."
    return short_lesson(scene=TWO, outcome=words)


def test_both_begin_with_the_scene_and_the_first_runs_as_without_the_second() -> None:
    (alone,), report = run_lesson(short_lesson()), report_of(from_the_beginning())
    (one,) = report.rounds
    second = one.session.companion
    assert second is not None
    assert (second.since_s, second.name) == (0.0, "paper-2006")
    assert (one.session.state_hash(), one.values) == (alone.session.state_hash(), alone.values)
    (label, measured), (first, values) = measured_in([one])
    assert (label, first, values) == ("paper-2006", "ours", one.values)
    assert set(measured) == OF_SECOND < set(values or {})
    assert measured["experiences"] == len(second.brain.experience_map) > 0
    assert report.kept
    assert [line.split(":")[0] for line in report.lines if "error_m" in line] == ["paper-2006", "ours"]


def test_a_copy_begins_when_it_is_shown_and_its_measures_count_from_there() -> None:
    words = "{views_new of with vision} and {views_new of without vision}."
    (one,) = run_lesson(short_lesson(show={**SHOW, "compare": "vision"}, outcome=words))
    assert one.session.companion is not None
    assert one.session.companion.since_s == pytest.approx(one.scene_ticks * 0.1)
    (_, second), (_, first) = measured_in([one])
    assert second["views_new"] == 0 < first["views_new"]
    assert first["views_before"] + first["views_new"] == first["views"]
    assert second["views"] == first["views_before"]


def test_the_second_brain_is_the_first_again_when_nothing_is_different_yet() -> None:
    """What is measured of the second means the same as of the first."""
    still = {**SHOW, "compare": "rate", "steps": [{"do": "move", "moves": [[0.0, 0.0, 0.5]]}]}
    (one,) = run_lesson(short_lesson(show=still, scene={**SCENE, "set": {"local_view.enabled": False}}))
    (_, second), (_, first) = measured_in([one])
    assert second == {name: first[name] for name in second}


def test_one_addition_can_be_missing_by_its_name() -> None:
    words = "{error_m of ours} and {error_m of without pace floor} after {path_m}."
    (one,) = run_lesson(short_lesson(show={**SHOW, "compare": "pace floor"}, outcome=words))
    assert one.session.companion is not None
    assert one.session.companion.values == {"experience_map.pace_floor": False}
    assert [label for label, _ in measured_in([one])] == ["without pace floor", "ours"]


def test_what_cannot_be_compared_is_told_in_a_sentence(subtests: pytest.Subtests) -> None:
    for changes, words in [
        (
            {"scene": TWO, "outcome": "{error_m of theirs}"},
            "there is no brain 'theirs'; it must be one of: ours, paper",
        ),
        ({"scene": TWO, "outcome": "{path_m of paper-2006}"}, "of a second brain only error_m, "),
        ({"scene": {**SCENE, "compare": "cells-64"}}, "nothing would differ"),
        ({"scene": {**SCENE, "compare": "nobody"}}, "there is no pair 'nobody'; expected one of: papers"),
        ({"show": {**SHOW, "compare": "cells"}}, "'cells' changes pose_cells.n_x, which a running brain cannot"),
        ({"scene": TWO, "show": {**SHOW, "compare": "vision"}}, "give it once"),
        ({"scene": TWO, "rounds": [{"label": "a"}, {"label": "b"}]}, "no rounds beside it"),
    ]:
        with subtests.test(words=words), pytest.raises(ValueError, match=words):
            short_lesson(**changes)


def test_what_is_compared_from_a_lesson_begins_as_the_lesson_did_and_takes_its_settings_along() -> None:
    lesson = short_lesson(scene={**SCENE, "seed": 9, "set": {"robot.gyro_bias": 0.02}})
    engine = an_engine(OFFICE)
    engine.begin_lesson(Teaching(lesson, 9, engine.next_config))
    for pair in ("pace floor", "law of evidence"):  # the second begins from what is no longer the lesson's own run
        tell(engine, type="compare_brains", pair=pair)
        session = engine.run.session
        assert (engine.run.lesson, session.seed, session.tick_count) == (None, 9, 0)
        assert session.config.robot.gyro_bias == 0.02
    assert engine.next_config == Config()
    tell(engine, type="set_parameter", name="experience_map.pace_floor", value=False)
    tell(engine, type="reset")
    assert engine.run.session.config == Config().with_value("experience_map.pace_floor", False)


def test_on_the_page_both_stand_there_once_more_too_and_who_ends_it_breaks_it_off() -> None:
    engine = an_engine(OFFICE)
    engine.begin_lesson(Teaching(from_the_beginning(), 1, None))
    view = engine.snapshot().beside
    assert view is not None
    assert (view.first.name, view.second.name) == ("ours", "paper-2006")
    tell(engine, type="lesson_again")
    assert engine.run.session.companion is not None
    while engine.run.lesson is not None and engine.run.lesson.state == "scene":
        engine.tick()
    for command in ("show_lesson", "end_comparison"):
        tell(engine, type=command)
        engine.tick()
    lesson, words = engine.snapshot().lesson, "broken off: it cannot go on: the second brain is no longer there"
    assert lesson is not None
    assert (lesson.state, lesson.doing) == ("sandbox", words)
